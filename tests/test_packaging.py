"""The wheel brings one package, which does not look for its modules among the user's."""

import os
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml
from hatchling.builders.wheel import WheelBuilder

from tests import licences

ROOT = Path(__file__).parents[1]

#: where the modules of a scene come from, beside a user's own of these names
PROGRAM = """
import generated, derivation
import tweezer
from tweezer.derivation.emission import GENERATED
from tweezer.dynamics import bind
from tweezer.optics.rays import ray_sum
module = bind(tweezer.load_scene("thesis-990nm")).module
print(tweezer.__file__, module.__file__, ray_sum.ray.__file__, GENERATED / "ray.py", sep="\\n")
"""


def test_citation_and_changelog_are_of_this_version():
    version = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    # what version 1.2.0 of the format asks for
    assert {"authors", "cff-version", "message", "title"} <= set(citation)
    assert (citation["version"], citation["license"]) == (version, "MIT")
    newest = re.search(r"^## (.*)", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[1]
    assert version in newest


def test_everything_that_tweezer_requires_has_a_permissive_licence():
    names = licences.required("tweezer")
    assert {"numpy", "numba", "llvmlite", "pint", "h5py"} <= names
    assert "iapws" not in names
    assert licences.refused(names) == []


@pytest.mark.parametrize(
    ("text", "accepted"),
    [
        ("MIT", True),
        ("BSD-3-Clause AND 0BSD AND MIT AND Zlib AND CC0-1.0", True),
        ("MIT OR GPL-3.0-only", True),
        ("Mozilla Public License 2.0 (MPL 2.0)", True),
        ("gpl v3", False),
        ("GNU General Public License v3 (GPLv3)", False),
        ("LGPL-3.0-only", False),
        ("MIT AND GPL-2.0-or-later", False),
        ("not stated", False),
    ],
)
def test_licences_are_judged_by_their_terms(text, accepted):
    assert licences.accepted(text) is accepted


def test_forms_for_issues_ask_for_scene_and_versions():
    form = yaml.safe_load((ROOT / ".github/ISSUE_TEMPLATE/wrong.yml").read_text())
    asked = {of["id"]: of["validations"]["required"] for of in form["body"] if "id" in of}
    assert asked == dict.fromkeys(("command", "scene", "happened", "expected", "info"), True)


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """A folder with nothing but what the wheel installs."""
    folder = tmp_path_factory.mktemp("wheel")
    (built,) = WheelBuilder(str(ROOT)).build(directory=str(folder), versions=["standard"])
    with zipfile.ZipFile(built) as archive:
        archive.extractall(folder / "site")
    return folder / "site"


def test_the_wheel_has_one_package_with_all_that_the_checkout_has(site):
    assert {path.name for path in site.iterdir() if path.suffix != ".dist-info"} == {"tweezer"}
    for folder in ("generated", "derivation"):
        files = {path.relative_to(ROOT) for path in (ROOT / folder).rglob("*") if path.is_file()}
        for path in files:
            if "__pycache__" not in path.parts:
                assert (site / "tweezer" / path).read_bytes() == (ROOT / path).read_bytes()
    assert (site / "tweezer" / "scene" / "materials.toml").is_file()
    shipped = {path.name for path in (ROOT / "tweezer" / "scenes").glob("*.toml")}
    assert {path.name for path in (site / "tweezer" / "scenes").glob("*.toml")} == shipped


def test_modules_of_a_user_do_not_stand_in_for_those_of_the_wheel(site, tmp_path):
    for name in ("generated", "derivation"):
        (tmp_path / f"{name}.py").write_text("")
    (tmp_path / "script.py").write_text(PROGRAM)
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(site)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    package = site / "tweezer"
    emitted = package / "generated"
    assert done.stdout.splitlines() == list(map(str, [
        package / "__init__.py", emitted / "scaled_translation.py", emitted / "ray.py",
        emitted / "ray.py",
    ]))  # fmt: skip


@pytest.mark.parametrize("missing", ["sympy", "jinja2"])
def test_the_derivation_names_the_extra_that_is_missing(missing):
    program = (
        f"import runpy, sys; sys.modules['{missing}'] = None;"
        "runpy.run_module('derivation', run_name='__main__')"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode != 0
    needed = f'the derivation needs {missing}: pip install "tweezer[derive]"'
    assert needed in done.stderr.splitlines()[-1]
