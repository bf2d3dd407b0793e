"""The lock-in: its filter step by step, and the line of a bead at low damping.

Seeds are fixed; a right program would exceed a stochastic bound for one seed in a million.
"""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

import tweezer
from tests.dynamics.test_baths import BEAD, KT, NU, SCENE, STIFFNESS
from tests.reference.fields import LinearTrap, in_place
from tweezer.dynamics import bound_once
from tweezer.dynamics.walk import walk
from tweezer.scene.settings import with_settings
from tweezer.values.errors import SceneError

FAR = 5.0


def in_gas(quality, bandwidth, samples, duration):
    """Return the scene of a bead with a quality and a lock-in at its resonance."""
    gamma = 2 * math.pi * NU / quality
    drag = tweezer.bead_properties(SCENE.replace(medium={"pressure": "1e-3 mbar"})).drag
    pressure = 0.1 * gamma * BEAD.mass / drag  # free molecules: in proportion
    return SCENE.replace(
        medium={"pressure": pressure}, start={"drawn": "boltzmann"},
        lock_in={"frequency": NU, "bandwidth": bandwidth},
        simulation={"duration": duration, "samples": samples},
    )  # fmt: skip


def amplified(quality, bandwidth, beads, samples, duration, seed=1):
    """Return samples (beads, samples, columns) of beads in a linear trap, and their walk."""
    scene = in_gas(quality, bandwidth, samples, duration)
    one = walk(in_place(bound_once(scene), LinearTrap(STIFFNESS)), seed)
    out = np.empty((beads, samples - 1, 12))
    one.advance(one.start(np.arange(beads)), np.arange(beads), 0, out)
    return out, one


def test_filter_is_a_mixer_and_a_pole():
    """With a sample at every step, SciPy's filter of the samples gives the same amplitudes."""
    out, one = amplified(50, 2e4, 3, 1201, 30 / NU)
    assert one.per_sample == 1
    left = math.exp(-2 * math.pi * 2e4 * one.step)
    reference = np.exp(-2j * math.pi * NU * one.times[1:])
    mixed = 2 * out[:, :, :3] * reference[None, :, None]
    expected = lfilter([1 - left], [1, -left], mixed, axis=1)
    size = np.abs(expected).max()
    np.testing.assert_allclose(out[..., 6:9], expected.real, rtol=0, atol=1e-9 * size)
    np.testing.assert_allclose(out[..., 9:], expected.imag, rtol=0, atol=1e-9 * size)


def test_line_has_the_temperature_and_the_width_of_the_bead():
    """<|z|^2> = 2 kT/k, and <z* z(t)> falls as e^(-Gamma t/2), times the factor of the filter."""
    quality, bandwidth = 300.0, 4e3
    lag, per_lag = quality / (2 * math.pi * NU), 4
    out, one = amplified(quality, bandwidth, 700, 40 * per_lag + 1, 40 * lag)
    assert one.per_sample > 100
    z = (out[..., 6:9] + 1j * out[..., 9:])[:, 8:]  # the filter has settled
    half = 0.5 / lag
    passed = 1 / (1 + half / (2 * math.pi * bandwidth))  # of a Lorentzian through a pole
    of_each = (np.abs(z) ** 2).mean(axis=(1, 2)) * STIFFNESS / (2 * KT) / passed
    assert abs(of_each.mean() - 1) < FAR * of_each.std() / math.sqrt(len(of_each)) < 0.05
    together = (z[:, per_lag:].conj() * z[:, :-per_lag]).real.mean(axis=(1, 2))
    both = together.mean() / (np.abs(z) ** 2).mean()
    pole = 2 * math.pi * bandwidth
    expected = (pole * math.exp(-half * lag) - half * math.exp(-pole * lag)) / (pole - half)
    assert both == pytest.approx(expected, abs=0.03)


def test_run_contains_the_amplitudes():
    scene = SCENE.replace(
        lock_in={"frequency": NU, "bandwidth": "1 kHz"},
        simulation={"duration": "2 ms", "samples": 11},
    )
    run = tweezer.simulate(scene, seed=1)
    assert run["in_phase"].dims == ("time", "axis")
    assert run["quadrature"].units == "m"
    assert float(np.abs(run["in_phase"]).max()) > 0


def test_lock_in_may_be_written_with_a_hyphen():
    data = SCENE.model_dump(exclude_none=True) | {"lock-in": {"frequency": 1e5, "bandwidth": 1e3}}
    data["simulation"] |= {"duration": 1e-3}
    assert tweezer.load_scene(data).lock_in.frequency == 1e5
    changed = with_settings(tweezer.load_scene(data), {"lock-in.bandwidth": "2 kHz"})
    assert changed.lock_in.bandwidth == 2e3


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ({"simulation": {"samples": 3, "duration": "1 s"}}, "set simulation.samples to 2001"),
        ({"forces": {"brownian": False}, "start": {"drawn": "no"}}, "requires forces.brownian"),
        ({"lock_in": {"frequency": "-1 Hz", "bandwidth": 1.0}}, "lock_in.frequency"),
    ],
)
def test_wrong_lock_in_is_refused(sections, message):
    scene = SCENE.replace(simulation={"duration": 1e-3, "samples": 100})
    with pytest.raises(SceneError, match=message):
        scene.replace(lock_in={"frequency": NU, "bandwidth": 1e3}).replace(**sections)
