"""The force of focused light on the bead, by ray optics or wave optics."""

from tweezer.optics.beam import (
    Cone,
    cone,
    fraction_through_pupil,
    total_power,
)
from tweezer.optics.binding import (
    Beams,
    evaluators_of,
    force_map,
    light_force,
    light_of_one_beam,
)
from tweezer.optics.drawn import cone_caveat, drawn_cones
from tweezer.optics.light import LightForce
from tweezer.optics.of_scene import (
    SceneLight,
    absorbed_power,
    light,
    optical_force,
    optical_force_error,
    optical_jacobian,
    optical_torque,
)
from tweezer.optics.rays.pupil import grid
from tweezer.optics.sampled import sampled
from tweezer.optics.table import Table
from tweezer.optics.worth import (
    RayOpticsWorth,
    ray_optics_caveat,
    ray_optics_warning,
    ray_optics_worth,
    rows_of_light,
    worth_attributes,
)

__all__ = [
    "Beams",
    "Cone",
    "LightForce",
    "RayOpticsWorth",
    "SceneLight",
    "Table",
    "absorbed_power",
    "cone",
    "cone_caveat",
    "drawn_cones",
    "evaluators_of",
    "force_map",
    "fraction_through_pupil",
    "grid",
    "light",
    "light_force",
    "light_of_one_beam",
    "optical_force",
    "optical_force_error",
    "optical_jacobian",
    "optical_torque",
    "ray_optics_caveat",
    "ray_optics_warning",
    "ray_optics_worth",
    "rows_of_light",
    "sampled",
    "total_power",
    "worth_attributes",
]
