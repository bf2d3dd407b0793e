"""Every command in the documentation runs, and what it names and quotes is there.

Pages: the sources of the site, and the README. Notebooks are executed by test_notebooks.py.
"""

import json
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

import pytest
import typer

import tweezer
from tests.benchmarks import choosing_report, pages, summary_report
from tweezer import cli
from tweezer.scene import Scene

ROOT = Path(__file__).parents[1]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "derivation/README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs/api").glob("*.md")),
]
#: lines that are not run here: what runs them, or why nothing does
NOT_RUN = {
    "tweezer view silica-1um": "opens a browser",
    "tweezer view mine.toml": "opens a browser",
    "tweezer view silica-1um.nc --movie silica-1um.mp4 --seconds 6": "wants ffmpeg and a minute",
    'tweezer run silica-1um --duration "1 ms" --out a.nc': "tests/test_comparison.py",
    'tweezer run silica-1um --duration "1 ms" --method dop853 --out b.nc': "the same",
    "tweezer compare a.nc b.nc": "the same",
    "make demo": "the first thing that .ci/run does",
    "make test": "this is it",
    "python3 -m venv .venv": "make demo",
    ".venv/bin/python -m pip install --editable .": "make demo",
    ".venv/bin/tweezer run thesis-990nm --plot thesis-990nm.png": "make demo",
    "pip install .": "make demo, tests/environments.py",
    "conda env create --file environment.yml": "wants conda and the network; tests/test_recipes.py",
    "conda activate tweezer": "the same",
    "podman build --tag tweezer .": "wants podman and the network; tests/test_recipes.py",
    'podman run --rm --volume tweezer:/cache --volume "$PWD":/data tweezer run silica-1um': "wants "
    "podman",
    '.venv/bin/python -m pip install --editable ".[notebooks]" jupyterlab': "wants the network",
    ".venv/bin/jupyter lab notebooks": "opens a browser and goes on",
    "tweezer sweep silica-1um --over bead.diameter=0.2um..3um:40:log "
    "--over beam.power_through_pupil=1mW..1W:60:log --out diagram.zarr "
    "--plot diagram.png": "takes a minute; `make figures` runs it, and tests/benchmarks/sweep.py",
    "git clone https://github.com/yunkiyau/3rdyearphys-optical_tweezers_experiment": "fetches the "
    "tracks of others",
    'tweezer calibrate 3rdyearphys-optical_tweezers_experiment/data/3um*bead1.csv --rate "15 Hz" '
    '--scale "11.66 px/um" --temperature "20 degC" --viscosity "1.002 mPa s"': "reads those tracks",
    "tweezer sweep silica-1um --over bead.diameter=0.5um,1um,2um "
    "--over beam.power_through_pupil=1mW..1W:20:log --plot map.png": "docs/sweeps.md has a shorter",
    "tweezer fit recording.csv --scene mine.toml --free bead.diameter "
    "--free beam.power_through_pupil": "wants a recording of the reader's",
    'tweezer run silica-1um --set "beam.power_through_pupil=10 mW" --set forces.brownian=true '
    "--set simulation.model=overdamped --set simulation.samples=11 "
    '--set "camera.rate=2500 Hz" --set "camera.exposure=0.4 ms" --set "camera.noise=3 nm" '
    '--duration "2 s" --seed 1 --out seen.nc': "`make figures` runs it",
    'tweezer fit seen.nc --skip "20 ms" --scene silica-1um --set "bead.diameter=1.06 um" '
    '--set "beam.power_through_pupil=13 mW" --free bead.diameter '
    "--free beam.power_through_pupil --plot fit.png": "takes long; tests/tracking/test_fit.py",
    "python -m derivation": "writes into the checkout; tests/derivation/test_emission.py",
    "python -m derivation --check": "tests/derivation/test_emission.py",
    "python -m derivation.memory_poles": "takes minutes; tests/derivation bounds what it made",
    "python -m derivation.wall_coefficients": "takes minutes; tests/derivation makes parts again",
    "python tests/test_notebooks.py": "writes into the checkout; tests/test_notebooks.py",
}


class Block(NamedTuple):
    """A fenced block of a page."""

    language: str
    source: str

    @property
    def lines(self):
        """Commands without their comments; those that go on over a line's end are one."""
        whole = re.sub(r" *\\\n *", " ", self.source)
        return [re.sub(r"\s+# .*", "", line) for line in whole.splitlines() if line.strip()]


def blocks(page):
    """The commands of a page, in its order."""
    fenced = re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text(), re.DOTALL | re.MULTILINE)
    return [Block(*each) for each in fenced if each[0] in ("sh", "python")]


@pytest.fixture
def place(tmp_path, monkeypatch):
    """An empty working directory, with the command `tweezer` of this Python on the path."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    return tmp_path


@pytest.mark.parametrize("page", [*filter(blocks, PAGES)], ids=lambda page: page.stem)
def test_commands_run(page, place, command_line):
    """In their order; each ends with 0, and no error is one that the page does not show.

    Plain commands `tweezer` are called in this process, all else by bash.
    """
    names = {}
    for block in blocks(page):
        if block.language == "python":
            exec(compile(block.source, str(page), "exec"), names)
        elif set(block.lines) <= set(NOT_RUN):
            continue
        elif all(re.fullmatch(r"tweezer [^|<>$&;*`~]*", line) for line in block.lines):
            for line in block.lines:
                done = command_line(*shlex.split(line)[1:])
                assert done.code == 0, f"{line}\n{done.out}\n{done.err}"
        else:
            done = subprocess.run(
                ["bash", "-euo", "pipefail", "-c", block.source],
                check=False, capture_output=True, text=True,
            )  # fmt: skip
            assert done.returncode == 0, f"{block.source}\n{done.stdout}\n{done.stderr}"


def test_the_landing_page_shows_what_its_lines_print(capsys):
    page = (ROOT / "docs/index.md").read_text()
    source, shown = re.search(r"```python\n(.*?)```\n\n```\n(.*?)```", page, re.DOTALL).groups()
    exec(compile(source, "index.md", "exec"), {})
    assert capsys.readouterr().out == shown
    assert len([line for line in source.splitlines() if line]) <= 10


def test_the_knobs_of_the_landing_page_show_computed_traps():
    knobs = json.loads((ROOT / "docs/knobs.json").read_text())
    scene = tweezer.load_scene(knobs["scene"])
    for diameter, aperture, power in ((4, 5, 3), (7, 2, 5), (2, 3, 0)):
        trap = tweezer.characterise(
            scene.replace(
                bead={"diameter": knobs["diameter_um"][diameter] * 1e-6},
                lens={"numerical_aperture": knobs["numerical_aperture"][aperture]},
                beam={"power_through_pupil": knobs["power_mW"][power] * 1e-3},
            )
        )
        shown = {
            "lateral_pN_per_um": 1e6 * trap.stiffness_xyz[0],
            "axial_pN_per_um": 1e6 * trap.stiffness_xyz[2],
            "equilibrium_z_um": 1e6 * trap.equilibrium.position[2],
            "depth_kT": min(escape.energy_kT for escape in trap.escapes),
        }
        for name, value in shown.items():
            assert knobs[name][diameter][aperture][power] == pytest.approx(value, rel=6e-4), name


def test_what_is_not_run_is_in_the_documentation():
    """No entry outlives its line."""
    shown = {line for page in PAGES for block in blocks(page) for line in block.lines}
    assert set(NOT_RUN) <= shown


def test_other_fences_are_parts_of_scenes():
    """A command in a block of another kind would not be run."""
    fences = {fence for page in PAGES for fence in re.findall(r"^```(\w+)", page.read_text(), re.M)}
    assert fences == {"sh", "python", "toml"}
    base = tweezer.load_scene("silica-1um").model_dump(exclude_none=True, exclude={"more_beams"})
    for page in PAGES:
        for source in re.findall(r"(?ms)^```toml\n(.*?)^```$", page.read_text()):
            Scene.model_validate(base | tomllib.loads(source))


def test_commands_named_in_the_text_exist():
    text = "".join(page.read_text() for page in PAGES)
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.M))
    assert set(re.findall(r"`make (\w+)", text)) <= targets
    commands = set(typer.main.get_command(cli.app).commands)
    assert set(re.findall(r"`tweezer ([a-z][a-z-]*)", text)) <= commands


def test_links_lead_somewhere_in_the_repository():
    for page in PAGES:
        text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
        for address in re.findall(r"\]\(([^)\s]+)\)", text):
            place = urlsplit(address)
            if not place.scheme and place.path:
                assert (page.parent / place.path).exists(), (page.name, address)


def _named_files(text):
    """Files and folders in code spans, but in the items of recipes that are about a new file."""
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"^1\. New: .*\n(?: .*\n)*", "", text, flags=re.MULTILINE)
    spans = re.findall(r"`([^`\s]+)`", text)
    file = re.compile(r"(?:\.\./)*([\w./-]+(?:/|\.(?:py|js|md|toml|csv)))")
    return {found[1] for each in spans if (found := file.fullmatch(each))}


def test_files_named_for_developers_exist():
    tops = "derivation", "docs", "generated", "notebooks", "tests", "tweezer"
    inside = [each for top in tops for each in (ROOT / top).rglob("*")]
    paths = {
        f"/{each.relative_to(ROOT)}{'/' * each.is_dir()}" for each in [*ROOT.iterdir(), *inside]
    }
    texts = ROOT / "CONTRIBUTING.md", ROOT / "docs/extending.md"
    named = set().union(*(_named_files(each.read_text()) for each in texts))
    users_own = {"generated.py", "derivation.py"}
    assert len(named) > 150
    assert not {
        name for name in named - users_own if not any(p.endswith(f"/{name}") for p in paths)
    }


def test_rows_of_tables_are_as_long_as_their_headings():
    for page in PAGES:
        text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
        for table in re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE):
            cells = [len(re.findall(r"(?<!\\)\|", row)) - 1 for row in table.splitlines()]
            assert len(set(cells)) == 1, (page.name, table)


def test_readme_quotes_the_committed_results():
    force, integrate, brownian = map(pages.committed, ("force", "integrate", "brownian"))
    quoted = pages.quoted("headline")
    assert quoted == summary_report.headline(force, integrate, brownian)
    figures = re.findall(r"\| ([^|]*) \|\n", quoted)[2:]
    inside = force["headline"]["by_place"]["inside"]
    assert float(figures[1].split()[0]) == pytest.approx(inside["quadrature_us"], rel=0.05)
    tabled = [
        of["map_largest_error_over_largest_force"]
        for of in force["headline"]["by_place"].values()
        if "map_ns" in of
    ]
    assert len(tabled) > 1
    assert all(float(figures[4].split(", ")[1]) > 0.95 * error for error in tabled)
    steps = brownian["headline"]["full_heun_steps_per_s"]
    assert float(figures[8]) == pytest.approx(1e-6 * steps, rel=0.05)


def test_models_are_quoted_from_the_committed_results():
    integrate = pages.committed("integrate")
    quoted = pages.quoted("models")
    assert quoted == summary_report.models(integrate)
    for name in summary_report.BEADS:
        rows = re.findall(rf"\| {name}, (\S+).*? \| \S+ \| (\S+) \|", quoted)
        errors = {model.rstrip(","): float(error) for model, error in reversed(rows)}
        assert errors["full"] < errors["first-order"] < errors["overdamped"] < errors["scaled"]
        for each in integrate["motions"][f"{name}, rays, map"]["entries"]:
            if each["model"] in ("first-order", "overdamped") and each["tolerance"] == 1e-11:
                # its own error, which runs converge to
                assert errors[each["model"]] == pytest.approx(each["during_um"], rel=0.1)


@pytest.mark.filterwarnings("ignore::tweezer.PhysicsWarning")  # of the smallest beads
def test_the_page_that_helps_to_choose_quotes_the_committed_results():
    for name, block in choosing_report.blocks().items():
        assert pages.quoted(f"choosing-{name}") == block, name
    motion = pages.quoted("choosing-motion")
    off = {
        row[0]: float(row[1].split()[0])
        for row in re.findall(r"\| ([\w-]+) \| .*? µm \| (.*?) \|", motion)
    }
    entries = pages.committed("integrate")["motions"]
    worst = max(
        each["during_um"]
        for bead in summary_report.BEADS
        for each in entries[f"{bead}, rays, map"]["entries"]
        if (each["model"], each["tolerance"]) == ("overdamped", 1e-11)
    )
    assert off["overdamped"] == pytest.approx(worst, rel=0.1)
    by_map = re.search(
        r"wave optics, `map` .*\| (.*) s \| (.*) \|", pages.quoted("choosing-evaluator")
    )
    force = pages.committed("force")["headline"]["by_place"]["inside"]
    saved = 1e-6 * force["waves_us"] - 1e-9 * force["waves_map_ns"]  # s
    assert float(by_map[2].replace(",", "")) == pytest.approx(float(by_map[1]) / saved, rel=0.05)
    near = re.search(r"\| 0.1 radii \| (\d+) % \| (\d+) %", pages.quoted("choosing-wall"))
    # docs/walls.md has the drag at a tenth of a radius
    assert [float(each) for each in near.groups()] == pytest.approx([125.7, 1046], rel=0.06)
