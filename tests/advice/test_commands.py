"""The advice of refused commands, followed to the letter by the words of each message."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

#: a bead without light for a moment: nothing heavy is computed
FREE = [
    "silica-1um", "--duration", "1 us", "--set", "simulation.samples=3",
    "--set", "forces.optical=false",
]  # fmt: skip
#: the same, for a sweep of two cases
SWEPT = [
    "silica-1um", "--of", "run", "--workers", "1", "--set", "simulation.duration=1 us", *FREE[3:],
    "--set", "medium.mean_free_path=0.1 nm",
]  # fmt: skip
Follow = Callable[[list[str], re.Match[str]], list[str]]


def replaced(arguments: list[str], old: str, new: str) -> list[str]:
    return [each.replace(old, new) for each in arguments]


def without(arguments: list[str], option: str) -> list[str]:
    """Return the arguments without an option and its value."""
    at = arguments.index(option)
    return [*arguments[:at], *arguments[at + 2 :]]


#: id: (command, pattern of its error message, function that applies the remedy in the message)
REFUSED: dict[str, tuple[list[str], str, Follow]] = {
    "scene with a slip": (
        ["run", "silca-1um", *FREE[1:]], r"did you mean (\S+)\?$",
        lambda words, said: replaced(words, "silca-1um", said[1]),
    ),
    "key with a slip": (
        ["run", *FREE, "--set", "bead.densty=2000"], r"did you mean (\w+)\?$",
        lambda words, said: replaced(words, "densty", said[1]),
    ),
    "key without its section": (
        ["run", *FREE, "--set", "wavelength=1 um"], r"did you mean (beam\.wavelength)\?$",
        lambda words, said: replaced(words, "wavelength=", f"{said[1]}="),
    ),
    "number without a unit": (
        ["run", *FREE, "--set", "bead.diameter=1.5"], r'for (.*) write "(.*)"$',
        lambda words, said: replaced(words, "diameter=1.5", f"diameter={said[2]}"),
    ),
    "unit in other capitals": (
        ["run", *FREE, "--set", "beam.power_through_pupil=5 mw"], r"did you mean (\w+)\?$",
        lambda words, said: replaced(words, "5 mw", f"5 {said[1]}"),
    ),
    "rate beside samples": (
        ["run", *FREE, "--rate", "2 MHz"], r"give one of the two$",
        lambda words, said: without(words, "--set"),
    ),
    "rate too low": (
        ["run", "silica-1um", "--duration", "1 us", "--rate", "1 kHz", *FREE[5:]],
        r"choose a higher rate or a longer --duration$",
        lambda words, said: replaced(words, "1 us", "2 ms"),
    ),
    "file of another ending": (
        ["run", *FREE, "--out", "run.txt"], r"must end in (\.\w+)$",
        lambda words, said: replaced(words, ".txt", said[1]),
    ),
    "unknown recording": (
        ["examples", "bead"], r"choose from: ([\w.-]+)",
        lambda words, said: ["examples", said[1]],
    ),
    "objective with a slip": (
        ["new", "--objective", "60x/1.3"], r"did you mean (.+)\?$",
        lambda words, said: [*replaced(words, "60x/1.3", said[1]), "--depth", "9 um"],
    ),
    "oil without a depth": (
        ["new", "--objective", "100x/1.40 oil", "--depth", "none"], r"--depth 'none': must be a",
        lambda words, said: replaced(words, "none", "9 um"),
    ),
    "focus too near the glass": (
        ["new", "--depth", "1 um"], r"must be more than ([\d.]+) um",
        lambda words, said: replaced(words, "1 um", f"{float(said[1]) + 1e-6} um"),
    ),
    "seed without noise": (
        ["run", *FREE, "--seed", "3"], r"requires (forces\.brownian = true)",
        lambda words, said: [*words, "--set", said[1].replace(" ", "")],
    ),
    "setting given twice": (
        ["run", *FREE, "--set", "simulation.duration=2 us"], r"set twice, also by --set$",
        lambda words, said: without(words, "--duration"),
    ),
    "setting without a value": (
        ["run", *FREE, "--set", "beam.power"], r"must be key=value, such as (beam.power=80 mW)$",
        lambda words, said: [*words[:-1], said[1]],
    ),
    "range without a count": (
        ["sweep", *SWEPT, "--over", "bead.diameter=0.2um..3um"],
        r"must be FROM..TO:COUNT, such as (\S+),",
        lambda words, said: replaced(words, "0.2um..3um", said[1].replace(":40", ":2")),
    ),
    "key without a section to sweep over": (
        ["sweep", *SWEPT, "--over", "gibberish=1,2"], r"such as (beam\.power)$",
        lambda words, said: replaced(words, "gibberish=1,2", f"{said[1]}=1mW,2mW"),
    ),
    "cache without a terminal": (
        ["cache", "--clear"], r"requires (--yes)", lambda words, said: [*words, said[1]],
    ),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "line", "follow"), REFUSED.values(), ids=list(REFUSED))
def test_the_advice_of_a_refused_command_leads_to_a_result(
    command_line, cache_folder, arguments, line, follow
):
    refused = command_line(*arguments)
    assert refused.code == 2
    assert not list(Path().iterdir())
    said = re.search(line, refused.err.splitlines()[-1])
    assert said, refused.err
    done = command_line(*follow(arguments, said))
    assert done.code == 0, done.err


@pytest.mark.parametrize("way", ["--out", "--overwrite"])
def test_both_ways_out_of_an_existing_file_work(command_line, way):
    assert command_line("run", *FREE, "--out", "a.nc").code == 0
    other = ["run", *FREE, "--set", "bead.diameter=2 um", "--out", "a.nc"]
    refused = command_line(*other)
    assert refused.code == 2
    assert re.search(f"choose another --out or pass --overwrite.*{way}|{way}", refused.err)
    done = command_line(*(replaced(other, "a.nc", "b.nc") if way == "--out" else [*other, way]))
    assert done.code == 0
