"""Rules that relate several sections of a scene."""

from __future__ import annotations

import math

from tweezer.scene.choices import EVALUATORS, METHODS, MODELS, methods
from tweezer.scene.courses import refusal
from tweezer.scene.description import FREE, Description
from tweezer.scene.heating import check_heat
from tweezer.scene.interference import check_interference
from tweezer.scene.media import CONTINUUM, GASES
from tweezer.scene.messages import either
from tweezer.scene.sections import Beam
from tweezer.scene.several import check_several
from tweezer.scene.theory import NO_MAP, named_beams
from tweezer.values.errors import warn
from tweezer.values.rounding import least
from tweezer.values.units import TABLE_RADII

#: Smallest distance between two walls, in bead radii
THINNEST = 20.0
#: Fraction of a depth below which two positions are the same
_SAME_PLACE = 1e-9
#: Largest number of camera frames in a run
_MOST_FRAMES = 10_000_000


def check(scene: Description) -> None:
    """Refuse a scene whose sections contradict each other."""
    check_several(scene)
    _aperture_in_reach(scene)
    by = EVALUATORS.get(scene.optics.evaluator)
    for beam in scene.beams:
        if scene.lit and scene.optics.evaluator == "grid":
            _wider_than_a_square(scene, beam)
    if by and not scene.allows(by):
        raise refusal(NO_MAP)
    if scene.lit and scene.theory == "rays":
        _map_of_rays(scene)
    if scene.lens.cover is not None:
        _foci_at_the_depth(scene)
    check_interference(scene)
    _thermal(scene)
    _beside_the_wall(scene)
    _inertia_of_the_fluid(scene)
    _viscoelastic(scene)
    _some_frame(scene)
    _light_on_the_detector(scene)
    _slow_amplitude(scene)
    _control(scene)
    check_heat(scene)
    if scene.start.frame == "lens" and scene.lens.focal_length is None:
        raise refusal("start.frame = 'lens': requires lens.focal_length")
    _start_in_the_medium(scene)


def _aperture_in_reach(scene: Description) -> None:
    """Refuse a sine lens map whose outermost rays leave the lens at 90 degrees or more."""
    lens, key, index = scene.lens, "medium", scene.medium.refractive_index
    if lens.cover is not None:
        key, index = "lens.cover", lens.cover.refractive_index
    if lens.map == "sine" and lens.numerical_aperture and lens.numerical_aperture >= index:
        remedy = (
            "give lens.cover for an oil immersion objective, as "
            '`tweezer new --objective "100x/1.40 oil"` does'
            if lens.cover is None
            else "give the index of the immersion oil"
        )
        raise refusal(
            f"lens.numerical_aperture = {lens.numerical_aperture:g}: must be less than "
            f"{key}.refractive_index = {index:.5g} for the sine map; {remedy}"
        )


def warn_of_unused_aperture(scene: Description) -> None:
    """Warn of a numerical aperture that the lens map does not use."""
    if scene.lens.map == "tan" and scene.lens.numerical_aperture is not None:
        warn(
            "lens.numerical_aperture: has no effect with lens.map = 'tan', where lens.radius and "
            "lens.focal_length give the angles; change these, or set lens.map to sine"
        )


def _map_of_rays(scene: Description) -> None:
    """Refuse a range outside the limits of a force map by ray optics."""
    if not TABLE_RADII[0] <= scene.table_radii <= TABLE_RADII[1]:
        raise refusal(
            f"optics.table_range = {scene.optics.table_range!r}: is {scene.table_radii:.3g} "
            "radii of the bead; must be from "
            f"{TABLE_RADII[0]:g} to {TABLE_RADII[1]:g} of them for rays"
        )


def _foci_at_the_depth(scene: Description) -> None:
    """Refuse beams whose foci are not, or do not stay, at the depth behind the face of a cover."""
    for name, beam in named_beams(scene.beams):
        if beam.position[2]:
            raise refusal(
                f"{name}.position = {list(beam.position)}: must be at z = 0 with lens.cover, "
                "whose depth is the depth of the focus"
            )
        if beam.motion is not None and beam.motion.along_light:
            raise refusal(f"{name}.motion: must be perpendicular to the light with lens.cover")


def _start_in_the_medium(scene: Description) -> None:
    """Refuse a release outside the medium: in front of the lens or cover, or beyond the loss
    distance.
    """
    x, y, z = scene.start_position
    ball, radius = scene.start.ball_radius or 0.0, scene.body.support()
    given = f"start.position = {list(scene.start.position)}"
    if scene.lens.focal_length is not None and z - ball <= radius - scene.lens.focal_length:
        raise refusal(f"{given}: the bead must start beyond the lens, by more than its radius")
    if (cover := scene.lens.cover) is not None:
        towards = {"up": z, "down": -z}
        if min(towards[beam.direction] for beam in scene.beams) - ball <= radius - cover.depth:
            raise refusal(
                f"{given}: the bead must start beyond the face of lens.cover, which is "
                f"{cover.depth:.3g} m before the focus, by more than its radius"
            )
    distance = math.hypot(x, y, z) + ball
    if distance >= scene.simulation.loss_distance and not scene.more_beads:
        to = "and its ball reach to" if ball else "is"
        raise refusal(
            f"{given}: {to} {distance:.3g} m from the focus; must be nearer than "
            f"simulation.loss_distance = {scene.simulation.loss_distance:.3g} m"
        )


def _beside_the_wall(scene: Description) -> None:
    """Refuse a bead in a wall, walls that are too close, and wall forces without a wall."""
    wall, radius = scene.wall, scene.body.size
    if wall is None:
        if scene.forces.dlvo is not None:
            raise refusal("forces.dlvo: requires a [wall]")
        return
    cover = scene.lens.cover
    if cover is not None and (
        wall.side == "below" or abs(wall.position + cover.depth) > _SAME_PLACE * cover.depth
    ):
        raise refusal(
            f"wall.position = {wall.position:g}, side = {wall.side!r}: with lens.cover the "
            f"wall is its face, at {-cover.depth:g}, and the bead above it"
        )
    z, ball = scene.start_position[2], scene.start.ball_radius or 0.0
    room = {"wall": scene.gap(z)}
    if wall.opposite is not None:
        thickness = abs(wall.opposite - wall.position)
        if thickness < THINNEST * radius * (1 - 1e-9):
            raise refusal(
                f"wall.opposite = {wall.opposite:g}: {thickness:.3g} m from wall.position; "
                f"must be at least {THINNEST:g} radii, {least(THINNEST * radius)} m, "
                "so that the effects of both walls add"
            )
        across = scene.body.support(wall.normal) + scene.body.support(-wall.normal)
        room["wall.opposite"] = thickness - across - scene.gap(z)
    for name, gap in room.items():
        if gap - ball <= 0:
            raise refusal(
                f"start.position = {list(scene.start.position)}: the bead must start beside "
                f"{name}, not in it; its gap would be {gap - ball:.3g} m"
            )


def _thermal(scene: Description) -> None:
    """Refuse settings that require thermal motion if it is off, and those that exclude it."""
    method, model = scene.simulation.method, scene.simulation.model
    how = None if method == "auto" else METHODS[method]
    if not scene.forces.brownian:
        if how and how.thermal:
            raise refusal(f"simulation.method = {method!r}: requires forces.brownian = true")
        if scene.start.drawn != "no":
            raise refusal(f"start.drawn = {scene.start.drawn!r}: requires forces.brownian = true")
        if scene.forces.brownian_torque:
            raise refusal("forces.brownian_torque = True: requires forces.brownian = true")
        if scene.forces.recoil:
            raise refusal("forces.recoil = True: requires forces.brownian = true")
        if scene.noisy_light:
            raise refusal("beam.noise: requires forces.brownian = true")
        return
    if how and not how.thermal:
        raise refusal(
            f"simulation.method = {method!r}: does not compute thermal motion; allowed: auto, "
            f"{', '.join(each.name for each in methods(thermal=True))}"
        )
    if how and model and model not in how.models:
        raise refusal(
            f"simulation.method = {method!r}: cannot integrate simulation.model = {model!r}; set "
            f"simulation.model to {either(how.models)}"
        )
    if model == "first-order" and scene.rotates:
        raise refusal(
            "simulation.model = 'first-order': does not include thermal rotation; set "
            "simulation.model to overdamped"
        )
    if how and how.spring_only and scene.turned_by_light:
        raise refusal(
            f"simulation.method = {method!r}: a linear spring exerts no torque; allowed: "
            "beam.torque = 'none', and a bead that does not absorb"
        )
    if scene.rotates and scene.bead.moments_of_inertia and model != "overdamped":
        raise refusal(
            "bead.moments_of_inertia: thermal rotation with inertia is computed for spheres; "
            "remove it, or set simulation.model to overdamped"
        )


def _some_frame(scene: Description) -> None:
    """Refuse a camera with no frame or too many frames, and methods that exclude a camera."""
    if scene.camera is None:
        return
    if scene.camera.exposure > scene.simulation.duration:
        raise refusal(
            f"camera.exposure = {scene.camera.exposure:g}: must be at most simulation.duration "
            f"= {scene.simulation.duration:g}"
        )
    frames = scene.camera.rate * scene.simulation.duration
    if frames > _MOST_FRAMES:
        raise refusal(
            f"camera.rate = {scene.camera.rate:g}: gives {frames:.3g} frames in "
            f"simulation.duration = {scene.simulation.duration:g}; must be at most "
            f"{_MOST_FRAMES:,}"
        )
    method = scene.simulation.method
    if method != "auto" and not METHODS[method].displacements:
        raise refusal(
            f"simulation.method = {method!r}: a camera requires displacements, which this method "
            "does not reproduce; allowed: auto, heun"
        )


def _slow_amplitude(scene: Description) -> None:
    """Refuse a lock-in without thermal motion, or with too few samples for its bandwidth."""
    if scene.lock_in is None:
        return
    if not scene.forces.brownian:
        raise refusal("lock_in: requires forces.brownian = true")
    duration, bandwidth = scene.simulation.duration, scene.lock_in.bandwidth
    fewest = math.ceil(2 * bandwidth * duration) + 1
    if scene.simulation.samples < fewest:
        raise refusal(
            f"lock_in.bandwidth = {bandwidth:g}: requires two samples per 1/bandwidth; set "
            f"simulation.samples to {fewest}"
        )


def _control(scene: Description) -> None:
    """Refuse a controller without thermal motion, light or a method that it can act on.

    Also refuse one whose ticks do not fall on samples, or samples on ticks.
    """
    controller, simulation = scene.feedback, scene.simulation
    if controller is None:
        return
    if not scene.forces.brownian:
        raise refusal("feedback: requires forces.brownian = true")
    if controller.acts_on != "force" and not scene.lit:
        raise refusal(f"feedback.drives = {controller.acts_on!r}: requires light")
    if simulation.method != "auto" and not METHODS[simulation.method].displacements:
        raise refusal(
            f"simulation.method = {simulation.method!r}: cannot follow a controller; set "
            "simulation.method to auto"
        )
    ticks = controller.rate * simulation.duration / (simulation.samples - 1)
    most = max(ticks, 1 / ticks)
    if abs(most - round(most)) > 1e-6 * most:
        raise refusal(
            f"feedback.rate = {controller.rate:g}: there are {ticks:.6g} ticks from sample to "
            "sample; this number or its inverse must be whole"
        )


def _light_on_the_detector(scene: Description) -> None:
    """Refuse a detector for light or a bead whose scattered light is not computed."""
    if scene.detector is None:
        return
    beam, index = scene.beam, scene.medium.refractive_index
    if scene.lit and scene.theory == "rays":
        raise refusal("detector: requires wave optics; remove it")
    if scene.bead.shape != "sphere":
        raise refusal("detector: requires bead.shape = 'sphere'; remove it")
    if not scene.lit:
        raise refusal("detector: requires light; remove it")
    moves = beam.motion is not None or beam.modulation is not None
    mirrored = scene.mirror is not None or (scene.wall is not None and scene.wall.reflects)
    if scene.more_beams or moves or mirrored or beam.direction == "down":
        raise refusal(
            "detector: requires a single beam along +z, at rest and of constant power, without a "
            "reflection; remove it"
        )
    if scene.detector.numerical_aperture > index:
        raise refusal(
            f"detector.numerical_aperture = {scene.detector.numerical_aperture:g}: must be at most "
            f"the refractive index of the medium, {index:g}"
        )


def _inertia_of_the_fluid(scene: Description) -> None:
    """Refuse models, methods and walls that exclude fluid inertia."""
    inertia, model, method = scene.medium.inertia, scene.simulation.model, scene.simulation.method
    if inertia in (None, "none"):
        return
    said = f"medium.inertia = {inertia!r}"
    if scene.rarefied:
        raise refusal(
            f"{said}: the mean free path in the gas is {scene.knudsen:.2g} of the radius; above "
            f"{CONTINUUM:g} its inertia is not that of a continuum; set medium.inertia to none"
        )
    if model and not MODELS[model].inertia:
        having = either([each.name for each in MODELS.values() if each.inertia])
        past = ""
        if inertia == "memory":
            past = (
                ". The model leaves out that the bead falls behind by up to "
                f"{scene.lag:.2g} s times its speed"
            )
        raise refusal(
            f"{said}: requires inertia, which simulation.model = {model!r} lacks; set "
            f"simulation.model to {having}{past}"
        )
    if inertia != "memory":
        return
    if scene.wall is not None and min(scene.room(scene.start_position[2]), scene.room(0.0)) < (
        (FREE - 1) * scene.body.size
    ):
        raise refusal(
            f"{said}: a wall within {FREE:g} radii of start or focus absorbs the "
            "vorticity that the bead sheds (the tail falls as t^(-5/2), not t^(-3/2)); "
            "allowed: 'none', 'added-mass'"
        )
    if method != "auto" and not METHODS[method].memory:
        brownian = scene.forces.brownian
        allowed = [each.name for each in methods(thermal=brownian) if each.memory]
        raise refusal(
            f"{said}: simulation.method = {method!r} cannot integrate it; set simulation.method "
            f"to {either(['auto', *allowed])}"
        )


def _viscoelastic(scene: Description) -> None:
    """Refuse beads, walls, models and methods for which no viscoelastic drag is known."""
    medium, model, method = scene.medium, scene.simulation.model, scene.simulation.method
    if not medium.viscoelastic:
        return
    keys = "relaxing", "power_law", "elasticity"
    said = f"medium.{next(key for key in keys if getattr(medium, key))}"
    if medium.name in GASES:
        raise refusal(f"{said}: requires a liquid; remove it, or medium.name = {medium.name!r}")
    if scene.bead.shape != "sphere":
        raise refusal(f"{said}: requires bead.shape = 'sphere'; remove it")
    if scene.wall is not None:
        raise refusal(f"{said}: is not known beside a wall; remove wall")
    if scene.rotates:
        raise refusal(
            f"{said}: the rotation of a bead is not known in a viscoelastic medium; remove what "
            "turns it: absorption, beam.torque, start.angular_velocity or forces.brownian_torque"
        )
    if model not in (None, "full", "overdamped"):
        raise refusal(
            f"simulation.model = {model!r}: cannot follow {said}; must be full or overdamped; set "
            "simulation.model to full"
        )
    if method != "auto" and not METHODS[method].memory:
        allowed = [each.name for each in methods(thermal=scene.forces.brownian) if each.memory]
        raise refusal(
            f"simulation.method = {method!r}: cannot follow {said}; set simulation.method to "
            f"{either(['auto', *allowed])}"
        )
    if scene.camera is not None and scene.forces.brownian:
        raise refusal(f"{said}: the motion blur of a camera is not known there; remove camera")


def _wider_than_a_square(scene: Description, beam: Beam) -> None:
    """Refuse a beam narrower than a square of the thesis's grid of rays, which could miss it."""
    half_side = scene.lens.radius / beam.divisions
    if beam.sigma is not None and beam.sigma < half_side * (1 - 1e-9):
        raise refusal(
            f"beam.sigma = {beam.sigma:.3g}: must be at least {least(half_side)} m, half the "
            f"side of a square of the grid, for {beam.divisions} beam.divisions"
        )
    if beam.profile_radius is not None and beam.profile_radius[-1] < 2 * half_side * (1 - 1e-9):
        raise refusal(
            f"beam.profile_radius ends at {beam.profile_radius[-1]:.3g}: must reach "
            f"{least(2 * half_side)} m, the side of a square of the grid, for {beam.divisions} "
            "beam.divisions"
        )
