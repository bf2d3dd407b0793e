"""What a person sees in a terminal of 80 columns: the result, its details, one-line warnings."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

import tweezer
from tweezer.optics import ray_optics_caveat

#: A bead that nothing but its drag acts on, for a moment
FREE = ["silica-1um", "--duration", "1 us", "--set", "simulation.samples=3",
        "--set", "forces.optical=false"]  # fmt: skip
MACHINERY = ["force by", "because", "steps", "force calls", "time"]


def rows(printed: str) -> list[str]:
    """Return the rows of all tables without their headings, rules and margins."""
    lines = [line.strip() for line in printed.splitlines() if line.startswith("  ")]
    return [line for line in lines if line]


def test_a_trap_fits_a_narrow_terminal(command_line):
    outcome = command_line("trap", "silica-1um")
    assert (outcome.code, outcome.err) == (0, "")
    heading, *first = rows(outcome.out)
    assert heading == "silica-1um"
    assert [row.partition("  ")[0] for row in first] == [
        "power through the pupil", "stable equilibrium", "stiffness (x, y, z)",
        "corner frequencies", "held for", "light",
        "escape", "+x", "-x", "+y", "-y", "+z", "-z",
    ]  # fmt: skip
    assert all(len(line) <= 80 for line in outcome.out.splitlines())


def test_details_are_printed_on_request(command_line):
    short = command_line("run", *FREE)
    assert (short.code, short.err) == (0, "")
    names = [row.partition("  ")[0] for row in rows(short.out)]
    assert not set(MACHINERY) & set(names)
    assert {"outcome", "end (x, y, z)", "model, method", "error of the integration"} <= set(names)
    assert all(names), "a cell is wrapped"
    whole = command_line("run", *FREE, "--details")
    every = [row.partition("  ")[0] for row in rows(whole.out)]
    assert {"force by", "steps", "force calls", "time"} <= set(every)
    assert set(names) < set(every)


@pytest.mark.parametrize("arguments", [
    ["run", *FREE], ["trap", "silica-1um", "--set", "forces.optical=false"],
    ["run", "thesis-990nm", "--duration", "1 us", "--set", "simulation.samples=3"],
])  # fmt: skip
def test_quiet_commands_print_nothing(command_line, arguments):
    outcome = command_line(*arguments, "--quiet")
    assert (outcome.code, outcome.out, outcome.err, outcome.caveat) == (0, "", "", "")


def test_a_quiet_command_prints_its_file_and_its_errors(command_line):
    asked = ["trap", "silica-1um", "--set", "forces.optical=false", "--quiet"]
    outcome = command_line(*asked, "--json", "-")
    assert (outcome.code, outcome.err) == (0, "")
    assert json.loads(outcome.out)["trap"]["equilibrium"] is None
    refused = command_line("run", "nothing-1um", "--quiet")
    assert (refused.code, refused.out) == (2, "")
    assert refused.err.startswith("no scene file 'nothing-1um'")
    assert command_line("scenes").out, "the next command is not quiet"


def test_a_warning_is_one_line(command_line):
    asked = ["run", "thesis-990nm", "--duration", "1 us", "--set", "simulation.samples=3"]
    short = command_line(*asked).caveat
    assert short == (
        "warning: the bead is 1.6 wavelengths across: ray optics is wrong by up to 78 % of the "
        "largest force (--details: more)\n"
    )
    whole = command_line(*asked, "--details").caveat
    caveat = ray_optics_caveat(tweezer.load_scene("thesis-990nm"))
    assert whole.replace("µ", "u") == f"warning: {caveat}\n"
    assert tweezer.load_run("thesis-990nm.nc").attrs["ray_optics_caveat"] == caveat


def test_a_terminal_without_utf_8_has_ascii(tmp_path):
    program = [sys.executable, "-c", "from tweezer.cli import main; main()", "run", *FREE]
    environment = os.environ | {"PYTHONIOENCODING": "ascii"}
    done = subprocess.run(
        program, env=environment, cwd=tmp_path, capture_output=True, check=True,
    )  # fmt: skip
    assert " um from the focus" in done.stdout.decode("ascii")
