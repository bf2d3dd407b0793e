"""Layouts of states: blocks, bodies, and no number of a column anywhere else."""

import ast
import itertools
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tweezer.dynamics.layout import QUANTITIES, Layout
from tweezer.generated import full_sphere, full_translation, scaled_sphere_euler_rates

PACKAGE = Path(tweezer.__file__).parent
#: Rooms whose modules hold states
ROOMS = ("dynamics", "ensembles", "runs", "tracking", "trap")
#: Columns at which a block of some emitted state or sample begins or ends, but for 0
EDGES = {3, 4, 6, 7, 9, 10, 13, 14}
#: Slices of other arrays that have such an edge
OTHERS = {
    "value[0, :4]",  # mobilities of a drag
    "functions[:3]",  # returned by a function
    "functions[3:]",
    "block[3:]",  # two variances
    "samples[:, 0]",  # the first sample of every trajectory
    "work.chi[:3]",
    "work.chi[3:6]",  # room for two vectors
    "beads.lock_in[:3, :n]",  # of the array of a batch of beads, which is no state
    "beads.lock_in[3:, :n]",
}
#: Names of variables and attributes that hold states or samples, columns last
STATES = {"state", "states", "sample", "samples", "initial_state", "begin_state"}


def _numbers(part: ast.expr | None) -> set[int]:
    """Whole numbers in a sum."""
    if isinstance(part, ast.BinOp) and isinstance(part.op, ast.Add | ast.Sub):
        return _numbers(part.left) | _numbers(part.right)
    if isinstance(part, ast.UnaryOp):
        return _numbers(part.operand)
    return {part.value} if isinstance(part, ast.Constant) and type(part.value) is int else set()


def _literal_columns(source: str) -> list[str]:
    """Subscripts that select columns of a state by number.

    These are slices with a number at the edge of a block, and indices by number along the columns
    of a variable with the name of a state. A single index of a state may be one of its rows.
    """
    found = []
    for each in ast.walk(ast.parse(source)):
        if not isinstance(each, ast.Subscript):
            continue
        axes = each.slice.elts if isinstance(each.slice, ast.Tuple) else [each.slice]
        slices = [one for one in axes if isinstance(one, ast.Slice)]
        at_edge = any(EDGES & (_numbers(one.lower) | _numbers(one.upper)) for one in slices)
        name = getattr(each.value, "attr", getattr(each.value, "id", ""))
        by_number = name in STATES and len(axes) > 1 and slices[-1:] != axes[-1:]
        by_number = by_number and bool(_numbers(axes[-1]))
        if (at_edge or by_number) and ast.unparse(each) not in OTHERS:
            found.append(ast.unparse(each))
    return found


def test_literal_columns_are_found():
    """The count itself: of each kind one, and what is none."""
    source = "y[3:7]; x[:, :3]; states[:, -1]; state[0, 2]; out[..., 10 : 10 + n]; v[3 + i : n]"
    assert len(_literal_columns(source)) == 6
    assert not _literal_columns("state[0]; states[:, at]; x[:, :2]; y[1:]; states[i, a:b]; z[3]")


@pytest.mark.parametrize("room", ROOMS)
def test_no_module_selects_columns_of_a_state_by_number(room):
    found = {
        path.name: columns
        for path in (PACKAGE / room).rglob("*.py")
        if path.name != "layout.py" and (columns := _literal_columns(path.read_text("utf-8")))
    }
    assert not found


@pytest.mark.parametrize("module", [full_translation, full_sphere, scaled_sphere_euler_rates])
def test_blocks_of_an_emitted_state_are_those_of_its_names(module):
    layout = Layout.of_emitted(module.STATE)
    assert layout.width == layout.size == len(module.STATE)
    first = {"position": "q1", "velocity": "v1", "orientation": "e0", "angular_velocity": "omega1",
             "euler_rates": "edot0"}  # fmt: skip
    assert [first[name] for name in layout.blocks] == [
        module.STATE[layout.first(name)] for name in layout.blocks
    ]
    stems = [[each.rstrip("0123456789") for each in module.STATE[layout.at(name)]]
             for name in layout.blocks]  # fmt: skip
    assert all(len(set(each)) == 1 for each in stems)
    assert layout.first("memory") == -1
    assert "memory" not in layout


@pytest.mark.parametrize(("inertial", "rotates"), list(itertools.product([False, True], repeat=2)))
def test_a_state_of_thermal_motion_begins_with_its_sample(inertial, rotates):
    shown = Layout.of_samples(inertial=inertial, rotates=rotates)
    state = shown.followed_by(exposure=6, memory=0, lost_time=1)
    assert shown.columns[:3] == ("x", "y", "z")
    assert len(shown.columns) == shown.width
    for name in shown.blocks:
        assert shown.columns[shown.at(name)] == QUANTITIES[name].columns
        assert state.at(name) == shown.at(name)
    assert "memory" not in state
    assert state.at("exposure") == slice(shown.width, shown.width + 6)
    assert state.first("lost_time") == state.width - 1


def test_two_bodies_have_a_row_each():
    """The state of a copy is the rows of its bodies, and one body has the columns of a row."""
    one = Layout.of_samples(inertial=True, rotates=True).followed_by(memory=9, lost_time=1)
    pair = Layout(one.blocks, bodies=2)
    assert (pair.width, pair.size) == (one.width, 2 * one.width)
    rows = np.arange(3.0 * pair.size).reshape(6, pair.width)
    copies = rows.reshape(3, pair.size)
    by_body = pair.by_body(rows)
    assert by_body.shape == (3, 2, pair.width)
    assert np.shares_memory(by_body, rows)
    assert np.array_equal(pair.by_body(copies), by_body)
    for name, body in itertools.product(pair.blocks, range(2)):
        assert pair.at(name, 0) == one.at(name)
        for copy in range(3):
            of_row = rows[copy * 2 + body, one.at(name)]
            assert np.array_equal(copies[copy, pair.at(name, body)], of_row)
            assert np.array_equal(by_body[copy, body, one.at(name)], of_row)
    more = pair.followed_by(controller=2)
    assert more.at("controller", 1) == slice(more.size - 2, more.size)
