# Everything below runs inside .venv, made here with whatever PYTHON is (3.11 or newer).
PYTHON ?= python3
BIN := .venv/bin
PIP := $(PYTHON) -m pip --python $(BIN)/python --disable-pip-version-check

.PHONY: demo test lint bench stress derivation notebooks clean

demo: .venv/.runtime  ## the thesis's 990 nm bead is pulled into the trap
	$(BIN)/tweezer run thesis-990nm

test: .venv/.dev  ## every test
	$(BIN)/python -m pytest

lint: .venv/.dev  ## style, types, import boundaries
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

bench: .venv/.bench  ## measure again: results, figures and what the documentation quotes
	$(BIN)/tweezer bench force --out tests/benchmarks/results/force.json
	$(BIN)/python -m tests.benchmarks.report
	$(BIN)/tweezer bench integrate --out tests/benchmarks/results/integrate.json
	$(BIN)/python -m tests.benchmarks.integrate_report
	$(BIN)/tweezer bench brownian --out tests/benchmarks/results/brownian.json
	$(BIN)/python -m tests.benchmarks.brownian_report

stress: .venv/.runtime  ## 10,000 random scenes, and 2,000 with thermal motion: how they end
	$(BIN)/python -m tests.stress 10000

derivation: .venv/.dev  ## derive again and write generated/
	$(BIN)/python -m derivation

notebooks: .venv/.dev  ## run the notebooks and keep their output
	$(BIN)/python tests/test_notebooks.py

clean:
	rm -rf .venv

.venv/bin/python:
	$(PYTHON) -m venv --without-pip .venv

.venv/.runtime: pyproject.toml | .venv/bin/python
	$(PIP) install --quiet --editable .
	touch $@

.venv/.bench: pyproject.toml | .venv/bin/python
	$(PIP) install --quiet --editable ".[bench]"
	touch $@ .venv/.runtime

.venv/.dev: pyproject.toml | .venv/bin/python
	$(PIP) install --quiet --editable ".[dev]"
	touch $@ .venv/.runtime
