"""Every bad scene and every bad argument is one line that says what is allowed.

Exit code 2, one line on stderr naming the key, the value and what is allowed, no traceback, and
nothing written.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tweezer
from tweezer import cli
from tweezer.scene import Scene, load_scene, with_settings
from tweezer.values.errors import PhysicsWarning, SceneError, UnitWarning

#: a good scene, value by value as TOML text
GOOD = {
    "bead.radius": '"0.5 um"',
    "bead.density": "1050",
    "bead.refractive_index": "1.57",
    "medium.refractive_index": "1.33",
    "medium.density": "998.2",
    "medium.viscosity": '"1 mPa s"',
    "medium.temperature": '"20 degC"',
    "lens.map": '"tan"',
    "lens.radius": '"2.6 mm"',
    "lens.focal_length": '"2 mm"',
    "beam.wavelength": '"800 nm"',
    "beam.power": '"156 mW"',
    "beam.sigma": '"1 mm"',
    "start.position": "[0, 1e-6, -2e-6]",
    "simulation.duration": '"1 ms"',
}
ABSENT = None
#: parts of scenes that are good together
TABLE = {
    "beam.sigma": ABSENT,
    "beam.profile": '"table"',
    "beam.profile_radius": '[0, "1 mm", "2 mm", "3 mm"]',
    "beam.profile_intensity": "[1, 0.8, 0.3, 0]",
}
LINEAR = {"beam.polarisation": '"linear"'}
GRID = {"optics.evaluator": '"grid"'}
RAYS = {"optics.theory": '"rays"'}
WAVES = {"optics.theory": '"waves"'}
COVER = {
    "lens.map": '"sine"',
    "lens.numerical_aperture": "1.2",
    "lens.focal_length": ABSENT,
    "lens.cover": '{ refractive_index = 1.52, depth = "5 um" }',
}
LAYERS = {
    "bead.radius": ABSENT,
    "bead.refractive_index": ABSENT,
    "bead.layers": '[{ radius = "0.3 um", refractive_index = 2.3 }, '
    '{ diameter = "1 um", refractive_index = "1.5+0.01j" }]',
}
LENGTH = 'must be a number in m, or text with a unit such as "500 nm"'
RADIUS_RANGE = "must be from 1e-09 to 0.001 m"
NAME_RULE = "must begin with a letter or digit, and have no /, \\ and at most 100 characters"
MODELS = "allowed: 'full', 'scaled', 'overdamped' or 'first-order'"

#: id: (what differs from the good scene, the line it is answered with)
BAD_SCENES = {
    # numbers
    "negative": ({"bead.radius": "-1e-6"}, f"bead.radius = -1e-06: {RADIUS_RANGE}"),
    "zero": ({"bead.radius": "0"}, f"bead.radius = 0: {RADIUS_RANGE}"),
    "nan": ({"bead.radius": "nan"}, "bead.radius = nan: must be finite"),
    "infinite": ({"bead.density": "inf"}, "bead.density = inf: must be finite"),
    "minus infinity": ({"start.position": "[0, 0, -inf]"},
                       "start.position.2 = -inf: must be finite"),
    "overflows": ({"bead.radius": "1e400"}, "bead.radius = inf: must be finite"),
    "overflows by its unit": ({"bead.radius": '"1e307 km"'},
                              "bead.radius = '1e307 km': must be finite"),
    "overflows as a whole number": ({"bead.density": "1" + 400 * "0"}, ": must be finite"),
    "huge": ({"bead.radius": "1e308"}, f"bead.radius = 1e+308: {RADIUS_RANGE}"),
    "denormal": ({"bead.radius": "1e-320"}, f"bead.radius = 1e-320: {RADIUS_RANGE}"),
    "micrometres given as metres": ({"bead.radius": "0.5"}, f"bead.radius = 0.5: {RADIUS_RANGE}"),
    "celsius given as kelvin": ({"medium.temperature": "20"},
                                "medium.temperature = 20: must be from 50 to 5000 K"),
    "below absolute zero": ({"medium.temperature": '"-300 degC"'},
                            "medium.temperature = '-300 degC': must be from 50 to 5000 K"),
    "negative power": ({"beam.power": '"-1 mW"'},
                       "beam.power = '-1 mW': must be from 0 to 1e+06 W"),
    "no viscosity": ({"medium.viscosity": "0"},
                     "medium.viscosity = 0: must be from 1e-12 to 1e+09 Pa s"),
    "index below 1": ({"bead.refractive_index": "0.99"},
                      "bead.refractive_index = 0.99: must be from 1 to 10"),
    "no aperture": ({"lens.numerical_aperture": "0"},
                    "lens.numerical_aperture = 0: must be from 0.001 to 10"),
    "no duration": ({"simulation.duration": "0"},
                    "simulation.duration = 0: must be from 1e-15 to 1e+06 s"),
    "scaling factor above 1": ({"simulation.scaling_factor": "1.01"},
                               "simulation.scaling_factor = 1.01: must be from 1e-12 to 1"),
    "too tight a tolerance": ({"simulation.relative_tolerance": "1e-14"},
                              "simulation.relative_tolerance = 1e-14: must be from 1e-13 to 0.1"),
    "too loose a tolerance": ({"simulation.orientation_tolerance": "2"},
                              "simulation.orientation_tolerance = 2: must be from 1e-16 to 1"),
    "no position tolerance": ({"simulation.position_tolerance": "0"},
                              "simulation.position_tolerance = 0: must be from 1e-18 to 1 m"),
    "fractional divisions": ({"beam.divisions": "10.5"},
                             "beam.divisions = 10.5: must be a whole number"),
    "divisions as a float": ({"beam.divisions": "10.0"},
                             "beam.divisions = 10.0: must be a whole number"),
    "too few divisions": ({"beam.divisions": "2"}, "beam.divisions = 2: must be at least 3"),
    "too many divisions": ({"beam.divisions": "5001"},
                           "beam.divisions = 5001: must be at most 5000"),
    "one sample": ({"simulation.samples": "1"}, "simulation.samples = 1: must be at least 2"),
    "too many samples": ({"simulation.samples": "10000001"},
                         "simulation.samples = 10000001: must be at most 1e+07"),
    "infinite samples": ({"simulation.samples": "inf"},
                         "simulation.samples = inf: must be a whole number"),
    # units
    "wrong unit": ({"bead.radius": '"1 kg"'},
                   "bead.radius = '1 kg': has the wrong unit; must be convertible to m"),
    "unknown unit": ({"bead.radius": '"1 wibble"'},
                     "bead.radius = '1 wibble': has an unknown unit; must be convertible"),
    "no unit": ({"bead.radius": '"0.5"'},
                "bead.radius = '0.5': has no unit; write a bare number in m, or \"500 nm\""),
    "unit of a pure number": ({"medium.refractive_index": '"1.5 m"'},
                              "medium.refractive_index = '1.5 m': must be a number"),
    "text for a pure number": ({"medium.refractive_index": '"1.5"'},
                               "medium.refractive_index = '1.5': must be a number"),
    "unit without a number": ({"bead.radius": '"um"'}, f"bead.radius = 'um': {LENGTH}"),
    "unit of an image": ({"bead.radius": '"1 px"'},
                         "bead.radius = '1 px': has an unknown unit; must be convertible"),
    "unit in other capitals": ({"beam.power": '"80mw"'},
                               "must be convertible to W; did you mean mW?"),
    "unit that divides by zero": ({"bead.radius": '"1 m/0"'},
                                  "bead.radius = '1 m/0': has an unknown unit"),
    "unit that calculates": ({"bead.radius": '"1 9**9**9**9 um"'},
                             "bead.radius = '1 9**9**9**9 um': has an unknown unit"),
    "unit with an open bracket": ({"bead.radius": '"1 ("'},
                                  "bead.radius = '1 (': has an unknown unit"),
    "unit with a comment": ({"bead.radius": '"1 um # wide"'},
                            "bead.radius = '1 um # wide': has an unknown unit"),
    "unit without end": ({"bead.radius": f'"1 {2000 * "m*"}m"'}, "has an unknown unit"),
    "difference of temperatures": ({"medium.temperature": '"200 delta_degC"'},
                                   "medium.temperature = '200 delta_degC': has an unknown unit"),
    "digits that are not ASCII": ({"bead.radius": '"٣ um"'}, f"bead.radius = '٣ um': {LENGTH}"),
    # types
    "boolean for a number": ({"bead.radius": "true"}, f"bead.radius = True: {LENGTH}"),
    "boolean for a whole number": ({"beam.divisions": "true"},
                                   "beam.divisions = True: must be a whole number"),
    "text for a number": ({"bead.radius": '"small"'}, f"bead.radius = 'small': {LENGTH}"),
    "empty text for a number": ({"bead.radius": '""'}, f"bead.radius = '': {LENGTH}"),
    "list for a number": ({"bead.radius": "[1e-6]"}, f"bead.radius = [1e-06]: {LENGTH}"),
    "table for a number": ({"bead.radius": "{ um = 1 }"}, f"bead.radius = {{'um': 1}}: {LENGTH}"),
    "date for a number": ({"bead.radius": "2024-01-01"}, f"(2024, 1, 1): {LENGTH}"),
    "time for a duration": ({"simulation.duration": "00:00:01"},
                            'must be a number in s, or text with a unit such as "20 ms"'),
    "number for a boolean": (
        {"forces.gravity": "1"}, "forces.gravity = 1: must be true or false; did you mean true?"
    ),
    "text for a boolean": ({"forces.optical": '"no"'},
                           "forces.optical = 'no': must be true or false; did you mean false?"),
    "number for a name": ({"name": "7"}, "name = 7: must be text"),
    "list for a description": ({"description": '["a"]'}, "description = ['a']: must be text"),
    "number for a vector": ({"start.position": "0"}, "start.position = 0: must be a list"),
    "text for a vector": ({"start.position": '"0 0 0"'},
                          "start.position = '0 0 0': must be a list"),
    "short vector": ({"start.position": "[0]"}, "start.position = [0]: must have 3 entries"),
    "long vector": ({"start.velocity": "[0, 0, 0, 0]"},
                    "start.velocity = [0, 0, 0, 0]: must have 3 entries"),
    "two Euler parameters": ({"start.orientation": "[1, 0]"},
                             "start.orientation = [1, 0]: must have 4 entries"),
    "an axis of no length": ({"start.orientation": "[0, 0, 0]"},
                             "start.orientation = [0, 0, 0]: an axis must have a finite length "
                             "above 0"),
    "list in a vector": ({"start.position": "[0, [1e-6], 0]"},
                         f"start.position.1 = [1e-06]: {LENGTH}"),
    "section that is a number": ({"forces": "3"}, "forces = 3: must be a section [forces]"),
    # choices
    "unknown model": ({"simulation.model": '"inertial"'},
                      f"simulation.model = 'inertial': {MODELS}"),
    "unknown method": ({"simulation.method": '"rk45"'},
                       "simulation.method = 'rk45': allowed: 'auto', 'dormand-prince', "),
    "unknown map": ({"lens.map": '"sin"'}, "lens.map = 'sin': allowed: 'tan' or 'sine'"),
    "unknown polarisation": ({"beam.polarisation": '"x"'},
                             "beam.polarisation = 'x': allowed: 'averaged-reflectance', "),
    "unknown torque": ({"beam.torque": "true"}, "beam.torque = True: allowed: 'none' or 'thesis'"),
    "unknown frame": ({"start.frame": '"trap"'},
                      "start.frame = 'trap': allowed: 'focus' or 'lens'"),
    "unknown rotation state": ({"simulation.rotation_state": '"euler"'},
                               "allowed: 'angular-velocity' or 'euler-rates'"),
    # keys
    "missing key": ({"bead.density": ABSENT}, "bead.density: missing"),
    "missing section": ({"start.position": ABSENT}, "start: missing"),
    "unknown key, nearly right": ({"bead.densty": "1"},
                                  "bead.densty = 1: unknown key; did you mean density?"),
    "unknown alternative, nearly right": ({"beam.waste": "1"}, "did you mean waist?"),
    "unknown key": ({"forces.drag": "true"},
                    "forces.drag = True: unknown key; allowed: optical, gravity, buoyancy, "),
    "unknown section, nearly right": ({"beem.power": "1"},
                                      "beem = {'power': 1}: unknown key; did you mean beam?"),
    "unknown section": ({"shutter.pixels": "1"},
                        "shutter = {'pixels': 1}: unknown key; allowed: name, description, bead"),
    "tables without end": ({f"x.{5_000 * 'a.'}b": "1"},
                           "x = a dict too deep to show: unknown key; "),
    "key with a line break": ({'bead."a\\nb"': "1"}, "bead.a b = 1: unknown key"),
    "radius and diameter": ({"bead.diameter": "1e-6"}, "bead.radius or diameter: give only one"),
    "neither radius nor diameter": ({"bead.radius": ABSENT},
                                    "bead.radius or diameter: one is required"),
    "bad diameter": ({"bead.radius": ABSENT, "bead.diameter": '"3 mm"'},
                     "bead.diameter = '3 mm': must be from 2e-09 to 0.002 m"),
    "sigma and waist": ({"beam.waist": "1e-3"}, "beam.sigma or waist: give only one"),
    "neither sigma nor waist": ({"beam.sigma": ABSENT}, "beam.sigma or waist: one is required"),
    "bad waist": ({"beam.sigma": ABSENT, "beam.waist": "true"}, f"beam.waist = True: {LENGTH}"),
    "both powers": ({"beam.power_through_pupil": "0.1"},
                    "beam.power or power_through_pupil: give only one"),
    "no power": ({"beam.power": ABSENT}, "beam.power or power_through_pupil: one is required"),
    # what does not fit together
    "tan map without focal length": ({"lens.focal_length": ABSENT},
                                     "lens.focal_length: missing; the tan map requires it"),
    "sine map without aperture": ({"lens.map": '"sine"'},
                                  "lens.numerical_aperture: missing; the sine map requires it"),
    "sine map with more aperture than the medium": (
        {"lens.map": '"sine"', "lens.numerical_aperture": "1.33"},
        "lens.numerical_aperture = 1.33: must be less than medium.refractive_index = 1.33",
    ),
    "lens frame without focal length": (
        {"lens.map": '"sine"', "lens.numerical_aperture": "1.2", "lens.focal_length": ABSENT,
         "start.frame": '"lens"'},
        "start.frame = 'lens': requires lens.focal_length",
    ),
    "start behind the lens": ({"start.frame": '"lens"', "start.position": "[0, 0, -1e-6]"},
                              "[0.0, 0.0, -1e-06]: the bead must start beyond the lens"),
    "start beyond the loss distance": (
        {"simulation.loss_distance": '"2 um"'},
        "from the focus; must be nearer than simulation.loss_distance = 2e-06 m",
    ),
    "start from the lens, taken from the focus": ({"start.position": "[0, 0, 1.998e-3]"},
                                                  "is 0.002 m from the focus; must be nearer"),
    "beam narrower than the grid": ({"beam.sigma": '"10 um"', **GRID},
                                    "beam.sigma = 1e-05: must be at least 2.6e-05 m"),
    "donut narrower than the grid": (
        {"beam.sigma": '"10 um"', "beam.profile": '"donut"', **GRID},
        "beam.sigma = 1e-05: must be at least 2.6e-05 m",
    ),
    "table narrower than the grid": (
        {**TABLE, "beam.profile_radius": "[0, 1e-5, 2e-5, 5e-5]", **GRID},
        "beam.profile_radius ends at 5e-05: must reach 5.2e-05 m, the side of a square",
    ),
    "scaled model without a factor": ({"simulation.model": '"scaled"'},
                                      "simulation.scaling_factor: missing; the scaled model"),
    "no orientation": ({"start.orientation": "[0, 0, 0, 0]"},
                       "start.orientation = [0.0, 0.0, 0.0, 0.0]: the Euler parameters must not"),
    "orientation that overflows": ({"start.orientation": "[1e200, 0, 0, 0]"},
                                   "start.orientation.0 = 1e+200: must be from -1e+100 to 1e+100"),
    "impossible moments of inertia": (
        {"bead.moments_of_inertia": "[1e-28, 1e-28, 2.1e-28]"},
        "no body has a moment larger than the sum of the other two",
    ),
    "thermal motion by a method without": (
        {"forces.brownian": "true", "simulation.method": '"dop853"'},
        "simulation.method = 'dop853': does not compute thermal motion; allowed: auto, heun",
    ),
    "a stochastic method without thermal motion": (
        {"simulation.method": '"heun"'}, "simulation.method = 'heun': requires forces.brownian"),
    "thermal torque alone": ({"forces.brownian_torque": "true"},
                             "forces.brownian_torque = True: requires forces.brownian = true"),
    "start drawn without thermal motion": (
        {"start.drawn": '"boltzmann"'}, "start.drawn = 'boltzmann': requires forces.brownian"),
    "ball without a radius": ({"start.drawn": '"ball"', "forces.brownian": "true"},
                              "start.ball_radius: must be given if drawn = 'ball', and only then"),
    "ball that reaches beyond the loss": (
        {"start.drawn": '"ball"', "start.ball_radius": '"50 um"', "forces.brownian": "true"},
        "must be nearer than simulation.loss_distance",
    ),
    "spring that should turn the bead": (
        {"forces.brownian": "true", "simulation.method": '"harmonic"', "beam.torque": '"thesis"'},
        "simulation.method = 'harmonic': a linear spring exerts no torque; allowed: beam.torque",
    ),
    "thermal first order with rotation": (
        {"forces.brownian": "true", "forces.brownian_torque": "true",
         "simulation.model": '"first-order"'},
        "simulation.model = 'first-order': does not include thermal rotation; set",
    ),
    "baoab without inertia": (
        {"forces.brownian": "true", "simulation.model": '"overdamped"',
         "simulation.method": '"baoab"'},
        "simulation.method = 'baoab': cannot integrate simulation.model = 'overdamped'; set ",
    ),
    "thermal rotation of a body": (
        {"forces.brownian": "true", "forces.brownian_torque": "true",
         "bead.moments_of_inertia": "[1e-28, 1e-28, 1e-28]"},
        "bead.moments_of_inertia: thermal rotation with inertia is computed for spheres",
    ),
    # profiles of the beam
    "unknown profile": ({"beam.profile": '"gauss"'},
                        "beam.profile = 'gauss': allowed: 'gaussian', 'uniform', 'donut' or"),
    "unknown profile without a width": ({"beam.profile": '"flat"', "beam.sigma": ABSENT},
                                        "beam.profile = 'flat': allowed: 'gaussian', 'uniform', "),
    "boolean for a profile": ({"beam.profile": "true"}, "beam.profile = True: allowed: 'gaussian'"),
    "uniform with sigma": ({"beam.profile": '"uniform"'},
                           "beam.sigma or waist: does not apply to profile = 'uniform'; remove it"),
    "uniform with waist": (
        {"beam.profile": '"uniform"', "beam.sigma": ABSENT, "beam.waist": "1e-3"},
        "beam.sigma or waist: does not apply to profile = 'uniform'; remove it",
    ),
    "donut without a width": ({"beam.profile": '"donut"', "beam.sigma": ABSENT},
                              "beam.sigma or waist: one is required"),
    "donut with sigma and waist": ({"beam.profile": '"donut"', "beam.waist": "1e-3"},
                                   "beam.sigma or waist: give only one"),
    "table with sigma": ({**TABLE, "beam.sigma": "1e-3"},
                         "beam.sigma or waist: does not apply to profile = 'table'; remove it"),
    "table without radii": ({**TABLE, "beam.profile_radius": ABSENT},
                            "beam.profile_radius: missing; profile = 'table' requires it"),
    "table without intensities": ({**TABLE, "beam.profile_intensity": ABSENT},
                                  "beam.profile_intensity: missing; profile = 'table' requires it"),
    "points of a Gaussian": ({"beam.profile_radius": "[0, 1e-3, 2e-3, 3e-3]"},
                             "beam.profile_radius: does not apply to profile = 'gaussian'; "),
    "intensities of a donut": (
        {"beam.profile": '"donut"', "beam.profile_intensity": "[0, 1, 1, 0]"},
        "beam.profile_intensity: does not apply to profile = 'donut'; remove it",
    ),
    "table of three points": ({**TABLE, "beam.profile_radius": "[0, 1e-3, 2e-3]"},
                              "must have 4 to 10000 entries"),
    "table of no points": ({**TABLE, "beam.profile_intensity": "[]"},
                           "beam.profile_intensity = []: must have 4 to 10000 entries"),
    "table of too many points": ({**TABLE, "beam.profile_intensity": f"[{10_001 * '1,'}]"},
                                 "must have 4 to 10000 entries"),
    "table of unequal lengths": (
        {**TABLE, "beam.profile_intensity": "[1, 1, 1, 1, 1]"},
        "beam.profile_intensity: has 5 entries; must have as many as profile_radius, 4",
    ),
    "number for a table": ({**TABLE, "beam.profile_radius": "1"},
                           "beam.profile_radius = 1: must be a list"),
    "text for a table": ({**TABLE, "beam.profile_intensity": '"1 2 3 4"'},
                         "beam.profile_intensity = '1 2 3 4': must be a list"),
    "table that begins off the axis": ({**TABLE, "beam.profile_radius": "[1e-4, 1e-3, 2e-3, 3e-3]"},
                                       "beam.profile_radius.0 = 0.0001: must be 0"),
    "table that goes back": (
        {**TABLE, "beam.profile_radius": "[0, 2e-3, 1e-3, 3e-3]"},
        "beam.profile_radius.2 = 0.001: must be larger than the previous one, 0.002",
    ),
    "table with a radius twice": ({**TABLE, "beam.profile_radius": "[0, 0, 1e-3, 3e-3]"},
                                  "beam.profile_radius.1 = 0.0: must be larger than the previous"),
    "table with a negative radius": ({**TABLE, "beam.profile_radius": "[-1e-3, 0, 1e-3, 3e-3]"},
                                     "beam.profile_radius.0 = -0.001: must be from 0 to 1 m"),
    "table wider than the world": ({**TABLE, "beam.profile_radius": "[0, 0.1, 2, 1]"},
                                   "beam.profile_radius.2 = 2: must be from 0 to 1 m"),
    "table with a wrong unit": ({**TABLE, "beam.profile_radius": '[0, "1 mW", 2e-3, 3e-3]'},
                                "beam.profile_radius.1 = '1 mW': has the wrong unit; must be"),
    "dark table": ({**TABLE, "beam.profile_intensity": "[0, 0, 0, 0]"},
                   "beam.profile_intensity: must not all be 0"),
    "table with a negative intensity": ({**TABLE, "beam.profile_intensity": "[1, 1, -1, 0]"},
                                        "beam.profile_intensity.2 = -1: must be from 0 to 1e+100"),
    "table with a missing intensity": ({**TABLE, "beam.profile_intensity": "[1, nan, 1, 0]"},
                                       "beam.profile_intensity.1 = nan: must be finite"),
    "intensity with a unit": ({**TABLE, "beam.profile_intensity": '["1 W/m^2", 1, 1, 0]'},
                              "beam.profile_intensity.0 = '1 W/m^2': must be a number"),
    # polarisation
    "Jones vector of circular light": ({"beam.jones": "[1, 0]"},
                                       "beam.jones: does not apply to polarisation = 'circular'"),
    "short Jones vector": ({**LINEAR, "beam.jones": "[1]"},
                           "beam.jones = [1]: must have 2 entries"),
    "long Jones vector": ({**LINEAR, "beam.jones": "[1, 0, 0]"},
                          "beam.jones = [1, 0, 0]: must have 2 entries"),
    "Jones vector of 0": ({**LINEAR, "beam.jones": '[0, "0j"]'}, "must not both be 0"),
    "Jones vector too short for a float": ({**LINEAR, "beam.jones": "[1e-200, 0]"},
                                           "beam.jones = [1e-200, 0]: must not both be 0"),
    "Jones vector that overflows": ({**LINEAR, "beam.jones": "[1e200, 0]"},
                                    "beam.jones.0 = 1e+200: must be from -1e+100 to 1e+100"),
    "text for a Jones vector": ({**LINEAR, "beam.jones": '"x"'},
                                "beam.jones = 'x': must be a list"),
    "boolean for an amplitude": ({**LINEAR, "beam.jones": "[true, 0]"},
                                 "beam.jones.0 = True: must be a number"),
    "text for an amplitude": ({**LINEAR, "beam.jones": '[1, "x"]'},
                              "beam.jones.1 = 'x': must be a complex number such as \"1j\""),
    "amplitude with an i": ({**LINEAR, "beam.jones": '[1, "1i"]'},
                            "beam.jones.1 = '1i': must be a complex number such as \"1j\""),
    "empty amplitude": ({**LINEAR, "beam.jones": '[1, ""]'},
                        "beam.jones.1 = '': must be a complex number"),
    "amplitude that is not a number": ({**LINEAR, "beam.jones": "[nan, 1]"},
                                       "beam.jones.0 = nan: must be finite"),
    "text of no number": ({**LINEAR, "beam.jones": '["nan", 1]'},
                          "beam.jones.0 = 'nan': must be a complex number"),
    "amplitude of three parts": ({**LINEAR, "beam.jones": "[[1, 2, 3], 0]"},
                                 "beam.jones.0 = [1, 2, 3]: must be a number, text such as"),
    # how the force is computed
    "unknown evaluator": ({"optics.evaluator": '"exact"'},
                          "optics.evaluator = 'exact': allowed: 'auto', 'grid', 'quadrature'"),
    "too tight a quadrature": ({"optics.tolerance": "1e-14"},
                               "optics.tolerance = 1e-14: must be from 1e-13 to 0.1"),
    "too loose a quadrature": ({"optics.tolerance": "0.2"},
                               "optics.tolerance = 0.2: must be from 1e-13 to 0.1"),
    "quadrature without tolerance": ({"optics.tolerance": "0"},
                                     "optics.tolerance = 0: must be from 1e-13 to 0.1"),
    "text for a tolerance": ({"optics.tolerance": '"tight"'},
                             "optics.tolerance = 'tight': must be a number"),
    "map of linear light as rays": (
        {**LINEAR, "beam.jones": "[1, 0]", "optics.evaluator": '"map"', **RAYS},
        "optics.evaluator = 'map': rays need light that is the same all around the axis",
    ),
    "too tight a map": ({"optics.table_tolerance": "1e-13"},
                        "optics.table_tolerance = 1e-13: must be from 1e-12 to 0.1"),
    "too small a map": ({"optics.table_range": "0.4"},
                        "optics.table_range = 0.4: must be from 0.5 to 20"),
    "too large a map": ({"optics.table_range": "21"},
                        "optics.table_range = 21: must be from 0.5 to 20"),
    "text without a unit for a range": (
        {"optics.table_range": '"3"'},
        "optics.table_range = '3': has no unit; write a bare number of radii, or a length such as",
    ),
    "time for a range": ({"optics.table_range": '"3 s"'},
                         "optics.table_range = '3 s': has the wrong unit; must be convertible to"),
    "range too long": ({"optics.table_range": '"2 mm"'},
                       "optics.table_range = '2 mm': must be from 1e-08 to 0.001 m"),
    "range of many radii for rays": (
        {"optics.table_range": '"11 um"', **RAYS},
        "optics.table_range = '1.1e-05 m': is 22 radii of the bead; must be from 0.5 to 20 of them",
    ),
    # rays or waves
    "unknown theory": ({"optics.theory": '"mie"'},
                       "optics.theory = 'mie': allowed: 'auto', 'rays' or 'waves'"),
    "averaged reflectance as waves": (
        {"beam.polarisation": '"averaged-reflectance"', **WAVES},
        "optics.theory = 'waves': beam.polarisation = 'averaged-reflectance' requires "
        "ray optics; allowed: 'auto' or 'rays'",
    ),
    "moment of the thesis as waves": ({"beam.torque": '"thesis"', **WAVES},
                                      "beam.torque = 'thesis' requires ray optics"),
    "grid as waves": ({**GRID, **WAVES}, "optics.evaluator = 'grid' requires ray optics"),
    "donut without a phase as waves": (
        {"beam.profile": '"donut"', **WAVES},
        "beam.profile = 'donut' without a vortex, or radial or azimuthal polarisation, requires",
    ),
    "absorbing bead as rays": (
        {"bead.refractive_index": '"1.57+0.01j"', **RAYS},
        "optics.theory = 'rays': bead.refractive_index = 1.57+0.01j requires wave optics; "
        "allowed: 'auto' or 'waves'",
    ),
    "layers as rays": ({**LAYERS, **RAYS}, "bead.layers (2 layers) requires wave optics"),
    "cover as rays": ({**COVER, **RAYS}, "lens.cover requires wave optics"),
    "vortex as rays": ({"beam.vortex": "-2", **RAYS}, "beam.vortex = -2 requires wave optics"),
    "radial light as rays": ({"beam.polarisation": '"radial"', **RAYS},
                             "beam.polarisation = 'radial' requires wave optics"),
    "light that is neither": (
        {"beam.vortex": "1", **GRID},
        "optics.theory = 'auto': optics.evaluator = 'grid' requires ray optics, and "
        "beam.vortex = 1 requires wave optics",
    ),
    "vortex that is no whole number": ({"beam.vortex": "0.5"},
                                       "beam.vortex = 0.5: must be a whole number"),
    "vortex too large": ({"beam.vortex": "-51"}, "beam.vortex = -51: must be at least -50"),
    # absorbing beads and layers
    "gain": ({"bead.refractive_index": '"1.5-0.1j"'},
             "bead.refractive_index = '1.5-0.1j': the imaginary part must be from 0 to 100"),
    "complex index below the range": ({"bead.refractive_index": "[0.001, 5]"},
                                      "bead.refractive_index = [0.001, 5]: must be from 0.01 to"),
    "index of three parts": ({"bead.refractive_index": "[1, 2, 3]"},
                             "must be a number, text such as \"1.59+0.01j\", or [real, imaginary]"),
    "text for an index": ({"bead.refractive_index": '"glass"'},
                          "bead.refractive_index = 'glass': must be a complex number such as"),
    "no index": ({"bead.refractive_index": ABSENT}, "bead.refractive_index: missing"),
    "layers and a radius": ({**LAYERS, "bead.radius": "1e-6"},
                            "bead.radius = 1e-06: cannot be combined with layers, which"),
    "layers and an index": ({**LAYERS, "bead.refractive_index": "1.5"},
                            "bead.refractive_index = 1.5: cannot be combined with layers"),
    "layers inwards": (
        {**LAYERS, "bead.layers": "[{ radius = 5e-7, refractive_index = 2 }, "
                                  "{ diameter = 8e-7, refractive_index = 1.5 }]"},
        "bead.layers.1.radius = 4e-07: must be larger than the previous one, 5e-07",
    ),
    "no layers": ({**LAYERS, "bead.layers": "[]"}, "bead.layers = []: must have 1 to 20 entries"),
    "layer without an index": ({**LAYERS, "bead.layers": "[{ radius = 5e-7 }]"},
                               "bead.layers.0.refractive_index: missing"),
    "layer without a radius": ({**LAYERS, "bead.layers": "[{ refractive_index = 1.5 }]"},
                               "bead.layers.0.radius or diameter: one is required"),
    "unknown key of a layer": (
        {**LAYERS, "bead.layers": "[{ radius = 5e-7, refractive_index = 2, indx = 1 }]"},
        "bead.layers.0.indx = 1: unknown key; allowed: radius, material, refractive_index, ",
    ),
    "number for layers": ({**LAYERS, "bead.layers": "1"}, "bead.layers = 1: must be a list"),
    # a face before the focus
    "more aperture than the cover": (
        {**COVER, "lens.numerical_aperture": "1.52"},
        "lens.numerical_aperture = 1.52: must be less than lens.cover.refractive_index = 1.52",
    ),
    "face beyond the focus": (
        {**COVER, "lens.cover": "{ refractive_index = 1.5, depth = -1e-6 }"},
        "lens.cover.depth = -1e-06: must be from 0 to 0.01 m",
    ),
    "cover that absorbs": (
        {**COVER, "lens.cover": "{ refractive_index = [1.5, 0.1], depth = 1e-6 }"},
        "lens.cover.refractive_index = [1.5, 0.1]: must be a number",
    ),
    "start in the face": (
        {**COVER, "start.position": '[0, 0, "-4.5 um"]'},
        "start.position = [0.0, 0.0, -4.5e-06]: the bead must start beyond the face of lens.cover",
    ),
    "ball that reaches into the face": (
        {**COVER, "forces.brownian": "true", "start.drawn": '"ball"',
         "start.ball_radius": '"3 um"'},
        "the bead must start beyond the face of lens.cover, which is 5e-06 m before the focus",
    ),
    "focus off its depth": ({**COVER, "beam.position": "[0, 0, 1e-6]"},
                            "beam.position = [0.0, 0.0, 1e-06]: must be at z = 0 with lens"),
    "focus that leaves its depth": (
        {**COVER, "beam.motion": '{ kind = "ramp", velocity = [0, 0, 1e-6] }'},
        "beam.motion: must be perpendicular to the light with lens.cover",
    ),
    "spring that light should turn": (
        {"bead.refractive_index": "[1.5, 0.1]", "forces.brownian": "true",
         "simulation.method": '"harmonic"', **WAVES},
        "exerts no torque; allowed: beam.torque = 'none', and a bead that does not absorb",
    ),
    "unknown key of the optics": ({"optics.evalutor": '"grid"'},
                                  "optics.evalutor = 'grid': unknown key; did you mean evaluator?"),
    "section of the optics that is text": ({"optics": '"grid"'},
                                           "optics = 'grid': must be a section [optics]"),
    # names become file names
    "name that leaves the folder": ({"name": '"../bead"'}, f"name = '../bead': {NAME_RULE}"),
    "name with a folder": ({"name": '"a/b"'}, f"name = 'a/b': {NAME_RULE}"),
    "hidden name": ({"name": '".."'}, f"name = '..': {NAME_RULE}"),
    "empty name": ({"name": '""'}, f"name = '': {NAME_RULE}"),
    "name with a line break": ({"name": '"a\\nb"'}, f"name = 'a\\nb': {NAME_RULE}"),
    "name with a null": ({"name": '"a\\u0000"'}, f"name = 'a\\x00': {NAME_RULE}"),
    "name too long for a file": ({"name": f'"{101 * "n"}"'}, NAME_RULE),
}  # fmt: skip

#: id: (content of the file, the line it is answered with)
BAD_FILES = {
    "not UTF-8": (b"name = '\xff'", "'scene.toml': not a text file in UTF-8"),
    "an empty file": (b"# nothing\n", "'scene.toml': is empty; `tweezer new` writes a scene"),
    "not TOML": (b"radius: 3", "'scene.toml': not valid TOML: "),
    "the same key twice": (b"name = 'a'\nname = 'b'", "'scene.toml': not valid TOML: "),
    "brackets without end": (b"a = " + 20_000 * b"[", "'scene.toml': not valid TOML: "),
    "digits without end": (b"a = " + 5_000 * b"1", "'scene.toml': not valid TOML: "),
    "impossible date": (b"a = 2024-02-31", "'scene.toml': not valid TOML: "),
}

#: id: (arguments after `run`, the line they are answered with)
BAD_ARGUMENTS = {
    "no such scene": (["thesis-1nm"], "no scene file 'thesis-1nm', and no shipped scene of that"),
    "no scene": ([""], "no scene given; must be a shipped scene or a TOML file"),
    "half a name": (["silica"], "no scene file 'silica', and no shipped scene of that name; did "
                    "you mean silica-1um?"),
    "shipped name with a suffix": (["silica-1um.toml"], "did you mean silica-1um?"),
    "part of a name": (["990nm"], "did you mean thesis-990nm?"),
    "a folder for a scene": (["folder.nc"], "'folder.nc': cannot be read: Is a directory"),
    "scene name too long": ([5000 * "s"], "cannot be read: File name too long"),
    "scene name with a line break": (["a\nb"], "no scene file 'a\\nb'"),
    "--set without =": (["silica-1um", "--set", "beam.power"],
                        "--set 'beam.power': must be key=value, such as beam.power=80 mW"),
    "--set without a section": (["silica-1um", "--set", "power=1"],
                                "'power': must be section.key; did you mean beam.power?"),
    "--set without a key": (["silica-1um", "--set", "=1"], "'': must be section.key, such as"),
    "--set of an unknown key": (["silica-1um", "--set", "beam.pwer=1"],
                                "beam.pwer = 1: unknown key; did you mean power?"),
    "--set of an unknown section": (["silica-1um", "--set", "bem.power=1"],
                                    "bem = {'power': 1}: unknown key; did you mean beam?"),
    "--set below a key": (["silica-1um", "--set", "bead.radius.x=1"],
                          "bead.radius.x = 1: unknown key; did you mean radius?"),
    "--set within text": (["silica-1um", "--set", "name.x=1"], "name = {'x': 1}: must be text"),
    "--set of two alternatives": (
        ["silica-1um", "--set", "beam.sigma=1e-3", "--set", "beam.waist=2e-3"],
        "beam.sigma or waist: give only one",
    ),
    "--set of a line break": (["silica-1um", "--set", "bead.a\nb=1"], "bead.a b = 1: unknown key"),
    "--set of digits without end": (["silica-1um", "--set", f"bead.radius={5000 * '1'}"],
                                    "has no unit; write a bare number in m"),
    "--set of brackets without end": (["silica-1um", "--set", f"bead.radius={20_000 * '['}"],
                                      LENGTH),
    "--duration that is no time": (["silica-1um", "--duration", "long"],
                                   "simulation.duration = 'long': must be a number in s, or text"),
    "--duration without a unit": (["silica-1um", "--duration", '"5"'],
                                  "simulation.duration = '5': has no unit"),
    "negative --duration": (["silica-1um", "--duration", "-1 ms"],
                            "simulation.duration = '-1 ms': must be from 1e-15 to 1e+06 s"),
    "empty --duration": (["silica-1um", "--duration", ""], "simulation.duration = '': must be"),
    "unknown --model": (["silica-1um", "--model", "half"], f"simulation.model = 'half': {MODELS}"),
    "unknown --method": (["silica-1um", "--method", "Euler"],
                         "simulation.method = 'Euler': allowed: 'auto', "),
    "scaled --model without a factor": (["silica-1um", "--model", "scaled"],
                                        "simulation.scaling_factor: missing"),
    "--out into a missing folder": (["silica-1um", "--out", "none/run.nc"],
                                    "none/run.nc: no such folder: none"),
    "--out with another suffix": (["silica-1um", "--out", "run.h5"], "run.h5: must end in .nc"),
    "--out of nothing but a suffix": (["silica-1um", "--out", ".nc"], ".nc: must end in .nc"),
    "empty --out": (["silica-1um", "--out", ""], ".: must end in .nc"),
    "--out that is a folder": (["silica-1um", "--out", "folder.nc"], "folder.nc: is a folder"),
    "--out inside a file": (["silica-1um", "--out", "scene.toml/run.nc"],
                            "scene.toml/run.nc: no such folder: scene.toml"),
    "--out too long": (["silica-1um", "--out", f"{300 * 'o'}.nc"],
                       "cannot be written: File name too long"),
    "--plot into a missing folder": (["silica-1um", "--plot", "none/run.png"],
                                     "none/run.png: no such folder: none"),
    "--plot with another suffix": (["silica-1um", "--plot", "run.jpg"],
                                   "run.jpg: must end in .pdf, .png, .svg"),
}  # fmt: skip

#: id: (arguments, the last line they are answered with, after the usage)
BAD_USAGE = {
    "no such command": (["fly"], "No such command 'fly'."),
    "no such option": (["run", "silica-1um", "--colour"], "No such option: --colour"),
    "option without value": (["run", "silica-1um", "--out"], "requires an argument"),
    "trap without a scene": (["trap"], "Missing argument"),
    "two scenes": (["run", "silica-1um", "thesis-990nm"], "unexpected extra argument"),
}


def as_toml(changes: dict[str, str | None]) -> str:
    """Write the good scene with `changes` as TOML."""
    values = {key: text for key, text in {**GOOD, **changes}.items() if text is not ABSENT}
    return "\n".join(
        f"{key} = {text}" for key, text in sorted(values.items(), key=lambda item: "." in item[0])
    )


@pytest.fixture(autouse=True)
def never_simulated(monkeypatch):
    def accepted(scene: Scene) -> None:
        pytest.fail(f"accepted: {scene!r}")

    monkeypatch.setattr(cli.runs, "followed_with_progress", accepted)


def assert_refused(command_line, arguments: list[str], expected: str) -> None:
    before = files_here()
    outcome = command_line(*arguments)
    assert outcome.code == 2
    (line,) = outcome.err.splitlines()
    assert expected in line
    assert not outcome.out
    assert files_here() == before


def files_here() -> dict[Path, int]:
    return {path: path.stat().st_mtime_ns for path in Path().rglob("*")}


@pytest.mark.parametrize(
    "changes", [{}, TABLE, LINEAR, GRID, COVER, {"beam.vortex": "-50"}, LAYERS],
    ids=["as it is", "table", "linear", "grid", "cover", "vortex", "layers"],
)  # fmt: skip
def test_the_good_scenes_are_good(tmp_path, changes):
    path = tmp_path / "good.toml"
    path.write_text(as_toml(changes))
    assert load_scene(path).bead.radius == 0.5e-6


@pytest.mark.parametrize(("changes", "expected"), BAD_SCENES.values(), ids=BAD_SCENES.keys())
def test_bad_scene(command_line, changes, expected):
    Path("scene.toml").write_text(as_toml(changes), encoding="utf-8")
    assert_refused(command_line, ["run", "scene.toml"], expected)


@pytest.mark.parametrize(("content", "expected"), BAD_FILES.values(), ids=BAD_FILES.keys())
def test_bad_file(command_line, content, expected):
    Path("scene.toml").write_bytes(content)
    assert_refused(command_line, ["run", "scene.toml"], expected)


@pytest.mark.parametrize(
    ("arguments", "expected"), BAD_ARGUMENTS.values(), ids=BAD_ARGUMENTS.keys()
)
def test_bad_argument(command_line, arguments, expected):
    Path("scene.toml").write_text(as_toml({}))
    Path("folder.nc").mkdir()
    assert_refused(command_line, ["run", *arguments], expected)


def test_out_into_a_folder_of_others(command_line, monkeypatch):
    monkeypatch.setattr(os, "access", lambda path, mode: (str(path), mode) != ("theirs", os.W_OK))
    Path("theirs").mkdir()
    expected = "theirs/run.nc: cannot be written: no permission to write in theirs"
    assert_refused(command_line, ["run", "silica-1um", "--out", "theirs/run.nc"], expected)


@pytest.mark.parametrize(("arguments", "expected"), BAD_USAGE.values(), ids=BAD_USAGE.keys())
def test_bad_usage_says_how_to_use_it(command_line, arguments, expected):
    outcome = command_line(*arguments)
    assert outcome.code == 2
    assert expected in outcome.err.splitlines()[-1]
    assert not outcome.out
    assert not files_here()


def test_several_bad_values_are_one_line_each(command_line):
    Path("scene.toml").write_text(as_toml({"bead.radius": "0", "beam.divisions": "1.5"}))
    outcome = command_line("run", "scene.toml")
    assert outcome.code == 2
    assert outcome.err.splitlines() == [
        f"bead.radius = 0: {RADIUS_RANGE}",
        "beam.divisions = 1.5: must be a whole number",
    ]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--set", "bead.radius=-1"], "bead.radius = -1"),
        (["--out", b"\xff/run.nc"], "no such folder"),
        (["--set", b"bead.\xff=1"], "bead = '\\udcff'"),
    ],
    ids=["value", "path not in UTF-8", "key not in UTF-8"],
)
def test_bad_argument_in_a_process_of_its_own(tmp_path, arguments, expected):
    done = subprocess.run(
        [sys.executable, "-c", "from tweezer.cli import main; main()", "run", "silica-1um",
         *arguments],
        cwd=tmp_path, capture_output=True, check=False,
    )  # fmt: skip
    assert done.returncode == 2
    (line,) = done.stderr.decode().splitlines()
    assert expected in line
    assert not done.stdout
    assert not list(tmp_path.iterdir())


KEYS = sorted(
    f"{section}.{key}"
    for section, field in Scene.model_fields.items()
    for key in getattr(field.annotation, "model_fields", ())
)
SCALARS = st.one_of(
    st.integers().map(str),
    st.floats().map(str),
    st.sampled_from(["true", '""', '"1 um"', '"5 kg"', "2024-01-01", "[]", "{ a = 1 }"]),
)
LISTS = st.lists(SCALARS, max_size=4).map(lambda items: f"[{', '.join(items)}]")
NUMBERS_WITH_ANYTHING = st.builds("{} {}".format, st.floats(), st.text(max_size=8))


@pytest.fixture(scope="module")
def good_scene() -> Scene:
    return load_scene("thesis-990nm")


@settings(deadline=None)
@given(key=st.sampled_from(KEYS), text=st.one_of(SCALARS, LISTS, NUMBERS_WITH_ANYTHING, st.text()))
def test_any_value_of_any_key_is_a_scene_or_a_scene_error(good_scene, key, text):
    try:
        changed = with_settings(good_scene, {key: text})
    except (PhysicsWarning, UnitWarning):
        return
    except SceneError as error:
        changed, lines = None, str(error).splitlines()
    assert isinstance(changed, Scene) or 1 <= len(lines) <= 4


@pytest.mark.parametrize(
    "call",
    [
        tweezer.simulate, tweezer.characterise, tweezer.tune, tweezer.bind, tweezer.chosen,
        tweezer.bead_properties, lambda scene: tweezer.ensemble(scene, 3),
        lambda scene: tweezer.ensemble(scene, 3, duration="1 ms"),
        lambda scene: tweezer.optical_force(scene, [0, 0, 0]),
    ],
)  # fmt: skip
def test_number_in_place_of_a_scene_is_refused(call):
    with pytest.raises(tweezer.SceneError, match=r"^scene = 3: must be a Scene, the name of a"):
        call(3)


def test_a_tolerance_in_text_is_refused():
    with pytest.raises(tweezer.SceneError, match=r"^tolerance = '1e-6': must be a number$"):
        tweezer.simulate(tweezer.load_scene("silica-1um"), tolerance="1e-6")


def test_a_first_step_too_long_is_said_to_be_the_solvers_own():
    scene = tweezer.load_scene("silica-1um").replace(
        medium={"viscosity": "1e4 Pa s"}, simulation={"model": "full", "method": "scipy:DOP853"}
    )
    with pytest.warns(tweezer.PhysicsWarning, match="first step, which scipy:DOP853 chooses by"):
        run = tweezer.simulate(scene)
    assert run.attrs["status"] == "failed"
    assert tweezer.summarise(run).by_samples
