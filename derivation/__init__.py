"""SymPy derivation of the bead's equations of motion and of the force of one ray.

Symbols only: nothing here is imported when a bead is simulated. `python -m derivation`
emits the results as Numba modules into `generated/`.
"""
