"""Forces of one's own in sweeps, ensembles and at the command line: by the names of their files."""

import numpy as np
import pytest

import tweezer
from tweezer import SceneError
from tweezer.forces import UserForce, kernel, number

DARK = tweezer.load_scene("silica-1um").replace(
    forces={"optical": False, "gravity": False, "buoyancy": False},
    medium={"inertia": "none"},
    start={"position": [1e-7, 0, 0]},
    simulation={"model": "overdamped", "duration": "2 ms", "samples": 21},
)
STIFFNESS = 2e-5
FILE = """
from tweezer.forces import UserForce, kernel, number


@kernel
def pull(pose, data, wrench):
    for i in range(len(pose.position)):
        for k in range(3):
            wrench.force[i, k] -= number(data, 0) * pose.position[i, k]


spring = UserForce(pull, (2e-5,))
"""


@kernel
def pull(pose, data, wrench):
    for i in range(len(pose.position)):
        for k in range(3):
            wrench.force[i, k] -= number(data, 0) * pose.position[i, k]


SPRING = UserForce(pull, (STIFFNESS,))


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "handles.py"
    path.write_text(FILE)
    return path


def ends(scene):
    """Return the position of the bead in the spring, for each radius, by the exponential law."""
    beta = 6 * np.pi * scene.medium.viscosity * np.array([4e-7, 5e-7])
    return 1e-7 * np.exp(-STIFFNESS * 2e-3 / beta)


def test_sweep_of_runs_follows_the_law(file):
    over = {"bead.radius": [4e-7, 5e-7]}
    found = tweezer.sweep(DARK, over, "run", forces=[SPRING])
    assert found["end"].values[:, 0] == pytest.approx(ends(DARK), rel=1e-4)
    named = tweezer.sweep(DARK, over, "run", forces=["handles.py:spring"], workers=2)
    assert named["end"].values == pytest.approx(found["end"].values, rel=1e-12)


def test_sweep_of_traps_has_the_stiffness_of_the_spring():
    over = {"bead.radius": [4e-7, 5e-7]}
    found = tweezer.sweep(DARK, over, "trap", forces=[SPRING])
    assert found["stiffness"].values == pytest.approx(np.full((2, 3), STIFFNESS), rel=1e-6)


def test_stored_sweep_is_resumed_with_the_same_file_alone(file, tmp_path):
    how = {"over": {"bead.radius": [5e-7]}, "of": "run", "workers": 1}
    out = tmp_path / "swept.zarr"
    with pytest.raises(SceneError, match="forces: can be combined with out only if"):
        tweezer.sweep(DARK, **how, out=out, forces=[SPRING])
    first = tweezer.sweep(DARK, **how, out=out, forces=["handles.py:spring"])
    again = tweezer.sweep(DARK, **how, out=out, forces=["handles.py:spring"], resume=True)
    assert np.array_equal(first["end"], again["end"])
    file.write_text(FILE.replace("2e-5", "3e-5"))
    with pytest.raises(tweezer.ResultError, match=r"forces from handles\.py"):
        tweezer.sweep(DARK, **how, out=out, forces=["handles.py:spring"], resume=True)


def test_ensemble_is_stored_with_a_named_force(file, tmp_path):
    scene = DARK.replace(forces={"brownian": True})
    out = tmp_path / "many.zarr"
    stored = tweezer.ensemble(scene, 4, seed=1, out=out, forces=["handles.py:spring"])
    here = tweezer.ensemble(scene, 4, seed=1, forces=[SPRING])
    assert stored["position"].values == pytest.approx(here["position"].values, rel=1e-9)
    file.write_text(FILE.replace("2e-5", "3e-5"))
    with pytest.raises(tweezer.ResultError):
        tweezer.ensemble(scene, 4, seed=1, out=out, forces=["handles.py:spring"], resume=True)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("handles.py", "must be FILE.py:NAME"),
        ("other.py:spring", "No such file"),
        ("handles.py:sprung", "has no sprung; forces in it: spring"),
        ("handles.py:pull", r"did you mean \[UserForce\(pull\)\]"),
        ("broken.py:spring", "ZeroDivisionError in broken.py"),
    ],
)
def test_wrong_names_are_refused_in_one_line(file, tmp_path, text, told):
    (tmp_path / "broken.py").write_text("1 / 0")
    with pytest.raises(SceneError, match=told) as refused:
        tweezer.simulate(DARK, forces=[text])
    assert "\n" not in str(refused.value)


def test_command_run_has_the_force_in_its_file(command_line, file):
    settings = [f"{key}={value}" for key, value in {
        "forces.optical": "false", "forces.gravity": "false", "forces.buoyancy": "false",
        "simulation.model": "overdamped", "simulation.samples": 21, "medium.inertia": "none",
    }.items()]  # fmt: skip
    changes = [part for each in settings for part in ("--set", each)]
    run = (
        "run",
        "silica-1um",
        "--duration",
        "2 ms",
        *changes,
        "--set",
        "start.position=[1e-7, 0, 0]",
    )
    done = command_line(*run, "--force", "handles.py:spring")
    assert done.code == 0, done.err
    written = tweezer.load_run("silica-1um.nc")
    assert float(written["position"][-1, 0]) == pytest.approx(ends(DARK)[1], rel=1e-4)
    assert written.attrs["forces_from"].startswith("handles.py:spring, sha256 ")
    again = command_line(*run, "--force", "handles.py:spring")
    assert again.code == 0, again.err
    refused = command_line(*run)
    assert refused.code == 2
    assert "already holds a run with other forces" in refused.err


def test_command_characterises_the_trap_of_a_force_in_a_file(file, command_line):
    dark = ("--set", "forces.optical=false", "--set", "forces.gravity=false")
    dark += ("--set", "forces.buoyancy=false")
    done = command_line(
        "trap", "silica-1um", *dark, "--force", "handles.py:spring", "--json", "t.json"
    )
    assert done.code == 0, done.err
    found = tweezer.load("t.json")
    assert found.other_forces == 1
    np.testing.assert_allclose(found.stiffness, STIFFNESS * np.eye(3), atol=1e-9 * STIFFNESS)
    refused = command_line("trap", "silica-1um", "--force", "handles.py:spring", "--plot", "t.png")
    assert refused.code == 2
    assert "--force: cannot be combined with --plot" in refused.err
