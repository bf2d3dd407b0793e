"""Constants of nature, exact by the definition of the SI units.

`scipy.constants` has the same numbers, but its import takes a twentieth of a short command.
"""

import math

Boltzmann = 1.380649e-23
"""Boltzmann constant, J/K"""
speed_of_light = 299792458.0
"""speed of light in vacuum, m/s"""
hbar = 6.62607015e-34 / (2 * math.pi)
"""reduced Planck constant, J s"""
