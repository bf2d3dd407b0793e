"""Numba modules made by `python -m derivation`; do not edit.

One module a model and variant. They import math and numba only. `memory_poles` is a table.
"""
