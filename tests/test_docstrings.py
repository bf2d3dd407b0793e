"""The docstrings of the public names are complete, and their examples run."""

import doctest
import functools
import importlib
import inspect
import re
from pathlib import Path
from types import FunctionType

import griffe
import numpy as np
import pytest

import tweezer

ROOT = Path(__file__).parents[1]
#: names that the pages of the API describe
DESCRIBED = sorted(
    name
    for page in (ROOT / "docs/api").glob("*.md")
    for name in re.findall(r"^::: (\S+)", page.read_text(), re.MULTILINE)
)


@functools.cache
def source():
    """The package as it is written, without an import: docstrings of fields are not kept."""
    return griffe.load("tweezer", search_paths=[ROOT], allow_inspection=False)


def named(path):
    """The object of a dotted path."""
    module, _, name = path.rpartition(".")
    try:
        return getattr(importlib.import_module(module), name)
    except ModuleNotFoundError:
        return getattr(named(module), name)


def callables():
    """Public functions of the API, and methods and constructors of its classes, by their paths."""
    for path in DESCRIBED:
        of = named(path)
        if isinstance(of, FunctionType):
            yield path, of
        elif isinstance(of, type):
            yield path, of
            for name, member in [*vars(of).items()]:
                function = getattr(member, "__func__", member)
                if isinstance(function, FunctionType) and not name.startswith("_"):
                    yield f"{path}.{name}", function


CALLABLES = dict(callables())


def parameters_of(function):
    """Names of the parameters that a caller may give."""
    try:
        signature = inspect.signature(function)
    except ValueError:  # an exception of its own has the signature of `Exception`
        return []
    return [name for name in signature.parameters if name not in ("self", "cls")]


def documented(function):
    """Names in the section Parameters of a docstring."""
    docstring = griffe.Docstring(inspect.getdoc(function) or "", lineno=1)
    return [
        each.name.lstrip("*")
        for section in docstring.parse("numpy", warnings=False)
        if section.kind is griffe.DocstringSectionKind.parameters
        for each in section.value
    ]


def test_every_public_name_is_described_once():
    assert len(set(DESCRIBED)) == len(DESCRIBED)
    described = set(DESCRIBED)
    assert {f"tweezer.{name}" for name in tweezer.__all__} - {"tweezer.__version__"} <= described


@pytest.mark.parametrize("path", CALLABLES)
def test_parameters_are_documented(path):
    """All of them where there are several; a class may document its fields one by one instead."""
    function = CALLABLES[path]
    assert inspect.getdoc(function)
    parameters, names = parameters_of(function), documented(function)
    if isinstance(function, type) and not names:
        written = f"{function.__module__}.{function.__name__}".removeprefix("tweezer.")
        fields = source()[written].members
        assert [each for each in parameters if each in fields and not fields[each].docstring] == []
    elif names or len(parameters) > 1:
        assert names == parameters


def test_summaries_are_sentences():
    """Each function begins with one sentence, in the imperative: its first word is no third
    person, and its last sign is a full stop.
    """
    for path, function in CALLABLES.items():
        summary = inspect.getdoc(function).partition("\n\n")[0]
        assert summary.endswith("."), path
        if isinstance(function, FunctionType):
            assert re.match(r"[A-Z][a-z]+(?<!s)\b|Compress|Pass", summary), (path, summary)


EXAMPLES = {
    path: tests[0]
    for path, of in [*CALLABLES.items()]
    if (tests := doctest.DocTestFinder(recurse=False).find(of, path)) and tests[0].examples
}


@pytest.mark.parametrize("path", EXAMPLES)
def test_example_runs(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    EXAMPLES[path].globs = {"np": np, "tweezer": tweezer}
    assert doctest.DocTestRunner().run(EXAMPLES[path]).failed == 0


def test_examples_are_short():
    assert len(EXAMPLES) > 20
    assert {path for path, test in EXAMPLES.items() if len(test.examples) > 4} == set()
