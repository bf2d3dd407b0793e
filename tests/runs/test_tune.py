"""`tweezer tune`: the scaled model against the unscaled one, in closed form and as a command."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tweezer import cli

SHORT = {"start": {"frame": "focus", "position": [0, 2e-7, -2e-7]},
         "simulation": {"duration": "0.1 ms"}, "optics": {"evaluator": "quadrature"}}  # fmt: skip


def test_sedimentation_deviates_by_the_closed_form():
    """x = (F/beta)(t - tau (1 - e^(-t/tau))) with tau/a2: the distance is known at every a2."""
    scene = tweezer.load_scene("thesis-990nm").replace(
        forces={"optical": False},
        simulation={"relative_tolerance": 1e-12, "position_tolerance": 1e-18},
    )
    bead = tweezer.bead_properties(scene)
    tau, terminal = bead.relaxation_time, bead.weight[2] / bead.drag
    duration = 20 * tau
    tuning = tweezer.tune(scene, [1.0, 0.1, 0.01], duration=duration)
    times = np.linspace(0, duration, 201)

    def fallen(tau):
        return terminal * (times + tau * np.expm1(-times / tau))

    for entry in tuning.entries:
        expected = np.abs(fallen(tau / entry.scaling_factor) - fallen(tau)).max()
        assert entry.deviation == pytest.approx(expected, rel=1e-5, abs=1e-19)
    assert [entry.scaling_factor for entry in tuning.entries] == [1.0, 0.1, 0.01]
    assert tuning.most_scaling_within(tuning.entries[1].deviation * 1.01).scaling_factor == 0.1
    assert tuning.most_scaling_within(-1.0) is None


def test_more_scaling_deviates_more_and_costs_less():
    scene = tweezer.load_scene("thesis-990nm").replace(**SHORT)
    done = []
    tuning = tweezer.tune(scene, [1.0, 0.1, 0.01, 1e-3], progress=done.append)
    deviations = [entry.deviation for entry in tuning.entries]
    calls = [entry.force_calls for entry in tuning.entries]
    assert deviations == sorted(deviations)
    assert calls[:3] == sorted(calls[:3], reverse=True)
    assert deviations[0] < 1e-11 < 1e-9 < deviations[-1]
    assert tuning.unscaled.force_calls < calls[0]
    assert done[-1] == 1.0
    # the thesis's first guess: 57 ns in ms
    assert tuning.epsilon == pytest.approx(5.7e-5, rel=0.02)


def test_a_scene_that_cannot_be_compared_is_refused():
    scene = tweezer.load_scene("thesis-990nm").replace(**SHORT)
    with pytest.raises(tweezer.SceneError, match="scaling_factor = 2"):
        tweezer.tune(scene, [2.0])
    body = scene.replace(
        bead={"moments_of_inertia": [4e-29, 5e-29, 6e-29]}, beam={"torque": "thesis"}
    )
    with pytest.raises(tweezer.SceneError, match="exponential"):
        tweezer.tune(body, [1.0])


def test_command(command_line, monkeypatch):
    settings = [
        argument
        for change in ("start.frame=focus", "start.position=[0, 2e-7, -2e-7]",
                       "optics.evaluator=quadrature")
        for argument in ("--set", change)
    ]  # fmt: skip
    outcome = command_line(
        "tune", "thesis-990nm", *settings, "--duration", "50 us", "--factor", "1",
        "--factor", "0.01", "--deviation", "1 nm", "--out", "tune.json", "--plot", "tune.png",
    )  # fmt: skip
    assert (outcome.code, outcome.err) == (0, "")
    tuning = json.loads(Path("tune.json").read_text())
    assert [entry["scaling_factor"] for entry in tuning["entries"]] == [1.0, 0.01]
    assert all(math.isfinite(entry["deviation"]) for entry in tuning["entries"])
    assert "within 1 nm: a2 down to" in outcome.out
    assert Path("tune.png").read_bytes().startswith(b"\x89PNG")
    monkeypatch.delattr(cli.trap, "bind_light")
    for option, value, reason in (
        ("--deviation", "3 kg", "--deviation '3 kg': "),
        ("--factor", "2", "simulation.scaling_factor = 2"),
        ("--method", "euler", "simulation.method = 'euler'"),
    ):
        bad = command_line("tune", "thesis-990nm", option, value)
        assert (bad.code, len(bad.err.splitlines())) == (2, 1)
        assert bad.err.startswith(reason)
