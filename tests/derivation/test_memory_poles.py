"""The table of poles: its bounds hold by their definition, and it is what the script says."""

import cmath
import itertools
import math

import numpy as np
import pytest

from derivation import memory_poles
from tweezer.generated.memory_poles import BOUNDS, ERRORS, NODES


def test_the_emitted_table_is_that_of_the_script():
    tables = memory_poles.load()
    assert list(NODES) == list(BOUNDS) == list(ERRORS) == list(memory_poles.TABLES)
    for n, table in tables.items():
        assert (table.kappa, table.w_low, table.w_high) == memory_poles.TABLES[n]
        assert NODES[n] == (table.p, table.c)
        assert BOUNDS[n] == (table.E, table.kappa, table.w_low, table.w_high)


@pytest.mark.parametrize("n", NODES)
def test_poles_and_weights_are_positive(n):
    """What makes each of them a Langevin velocity of its own."""
    p, c = NODES[n]
    assert len(p) == len(c) == n
    assert all(low < high for low, high in itertools.pairwise((0, *p)))
    assert min(c) > 0


@pytest.mark.parametrize("n", NODES)
def test_bound_holds_by_its_definition(n):
    p, c = NODES[n]
    E, kappa, w_low, w_high = BOUNDS[n]
    # other points than those of the script
    points = 13 * n
    step = math.log(50 * w_high / w_low) / points
    worst = 0.0
    for i in range(points + 1):
        s = 1j * w_low / 50 * math.exp(i * step)
        root = cmath.sqrt(s)
        error = abs(sum(b * s / (s + a) for a, b in zip(p, c, strict=True)) - root)
        weight = min(abs(1 + root + s / 9), kappa * abs(root + math.sqrt(w_low)))
        worst = max(worst, error / weight)
    assert 0.8 * E < worst <= E


def test_more_poles_are_better_in_all():
    """So that a number of poles is all that a scene has to say."""
    errors = np.array(list(ERRORS.values()))
    assert (np.diff(errors, axis=0) <= 0).all()


def test_a_table_is_made_again():
    """The smallest: the script gives what is committed, but for the last digits."""
    made, kept = memory_poles.make(8), memory_poles.load()[8]
    np.testing.assert_allclose(made.p, kept.p, rtol=1e-2)
    np.testing.assert_allclose(made.c, kept.c, rtol=1e-2)
    assert math.isclose(made.E, kept.E, rel_tol=0.02)
