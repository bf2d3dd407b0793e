"""A scene as an argument: a Scene, a name, a file or a mapping; and errors of a scene."""

import inspect
import pickle
from pathlib import Path

import numpy as np
import pytest

import tweezer
from tweezer.scene import shipped_scenes
from tweezer.values.errors import SceneError

NAME = "silica-1um"
SCENE = tweezer.load_scene(NAME)
PATH = shipped_scenes()[NAME]

#: calls of functions that take a scene, cheap ones
CALLS = {
    "absorbed_power": lambda scene: tweezer.absorbed_power(scene, [0, 0, 1e-7]),
    "bead_properties": lambda scene: tweezer.bead_properties(scene).mass,
    "bind": lambda scene: tweezer.bind(scene).initial_state,
    "characterise": lambda scene: tweezer.characterise(scene).equilibrium.position,
    "chosen": lambda scene: tweezer.chosen(scene)[1],
    "light": lambda scene: tweezer.light(scene).field([0, 0, 1e-7]).force,
    "medium": lambda scene: tweezer.medium(scene).drag,
    "optical_force": lambda scene: tweezer.optical_force(scene, [0, 0, 1e-7]),
    "optical_force_error": lambda scene: tweezer.optical_force_error(scene, [0, 0, 1e-7]),
    "optical_jacobian": lambda scene: tweezer.optical_jacobian(scene, [0, 0, 1e-7]),
    "optical_torque": lambda scene: tweezer.optical_torque(scene, [0, 0, 1e-7]),
    "recoil": lambda scene: tweezer.recoil(scene, [0, 0, 1e-7]),
    "t_matrix": lambda scene: tweezer.t_matrix(scene).error,
    "resistance": lambda scene: tweezer.resistance(scene).matrix,
    "response": lambda scene: tweezer.response(scene, [1e-3], [10.0]).msd.values,
    "simulate": lambda scene: tweezer.simulate(scene, "10 us")["position"].values,
}
#: and longer ones, which only have to find the scene
NAMED = {
    "detect": tweezer.detect,
    "ensemble": lambda scene: tweezer.ensemble(scene, 0),
    "least_power": lambda scene: tweezer.least_power(scene, "-1 s"),
    "loop_moments": tweezer.loop_moments,
    "optical_binding": tweezer.optical_binding,
    "optimise": lambda scene: tweezer.optimise(scene, "k"),
    "stretch": tweezer.stretch,
    "time_sharing": tweezer.time_sharing,
    "sweep": lambda scene: tweezer.sweep(scene, {"bead.colour": [1]}),
    "trap_over_heights": lambda scene: tweezer.trap_over_heights(scene, [-1.0]),
    "tune": lambda scene: tweezer.tune(scene, [-1.0]),
}
#: these take a recording first; their scene is tried with them
WITH_RECORDING = {"calibrate", "fit", "fit_depth"}


def test_every_function_that_takes_a_scene_is_listed():
    """The list ensures that a new function accepts names as well."""
    every = {name: getattr(tweezer, name) for name in tweezer.__all__}
    takes = {
        name for name, each in every.items()
        if inspect.isfunction(each) and "scene" in inspect.signature(each).parameters
    }  # fmt: skip
    assert takes == CALLS.keys() | NAMED.keys() | WITH_RECORDING


@pytest.mark.parametrize("name", CALLS)
def test_scene_may_be_a_name_a_path_or_a_mapping(name):
    right = CALLS[name](SCENE)
    for given in (NAME, str(PATH), Path(PATH)):
        np.testing.assert_array_equal(CALLS[name](given), right)


@pytest.mark.parametrize("name", NAMED)
def test_longer_functions_find_a_scene_by_its_name(name):
    """Errors for a name are the same as for its scene."""
    said = []
    for given in (SCENE, NAME):
        with pytest.raises(SceneError) as refused:
            NAMED[name](given)
        said.append(str(refused.value))
    assert said[0] == said[1]


@pytest.mark.parametrize("name", CALLS)
def test_other_objects_than_scenes_are_refused_in_one_line(name):
    for given, message in (("silica-2um", "did you mean silica-1um?"), (3, "must be a Scene")):
        with pytest.raises(SceneError, match=message):
            CALLS[name](given)


def test_bead_has_the_diameter_in_its_file():
    assert SCENE.bead.diameter == 2 * SCENE.bead.radius == 1e-6
    coated = tweezer.load_scene("coated-1um") if "coated-1um" in shipped_scenes() else SCENE
    assert all(each.diameter == 2 * each.radius for each in coated.bead.layers or ())


def test_assignment_to_a_scene_names_replace():
    for part, key, value in (
        (SCENE, "bead", SCENE.bead), (SCENE.bead, "radius", 1e-6), (SCENE.bead, "diameter", 1e-6),
        (SCENE.medium, "temperature", 300.0), (SCENE.beam, "power", 1.0),
    ):  # fmt: skip
        with pytest.raises(AttributeError) as refused:
            setattr(part, key, value)
        said = str(refused.value)
        assert said.startswith(f"{key}: a scene is not changed in place; use scene.replace(")
        assert len(said.splitlines()) == 1


def test_bound_scene_can_be_pickled():
    """So that it can be sent to other processes: it is bound again there."""
    equations = tweezer.bind(SCENE)
    again = pickle.loads(pickle.dumps(equations))
    assert again.scene == equations.scene
    assert again.name == equations.name
    state = equations.initial_state + 1e-8
    np.testing.assert_array_equal(again.rhs(0.0, state), equations.rhs(0.0, state))
