# Everything below runs inside .venv, made here with whatever PYTHON is (3.11 or newer). Python compiles
# a module when it is first imported (--no-compile): most of what is installed never is.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(PYTHON) -m pip --python $(BIN)/python --disable-pip-version-check

BENCHMARKS := force bodies rods integrate brownian fluid wall scaling depth calibrate camera free hydro heights sweep diagram fit commands view
# draw and quote what was measured
REPORTS := report bodies_report rods_report integrate_report brownian_report summary_report fluid_report wall_report scaling_report depth_report calibrate_report camera_report free_report real_tracks hydro_report heights_report sweep_report diagram_report fit_report commands_report view_report choosing_report
QUOTE = set -e; for each in $(REPORTS); do $(BIN)/python -m tests.benchmarks.$$each; done; $(BIN)/python -m tests.catalogue_page

.PHONY: demo test lint bench ages figures docs stress package environments derivation notebooks vendor clean

demo: .venv/.runtime  ## the thesis's 990 nm bead is pulled into the trap
	$(BIN)/tweezer run thesis-990nm --plot thesis-990nm.png

test: .venv/.dev  ## every test, under a hash seed that emitted code must not depend on
	PYTHONHASHSEED=4711 $(BIN)/python -m pytest -n logical --dist loadfile --no-loadscope-reorder

lint: .venv/.dev  ## style, types, import boundaries
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

bench: .venv/.bench  ## measure again: results, figures and what the documentation quotes
	set -e; for each in $(BENCHMARKS); do \
		$(BIN)/tweezer bench $$each --out tests/benchmarks/results/$$each.json; done
	$(QUOTE)

ages: .venv/.dev  ## list the committed results that are older than the code of their subject
	$(BIN)/python -m tests.benchmarks.ages

figures: .venv/.dev  ## every figure and number of the documentation again
	set -e; for each in tweezer/scenes/*.toml; do name=$$(basename $$each .toml); \
		$(BIN)/tweezer run $$name --plot docs/figures/gallery/$$name.png --overwrite; done
	$(BIN)/tweezer run thesis-990nm --plot docs/figures/thesis-990nm.png --overwrite
	$(BIN)/tweezer trap silica-1um --plot docs/figures/trap-silica-1um.png
	$(BIN)/tweezer trap polystyrene-500nm --set bead.shape=spheroid --set "bead.diameter=0.4 um" \
		--set "bead.length=0.8 um" --plot docs/figures/trap-rod.png
	$(BIN)/tweezer optimise silica-1um --set "bead.diameter=3 um" --set lens.numerical_aperture=1.2 \
		--set beam.polarisation=linear --for ky --out best.npy --overwrite --plot docs/figures/stiffest.png
	$(BIN)/python -m tests.pictures
	$(BIN)/python docs/knobs.py
	$(BIN)/tweezer trap silica-1um --heights "0.6 um" "10 um" --set lens.cover.refractive_index=1.518 \
		--set "lens.cover.depth=3 um" --plot docs/figures/trap-over-heights.png
	$(BIN)/tweezer run silica-1um --set forces.brownian=true --set optics.evaluator=map \
		--set simulation.samples=50001 --duration "1 s" --seed 1 --overwrite
	$(BIN)/tweezer calibrate silica-1um.nc --skip "20 ms" \
		--plot docs/figures/calibrate-silica-1um.png
	$(BIN)/tweezer run silica-1um --set "beam.power_through_pupil=10 mW" \
		--set forces.brownian=true --set simulation.model=overdamped --set simulation.samples=11 \
		--set "camera.rate=2500 Hz" --set "camera.exposure=0.4 ms" --set "camera.noise=3 nm" \
		--duration "2 s" --seed 1 --out seen.nc --overwrite
	$(BIN)/tweezer fit seen.nc --skip "20 ms" --scene silica-1um --set "bead.diameter=1.06 um" \
		--set "beam.power_through_pupil=13 mW" --free bead.diameter \
		--free beam.power_through_pupil --plot docs/figures/fit.png
	$(BIN)/tweezer run silica-1um --set forces.brownian=true --set optics.evaluator=map \
		--set simulation.samples=50001 --duration "0.6 s" --seed 1 --out fast.nc --overwrite
	$(BIN)/tweezer calibrate fast.nc --skip "20 ms" --plot docs/figures/calibrate-fast.png
	$(BIN)/tweezer sweep silica-1um --over bead.diameter=0.2um..3um:40:log \
		--over beam.power_through_pupil=1mW..1W:60:log --out diagram.zarr --resume \
		--plot docs/figures/trap-sweep.png
	$(BIN)/tweezer reproduce --out docs/figures/thesis
	$(QUOTE)

docs: .venv/.dev  ## the site, into site/
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build

stress: .venv/.dev  ## 10,000 random scenes, 2,000 with thermal motion, 1,000 beside walls, faults from outside, and ensembles killed 20 times
	$(BIN)/python -m tests.stress 10000
	$(BIN)/python -m tests.stress_faults
	$(BIN)/python -m tests.low_damping
	TWEEZER_KILLS=20 $(BIN)/python -m pytest -n0 tests/ensembles/test_ensemble_kill.py

package: .venv/.dev  ## wheel and sdist, each installed in a fresh environment and run there
	$(BIN)/python -m tests.package

environments: .venv/.dev  ## every command with the lowest and newest dependencies, and each Python found
	$(BIN)/python -m tests.environments

derivation: .venv/.dev  ## derive again and write generated/
	$(BIN)/python -m derivation

notebooks: .venv/.dev  ## run the notebooks and keep their output
	$(BIN)/python tests/test_notebooks.py

vendor: .venv/.dev  ## fetch three.js again and bundle what pages use of it; needs npm
	$(BIN)/python -m tests.vendored

clean:
	rm -rf .venv site

.venv/bin/python:
	$(PYTHON) -m venv --without-pip .venv

.venv/.runtime: pyproject.toml | .venv/bin/python
	$(PIP) install --quiet --no-compile --editable .
	touch $@

.venv/.bench: pyproject.toml | .venv/bin/python
	$(PIP) install --quiet --no-compile --editable ".[bench]"
	touch $@ .venv/.runtime

.venv/.dev: pyproject.toml | .venv/bin/python
	$(PIP) install --quiet --no-compile --editable ".[dev]"
	touch $@ .venv/.runtime
