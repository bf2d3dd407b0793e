"""Many scenes that differ in a few keys, and what becomes of the bead in each.

A sweep is a grid of values of keys, or a table of cases. Each case is computed by itself, in
processes of this machine or by the workers of a Dask scheduler. While a sweep runs, the folder
OUT.part beside the output holds its journal: a first line that says what is computed, and a line
for each finished case. Whenever a process dies, the next one reads all whole lines, so that at most
the cases then at work are computed again. A case computed again gives the same numbers, and the
store OUT is written once, of all cases in their order: its bytes do not depend on interruptions.
"""

from tweezer.sweeps.sweep import sweep

__all__ = ["sweep"]
