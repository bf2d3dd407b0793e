"""The advice on recordings, followed to the letter on records whose truth is known.

Every refusal and finding that names an option or a value is in `ADVICE` or `FINDINGS` with an input
that causes it. The options are taken from the message itself. Afterwards the recording is right, or
it is refused or marked again. `...` in a message stands for what only the user knows: followed as
it is written, it is refused.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import pytest

import tweezer
from tests.reference.free_bead import free
from tests.reference.trapped_bead import trapped
from tweezer.calibration import calibrate, diffusion, load_trajectories
from tweezer.reading import load_recording

T, K, DRAG, STEP, N = 293.15, 2e-6, 9.44e-9, 1e-3, 1500
#: um: a bead with a relaxation time of 4.7 steps
X, Y = 1e6 * trapped(STEP, N, K, DRAG, None, T, 21, 2)
ROWS = np.arange(N)
TIMES = STEP * ROWS
RNG = np.random.default_rng(22)
SHUFFLED = RNG.permutation(N)
#: seconds of a clock whose stamps are uneven, and of one that is set back
UNEVEN = TIMES + 0.3 * STEP * RNG.standard_normal(N).clip(-0.8, 0.8)
SET_BACK = TIMES - 0.0503 * (TIMES > 0.7)


def table(heading: str, *columns: Any, mark: str = ",") -> str:
    rows = (mark.join(x if isinstance(x, str) else f"{x:.9g}" for x in row)
            for row in zip(*columns, strict=True))  # fmt: skip
    return "\n".join([*([heading] if heading else []), *rows]) + "\n"


NONE: Mapping[str, str] = MappingProxyType({})


class Read(NamedTuple):
    """A table that is refused, and what the advice must lead to."""

    text: str
    options: Mapping[str, str] = NONE
    ending: str = "right"
    """"right", or what the next refusal says"""


def in_turn(*of_beads):
    return np.stack(of_beads, axis=1).ravel()


#: by a part of the message that is the same for all inputs
ADVICE = {
    "has no headings": Read(table("", TIMES, X)),
    "has no headings over its 1": Read(table("", X), {}, "give the rate of rows"),
    "has frames and no times": Read(table("frame,x [um]", ROWS, X), {}, "rate = '... Hz'"),
    "give the rate of rows at even times": Read(table("x [um]", X), {}, "rate = '... Hz'"),
    "name others": Read(table("Zeit,A [um]", TIMES, X)),
    "name others, a count first": Read(table("Nr,A [um]", ROWS, X), {}, "has frames and no times"),
    "name others, masses first": Read(table("mass,Zeit,A [um]", RNG.random(N), TIMES, X)),
    "read it without": Read(table("t [s],y [um]", TIMES, X)),
    "two columns for x": Read(table("t,x [um],x [nm]", TIMES, X, 1e3 * X)),
    "two columns for t": Read(table("t,time,x [um]", TIMES, TIMES, X)),
    "columns have numbers too": Read(table("t,x [um],x [um]", TIMES, X, Y),
                                     {"columns": "x=x [um]"}),
    "no column is called": Read(table("t,x [um]", TIMES, X), {"columns": "x=place"}, "no column"),
    "length of a pixel": Read(table("t,x_px", TIMES, X), {}, "scale = '... nm'"),
    "omit it": Read(table("t,x [um]", TIMES, X), {"scale": "1 nm"}),
    "omit --rate": Read(table("t,x [um]", TIMES, X), {"rate": "100 Hz"}),
    "deviate from those of --rate": Read(table("t,x [um]", TIMES + 0.9 * STEP * (ROWS % 2), X),
                                {"rate": "1 kHz"}, "no column is called '...'"),
    "its clock runs backwards": Read(table("t,x [um]", SET_BACK, X)),
    "stamps repeat": Read(table("t,x [um]", np.floor(TIMES / 0.0025) * 0.0025, X)),
    "not in the order": Read(table("frame,x [um]", ROWS[SHUFFLED], X[SHUFFLED]),
                             {"columns": "x=x [um]", "rate": "1 kHz"}),
    "occur more than once": Read(table("t,x [um]", in_turn(TIMES, TIMES[::-1]), in_turn(X, Y)), {},
                                 "no column is called 'ID'"),
    "name the one to be read": Read(table("t,x [um],particle", in_turn(TIMES, TIMES),
                                          in_turn(X, Y + 3), np.arange(2 * N) % 2)),
    "is not in the column": Read(table("t,x [um],bead", in_turn(TIMES, TIMES), in_turn(X, Y + 3),
                                       np.arange(2 * N) % 2), {"bead": "9"}),
    "no column distinguishes": Read(table("t,x [um]", TIMES, X), {"bead": "1"}, "must name all"),
    "give the rate: --rate": Read(table("t,x [um]", UNEVEN, X)),
    "is not a number; rows": Read(table("t,x [um]", ["12:30:01.001"] * N, X), {}, "'... Hz'"),
    "name the others -": Read(table("", TIMES, X, Y), {"columns": "t [s],x [um]"}),
}  # fmt: skip
#: what the user decides, where a message has no option to take
BY_HAND: dict[str, Callable[[str, Mapping[str, str]], dict[str, str]]] = {
    "omit it": lambda said, options: {},
    "omit --rate": lambda said, options: {},
    "name the others -": lambda said, options: {"columns": options["columns"] + ",-"},
    "is not in the column": lambda said, options: {"bead": said.split("one of ")[1][0]},
    "columns have numbers too": lambda said, options: {"columns": said.split('such as "')[1][:-1]},
    "the column that distinguishes": lambda said, options: {
        **options,
        "columns": "bead=ID,x=x [um]",
    },
}


def load(path: Path, options: Mapping[str, str]) -> tweezer.Recording | str:
    try:
        return load_recording(path, **options)
    except tweezer.ResultError as error:
        return str(error)


def followed(said: str, options: Mapping[str, str]) -> dict[str, str]:
    """Return the options that a message names, beside those that are given already."""
    for part, do in BY_HAND.items():
        if part in said:
            return do(said, options)
    named = re.findall(r'--(columns|rate|scale|bead) (".*?")', said)
    assert named, f"nothing to follow: {said}"
    return {**options, **{name: shlex.split(value)[0] for name, value in named}}


@pytest.mark.parametrize("part", [*ADVICE])
def test_the_advice_of_a_refusal_leads_to_the_recording(tmp_path, part):
    """Read with the options of the message, positions and rate are the true ones."""
    case = ADVICE[part]
    path = tmp_path / "a.csv"
    path.write_text(case.text, encoding="utf-8")
    said = load(path, case.options)
    assert isinstance(said, str)
    assert part.partition(",")[0] in said
    options = followed(said, case.options)
    found = load(path, options)
    if case.ending != "right":
        assert isinstance(found, str)
        assert case.ending in found
        return
    assert isinstance(found, tweezer.Recording), found
    np.testing.assert_allclose(1e6 * found.positions[:, 0], X, rtol=1e-6, atol=1e-9)
    assert abs(found.step / STEP - 1) < 2e-3


def test_another_rate_than_that_of_unread_times_is_reported(tmp_path):
    """The other half of an advice: the columns without the time, at a rate that is wrong."""
    path = tmp_path / "a.csv"
    path.write_text(table("t [s],x [um]", TIMES, X), encoding="utf-8")
    found = load(path, {"columns": "x=x [um]", "rate": "100 Hz"})
    assert isinstance(found, tweezer.Recording)
    assert found.note == "its column 't [s]', which is not read, has 1000 Hz"


def recording(x, step=STEP, y=None):
    columns = np.stack([x, X if y is None else y], axis=1)
    times = step * np.arange(len(x))
    return tweezer.Recording(times, 1e-6 * columns, ("x", "y"), name="mine")


#: ten times finer, for the means over an exposure
FINE = 1e6 * trapped(STEP / 10, 10 * N, K, DRAG, None, T, 23, 2)
BLURRED = FINE.reshape(2, N, 10).mean(axis=2)
WAVE = 0.03 * np.sin(2 * np.pi * 120 * TIMES)
DRIFT = 0.08 * TIMES / TIMES[-1]
BEGIN = np.where(ROWS < 20, 1.5 * np.exp(-ROWS / 5), 0)
#: finding: recording, the options that its text has, and with which option
FINDINGS = {
    "blur": (recording(*BLURRED[:1], y=BLURRED[1]), {},
             r"averaged over about (\S+ ms)", "exposure"),
    "noise": (recording(X + 0.03 * RNG.standard_normal(N)), {"exposure": 0.0},
              r"white noise of about (\S+ nm)", "noise"),
    "exposure": (recording(X[::5], 5 * STEP, Y[::5]), {}, r"exposure = (0)", "exposure"),
    "drift": (recording(X + DRIFT), {"exposure": 0.0}, r"rms below (\S+ Hz)", "drift"),
    "line": (recording(X + WAVE), {"exposure": 0.0}, r"oscillates at (\S+) Hz", "leave_out"),
    "rounded": (recording(np.round(X / 0.04) * 0.04), {"exposure": 0.0},
                r'--noise "(.*)"', "noise"),
    "start": (recording(X + BEGIN), {"exposure": 0.0}, r"omit the (beginning)", "skip"),
}  # fmt: skip


@pytest.mark.parametrize("name", FINDINGS)
def test_the_advice_of_a_finding_leads_to_the_stiffness(name):
    """Each number that is not marked afterwards is within four of its uncertainties."""
    source, options, pattern, option = FINDINGS[name]
    before = calibrate(source, temperature=T, **options).axes[0]
    finding = next(each for each in before.findings if each.name == name)
    value = re.search(pattern, finding.text)[1]
    if option == "leave_out":
        options = {**options, "leave_out": [f"{float(value) - 3} Hz..{float(value) + 3} Hz"]}
    elif option == "skip":
        source = source.since("50 ms")
    else:
        options = {**options, option: 0.0 if value == "0" else value}
    after = calibrate(source, temperature=T, **options).axes[0]
    assert name not in [each.name for each in after.findings]
    trusted = [each for each in after.estimates if not each.findings]
    assert trusted or after.findings
    for each in trusted:
        assert abs(each.stiffness - K) < 4 * each.uncertainty


@pytest.mark.parametrize(
    "shown",
    [np.repeat(X, 2)[:N], X[np.where(RNG.random(N) < 0.2, np.maximum(ROWS - 1, 0), ROWS)],
     np.concatenate([X[:700], X[:800]]), in_turn(X[:700] + 0.3, Y[:700]),
     1e6 * RNG.permutation(np.cumsum(1e-8 * RNG.standard_normal(N)))],
    ids=["twice", "repeated", "copied", "in turn", "shuffled"],
)  # fmt: skip
def test_fault_without_a_remedy_keeps_its_finding(shown):
    """Whatever exposure and noise are given, no number loses its mark."""
    source = recording(shown, y=shown)
    for options in ({"exposure": 0.0}, {"exposure": STEP}, {"exposure": 0.0, "noise": 5e-9}):
        for axis in calibrate(source, temperature=T, **options).axes:
            assert all(each.findings for each in axis.estimates)


def test_the_advice_on_short_tracks_and_held_beads(tmp_path, command_line):
    """A track that is too short for a trap gives a diffusion; held beads are named one by one."""
    x = 1e6 * free(0.01, 60, 1e-12, 5, count=2, noise=5e-8)
    short = tmp_path / "short.csv"
    short.write_text(table("t,x [um],y [um]", 0.01 * np.arange(60), *x), encoding="utf-8")
    low, high = diffusion(load_trajectories(short)).interval
    assert low < 1e-12 < high
    held = table(
        "frame,x [um],particle", np.repeat(ROWS, 2), in_turn(X, Y + 3), np.arange(2 * N) % 2
    )
    (tmp_path / "held.csv").write_text(held, encoding="utf-8")
    given = ("--rate", "1 kHz", "--temperature", "20 degC", "--blur", "0")
    refused = command_line("calibrate", "held.csv", *given)
    way = shlex.split(refused.err.partition("such as ")[2])
    assert way == ["--bead", "0"]
    found = load_recording(tmp_path / "held.csv", rate="1 kHz", bead=way[1])
    np.testing.assert_allclose(1e6 * found.positions[:, 0], X, rtol=1e-6, atol=1e-9)


def test_examples_in_refusals_are_accepted(tmp_path):
    """The example in quotes replaces the value that was refused."""
    path = tmp_path / "a.csv"
    path.write_text(table("t [s],x_px", TIMES, X), encoding="utf-8")
    with pytest.raises(tweezer.ResultError) as refused:
        load_recording(path, scale="abc")
    for scale in re.findall(r'"(.*?)"', str(refused.value))[:2]:
        assert isinstance(load_recording(path, scale=scale), tweezer.Recording)
    with pytest.raises(tweezer.ResultError) as refused:
        calibrate(recording(X), temperature=T, exposure=0.0, leave_out=["5"])
    (band,) = re.findall(r'the form "(.*?)"', str(refused.value))
    assert calibrate(recording(X), temperature=T, exposure=0.0, leave_out=[band]).axes


#: what the user knows, where a message asks for it
KNOWN = {
    "--temperature": "20 degC", "--radius": "500 nm", "--viscosity": "1.002 mPa s",
    "--density": "2000 kg/m^3", "--focus": "1 um",
}  # fmt: skip


@pytest.mark.parametrize(
    "given",
    [[], ["--temperature", "20 degC", "--density", "2000 kg/m^3"],
     ["--temperature", "20 degC", "--wall", "5 um"],
     ["--temperature", "20 degC", "--fluid-density", "998 kg/m^3"], ["--focal-shift", "fit"],
     ["--temperature", "20 degC", "--wall", "5 um", "--focus", "1 um"]],
    ids=["temperature", "density", "wall", "fluid", "focus", "wall and focus"],
)  # fmt: skip
def test_options_from_error_messages_lead_to_a_calibration(command_line, tmp_path, given):
    """Each refusal asks for options until there is a result; each asks for another one."""
    text = table("t,x [um]", TIMES[:400], X[:400])
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    options = [*given]
    for _ in range(5):
        outcome = command_line("calibrate", "a.csv", "--blur", "0", *options)
        if outcome.code == 0:
            return
        assert len(outcome.err.splitlines()) == 1
        if "omit one of them" in outcome.err:
            options = options[:-2]
            continue
        if "to fit 2 unknowns" in outcome.err:  # one height is no wall
            return
        text = re.split(r"needs|goes with|requires", outcome.err)[1]
        asked = [each for each in re.findall(r"--[a-z-]+", text) if each not in options]
        assert asked, outcome.err
        options += [part for option in asked for part in (option, KNOWN[option])]
    raise AssertionError(outcome.err)
