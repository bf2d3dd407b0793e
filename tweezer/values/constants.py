"""Constants of nature, exact by the definition of the SI units.

`scipy.constants` has the same numbers, and takes a twentieth of a short command to import.
"""

Boltzmann = 1.380649e-23
"""J/K"""
speed_of_light = 299792458.0
"""m/s"""
