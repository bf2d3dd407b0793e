"""The recipes of conda and of containers install what pyproject.toml requires."""

import re
import tomllib
from pathlib import Path

import yaml
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text())
PROJECT = SETTINGS["project"]
#: packages of conda-forge with another name, here without the windows of Matplotlib
CONDA_NAMES = {"matplotlib": "matplotlib-base"}


def conda_line(text: str) -> str:
    """Return a requirement of pyproject.toml as a line of a conda recipe."""
    wanted = Requirement(text)
    assert not wanted.extras
    assert wanted.marker is None
    return f"{CONDA_NAMES.get(wanted.name, wanted.name)} {wanted.specifier}"


REQUIRED = sorted(
    map(conda_line, [f"python{PROJECT['requires-python']}", *PROJECT["dependencies"]])
)


def conda_recipe() -> dict:
    """Return recipe.yaml with the values of its context."""
    text = (ROOT / "recipe.yaml").read_text()
    context = yaml.safe_load(text)["context"]
    return yaml.safe_load(re.sub(r"\$\{\{ (\w+) \}\}", lambda found: context[found[1]], text))


def test_conda_recipe_has_the_requirements_of_the_project():
    requirements = conda_recipe()["requirements"]
    assert sorted(requirements["run"]) == REQUIRED
    assert {*map(conda_line, SETTINGS["build-system"]["requires"])} < {*requirements["host"]}


def test_conda_recipe_has_the_version_and_commands_of_the_project():
    recipe = conda_recipe()
    assert recipe["package"] == {"name": PROJECT["name"], "version": PROJECT["version"]}
    commands = dict(each.split(" = ") for each in recipe["build"]["python"]["entry_points"])
    assert commands == PROJECT["scripts"]
    about = recipe["about"]
    assert (about["summary"], about["license"]) == (PROJECT["description"], PROJECT["license"])


def test_conda_environment_has_the_requirements_of_the_project():
    *lines, by_pip = yaml.safe_load((ROOT / "environment.yml").read_text())["dependencies"]
    assert by_pip == {"pip": ["."]}
    assert sorted(lines) == sorted([*REQUIRED, "pip"])


def test_container_copies_everything_in_the_wheel():
    text = (ROOT / "Containerfile").read_text()
    copied = " ".join(re.findall(r"^COPY (?!--)(.*) \S+$", text, re.MULTILINE)).split()
    packages = SETTINGS["tool"]["hatch"]["build"]["targets"]["wheel"]["only-include"]
    described = ["pyproject.toml", PROJECT["readme"], *PROJECT["license-files"]]
    assert {*copied} == {".gitignore", *packages, *described}  # hatchling omits what git ignores
    assert re.search(r'^ENTRYPOINT \["/\S*/tweezer"\]$', text, re.MULTILINE)
