"""The command `tweezer new`, which writes a scene file from answers about an experiment."""

from __future__ import annotations

import difflib
import math
import re
import shlex
import sys
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple, TypeVar

import typer

from tweezer.cli.app import Overwrite, app, quantity_in
from tweezer.cli.completion import among
from tweezer.cli.console import ERR, OUT, writable_result
from tweezer.cli.tables import table_of
from tweezer.scene.catalogue import GLASS, LASERS, OBJECTIVES, Objective
from tweezer.scene.materials import Material, materials
from tweezer.values.errors import SceneError
from tweezer.values.prefixes import factor, per, usual_unit
from tweezer.values.printed import in_unit, printed

if TYPE_CHECKING:
    from rich.table import Table

Answer = TypeVar("Answer")

#: Default diameter of a bead by material, above which trapping is hardly possible; otherwise 1 um
_DIAMETERS = {"gold": "100 nm", "silicon": "150 nm"}
#: Default power for absorbing materials, which heats a bead by less than some 20 K
_POWERS = {"gold": "10 mW"}
#: Refractive index and viscosity of water, Pa s, approximately; speed of light, m/s
_WATER, _VISCOSITY, _C = 1.33, 1e-3, 2.998e8
#: Diameter below which the scene needs a mean free path, for the validity of Stokes' drag, m
_SMALL = 0.3e-6


#: Questions that `tweezer new` asks at a terminal, by the option that answers each
QUESTIONS = {
    "bead": "material of the bead",
    "diameter": "diameter of the bead",
    "objective": "objective",
    "laser": "wavelength of the laser in vacuum",
    "power": "power behind the objective",
    "depth": "focus depth behind the cover glass (none: far from it)",
}


class _NearlyError(SceneError):
    """Error for an answer that is not a valid choice but close to `choice`."""

    def __init__(self, message: str, choice: str) -> None:
        super().__init__(message)
        self.choice = choice


class _Experiment(NamedTuple):
    """Answers to the questions about an experiment, in SI units: lengths in m, power in W."""

    material: Material
    diameter: float
    objective: Objective
    wavelength: float
    power: float
    depth: float | None
    """distance of the focus from the cover glass; None if it is far away"""


@app.command()
def new(
    file: Annotated[Path, typer.Argument(help="Scene file to write.", metavar="FILE")] = Path(
        "mine.toml"
    ),
    bead: Annotated[
        str | None,
        typer.Option(
            help=f"Material of the bead: {', '.join(materials())}.",
            metavar="NAME",
            autocompletion=among(materials()),
        ),
    ] = None,
    diameter: Annotated[str | None, typer.Option(help='Diameter of the bead, e.g. "1 um".')] = None,
    objective: Annotated[
        str | None,
        typer.Option(
            help=f"Objective: {', '.join(OBJECTIVES)}.",
            metavar="NAME",
            autocompletion=among(OBJECTIVES),
        ),
    ] = None,
    laser: Annotated[
        str | None,
        typer.Option(
            help=f"Laser: {', '.join(LASERS)}, or another wavelength in vacuum.",
            metavar="WAVELENGTH",
            autocompletion=among(LASERS),
        ),
    ] = None,
    power: Annotated[
        str | None, typer.Option(help='Power behind the objective, e.g. "50 mW".')
    ] = None,
    depth: Annotated[
        str | None,
        typer.Option(help='Focus depth behind the cover glass, e.g. "5 um"; none if far from it.'),
    ] = None,
    overwrite: Overwrite = False,
) -> None:
    """Write a scene of your own.

    FILE is mine.toml by default. The command asks for each quantity without an option. Without a
    terminal it uses the default and prints it.
    """
    file = writable_result(file, ("toml",), overwrite=overwrite, option="FILE")
    material = _answer("bead", bead, "polystyrene", _material, _of_materials)
    size = _answer("diameter", diameter, _DIAMETERS.get(material.name, "1 um"), _diameter)
    lens = _answer("objective", objective, next(iter(OBJECTIVES)), _objective, _of_objectives)
    wavelength = _answer(
        "laser", laser, next(iter(LASERS)), lambda text: _wavelength(text, material), _of_lasers
    )
    of_laser = (each.power for each in LASERS.values() if each.wavelength == wavelength)
    usual = _POWERS.get(material.name) or next(of_laser, "20 mW")
    power_in_watts = _answer("power", power, usual, _power)
    far = "none" if lens.immersion != "oil" else _usual(max(5e-6, 3 * size / 2), "m")
    behind = _answer("depth", depth, far, lambda text: _depth(text, lens, size))
    experiment = _Experiment(material, size, lens, wavelength, power_in_watts, behind)
    text = scene_text(experiment)

    from tweezer.scene import load_scene
    from tweezer.values.files import replacing

    load_scene({"name": file.stem, **tomllib.loads(text)})
    writable_result(file, ("toml",), overwrite=overwrite, option="FILE")  # it may exist by now
    with replacing(file) as whole:
        whole.write(text.encode())
    OUT.print(f"wrote {file}", highlight=False, soft_wrap=True)
    for command, purpose in (("view", "to see it"), ("trap", "for its trap")):
        line = f"  tweezer {command} {shlex.quote(str(file))}"
        OUT.print(f"{line}   {purpose}", highlight=False, soft_wrap=True)


def _asks() -> bool:
    """Return whether questions can be asked: input and output are both a terminal."""
    return sys.stdin.isatty() and sys.stdout.isatty()


def _answer(
    option: str,
    given: str | None,
    default: str,
    read: Callable[[str], Answer],
    choices: Callable[[], tuple[Table, list[str]]] | None = None,
) -> Answer:
    """Return the value of an option; otherwise ask at a terminal, or use the default.

    `read` converts an answer to a value, or raises `SceneError`. At a terminal the row number in
    the table of `choices` is also an answer, and Enter accepts a suggested correction.
    """
    if given is not None:
        return read(given)
    if not _asks():
        ERR.print(f"--{option} not given: {default}", highlight=False, soft_wrap=True)
        return read(default)

    rows: list[str] = []
    if choices:
        table, rows = choices()
        OUT.print(table)
    while True:
        text = typer.prompt(QUESTIONS[option], default=default).strip()
        if text.isdecimal() and 1 <= int(text) <= len(rows):
            text = rows[int(text) - 1]
        try:
            return read(text)
        except _NearlyError as error:
            default = error.choice
            OUT.print(f"{error} Press Enter to accept.", highlight=False, soft_wrap=True)
        except SceneError as error:
            OUT.print(f"Error: {error}", highlight=False, soft_wrap=True)


def _named(option: str, text: str, names: Mapping[str, Iterable[str]]) -> str:
    """Return the name that a text denotes: the name itself, an alias, or an unambiguous beginning.

    Case, spaces, hyphens, underscores and slashes are ignored. `names` has the aliases by name.
    """
    folded = {_folded(word): name for name, more in names.items() for word in (name, *more)}
    if (name := folded.get(_folded(text))) is not None:
        return name
    start = _folded(text)
    begun = {word: name for word, name in folded.items() if start and word.startswith(start)}
    whole = {name for word, name in begun.items() if not word[len(start)].isdigit()}
    for only in (whole, set(begun.values())):
        if len(only) == 1:
            return only.pop()
    near = [folded[each] for each in difflib.get_close_matches(_folded(text), folded, n=1)]
    if near or begun:
        choice = (near or list(begun.values()))[0]
        raise _NearlyError(f"--{option} {text!r}: did you mean {choice}?", choice)
    raise SceneError(f"--{option} {text!r}: allowed: {', '.join(names)}")


def _folded(text: str) -> str:
    """Return a text in a form for comparison: lower case, without separators, and 1.30 as 1.3."""
    return re.sub(r"(?<=\.[0-9])0|[\s_/-]", "", text.lower())  # 1.3 is 1.30


def _material(text: str) -> Material:
    """Return the material with this name or alias."""
    names = {name: each.aliases for name, each in materials().items()}
    return materials()[_named("bead", text, names)]


def _objective(text: str) -> Objective:
    """Return the objective with this name."""
    return OBJECTIVES[_named("objective", text, dict.fromkeys(OBJECTIVES, ()))]


def _diameter(text: str) -> float:
    """Return the diameter of a bead, m, from text."""
    from tweezer.values.units import BEAD_RADIUS, Quantity

    low, high = BEAD_RADIUS
    return quantity_in("--diameter", text, Annotated[float, Quantity("m", 2 * low, 2 * high)])


def _wavelength(text: str, material: Material) -> float:
    """Return a vacuum wavelength, m, from a length or the name of a laser (the "nm" is optional).

    Raises `SceneError` unless the refractive indices of material and water are known there.
    """
    from tweezer.scene.water import WAVELENGTHS
    from tweezer.values.units import PositiveLength

    names = {_folded(name): laser for name, laser in LASERS.items()}
    known = names.get(_folded(text)) or names.get(f"{_folded(text)}nm")
    found = known.wavelength if known else quantity_in("--laser", text, PositiveLength)
    try:
        material.refractive_index(found)
    except ValueError as error:
        raise SceneError(f"--laser {text!r}: {error}") from None
    low, high = WAVELENGTHS
    if not low <= found <= high:
        ends = " to ".join(in_unit(end, "um", 6) for end in WAVELENGTHS)
        raise SceneError(f"--laser {text!r}: the index of water is known from {ends} um")
    return found


def _power(text: str) -> float:
    """Return a power above 0, W, from text."""
    from tweezer.values.units import Power

    found = quantity_in("--power", text, Power)
    if not found:
        raise SceneError(f"--power {text!r}: must be greater than 0")
    return found


def _depth(text: str, objective: Objective, diameter: float) -> float | None:
    """Return the depth of the focus behind the cover glass, m, from text; None for "none".

    Raises `SceneError` if the bead would touch the glass, and for "none" with oil immersion.
    """
    from tweezer.values.units import PositiveLength

    if _folded(text) == "none":
        if objective.immersion == "oil":
            raise SceneError(
                f"--depth {text!r}: must be a length for {objective.name}, whose image depends "
                "on it"
            )
        return None
    depth = quantity_in("--depth", text, PositiveLength)
    if depth <= 1.2 * diameter:  # the release position needs this distance
        raise SceneError(
            f"--depth {text!r}: must be more than {_usual(1.2 * diameter, 'm')}, for a bead of "
            f"{_usual(diameter, 'm')} before the focus"
        )
    return depth


def _numbered(
    headings: Iterable[str], rows: Mapping[str, Iterable[str]]
) -> tuple[Table, list[str]]:
    """Return a numbered table of choices, and their names in order."""
    table = table_of("", *headings)
    for number, (name, cells) in enumerate(rows.items(), 1):
        table.add_row(f"{number}", name, *cells)
    return table, list(rows)


def _of_materials() -> tuple[Table, list[str]]:
    """Return the table of materials and their names in order."""
    rows = {
        each.name: (_index(each.refractive_index(1.064e-6)), each.cited)
        for each in materials().values()
    }
    return _numbered(("material", "index at 1064 nm", "source"), rows)


def _of_objectives() -> tuple[Table, list[str]]:
    """Return the table of objectives and their names in order."""
    rows = {
        each.name: (_millimetres(each.pupil_radius), each.example) for each in OBJECTIVES.values()
    }
    return _numbered(("objective", "pupil radius", "for example"), rows)


def _of_lasers() -> tuple[Table, list[str]]:
    """Return the table of lasers and their names in order."""
    return _numbered(("laser", "kind"), {each.name: (each.kind,) for each in LASERS.values()})


def _index(index: complex) -> str:
    """Return a refractive index as text, complex only for a material that absorbs."""
    return f"{index.real:.4g}" if index.imag == 0 else f"{index.real:.3g}+{index.imag:.3g}j"


def _in_toml(index: complex) -> str:
    """Return a refractive index as a TOML value; a complex one becomes a string."""
    return _index(index) if index.imag == 0 else f'"{_index(index)}"'


def _usual(value: float, unit: str) -> str:
    """Return a length or power in SI units as text in its usual unit."""
    size, name = usual_unit(value, unit)
    return f"{value / size:.6g} {name}"


def _millimetres(metres: float) -> str:
    """Return a length, m, as text in mm."""
    return printed(metres, "mm", 3)


def scene_text(of: _Experiment) -> str:
    """Return the text of the scene file of an experiment, with a comment on each key."""
    lens, size, light = of.objective, _usual(of.diameter, "m"), printed(of.wavelength, "nm", 6)
    index, pupil = of.material.refractive_index(of.wavelength), _millimetres(lens.pupil_radius)
    tube = f"{printed(lens.tube_lens, 'mm', 6)}/{lens.magnification:g}"
    scale = min(max(of.diameter / 2, 0.25e-6), 1e-5)
    start = (
        ", ".join(f'"{_usual(part * scale, "m")}"' for part in (0.6, 0.4)),
        _usual(-0.6 * scale, "m"),
    )
    duration = per("ms") * min(_time_to_settle(of), 10.0)
    digits = 10.0 ** (math.floor(math.log10(duration)) - 1)
    made_of = f"{of.material.cited}), {of.material.density:g} kg/m^3"
    own = f'refractive_index = {_in_toml(index)} and density = "{of.material.density:g} kg/m^3"'
    bead, power = f"{size} {of.material.name} bead", _usual(of.power, "W")
    free_path = ""
    if of.diameter < _SMALL:
        free_path = (
            'mean_free_path = "0.03 nm" # of hard spheres at the density of water: Stokes\' drag '
            "holds\n"
        )
    return f"""# Written by `tweezer new`. Quantities have units; numbers without one are SI.
description = "{bead} in water, {light}, {power} through {lens.name}"

[bead]
material = "{of.material.name}" # index {_index(index)} at {light} ({made_of}
# in its place your own numbers: {own}
diameter = "{size}"

[medium]
name = "water" # index, density and viscosity at the temperature (IAPWS)
temperature = "20 degC"
{free_path}
[lens]
map = "sine" # Abbe's sine condition
numerical_aperture = {lens.numerical_aperture:g} # {lens.name}, such as {lens.example}
radius = "{pupil}" # of the pupil: f NA with f = {tube}, by the maker's tube lens
{_behind_glass(of)}
[beam]
wavelength = "{light}" # in vacuum
power_through_pupil = "{power}" # behind the objective
waist = "{pupil}" # 1/e^2 radius in the pupil, here as large as the pupil; larger overfills it
polarisation = "linear" # along x; or circular, radial, ...

[start]
position = [{start[0]}, "{start[1]}"] # of the bead's centre from the focus; z along the light

[simulation]
duration = "{round(duration / digits) * digits:g} ms"
"""


def _time_to_settle(of: _Experiment) -> float:
    """Return a rough upper estimate of the time in which a trapped bead comes to rest, s.

    For a small bead it is seven relaxation times along the light, the drag over the stiffness. In a
    Gaussian focus the gradient force of the Rayleigh regime (Harada and Asakura, Opt. Commun. 124,
    529, 1996) has the stiffness 8 n P a^3 K/(c w^2 z_R^2). Here n is the index of water, P the
    power, a the radius of the bead, K its Clausius-Mossotti factor, c the speed of light, w the
    waist and z_R = pi n w^2/lambda. A large bead's stiffness decreases as 1/a. Behind a cover glass
    the trap is about a quarter of the depth before the nominal focus, in weaker light. The factors
    are from simulated runs.
    """
    n, a, power = _WATER, of.diameter / 2, of.power
    permittivity = (of.material.refractive_index(of.wavelength) / n) ** 2
    polarisability = abs(((permittivity - 1) / (permittivity + 2)).real)
    waist = of.wavelength / (2 * min(of.objective.numerical_aperture, n))
    rayleigh_range = math.pi * n * waist**2 / of.wavelength
    stiffness = 8 * n * power * a**3 * polarisability / (_C * (waist * rayleigh_range) ** 2)
    small = 7 * 6 * math.pi * _VISCOSITY * a / stiffness
    large = 2e-3 * (of.diameter / factor("um")) ** 2 * (0.05 / power)
    shift = 0.28 * of.depth if of.depth and of.objective.immersion == "oil" else 0.0
    return (small + large) * (1 + shift**2 / (waist**2 + a**2))


def _behind_glass(of: _Experiment) -> str:
    """Return the part of a scene file on the cover glass, or "" if the glass is far away.

    The glass is a wall, and for oil immersion also an interface that the light crosses.
    """
    if of.depth is None:
        return ""
    depth = _usual(of.depth, "m")
    if of.objective.immersion != "oil":
        return f"""
[wall] # the cover glass: friction is larger beside it
position = "-{depth}" # z of the glass, from the focus
"""
    return f"""
[lens.cover] # light comes through oil and glass into water
refractive_index = {GLASS} # of immersion oil and cover glass
depth = "{depth}" # from the glass to the focus that the light would have without water

[wall] # is the face of that glass: friction is larger beside it
"""
