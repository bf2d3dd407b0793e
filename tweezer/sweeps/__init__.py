"""Computation of a trap, run, ensemble or calibration for many scenes that differ in a few keys.

A sweep is a grid of values of keys, or a table of cases. Cases are computed independently, in
processes of this machine or by the workers of a Dask scheduler. While a sweep runs, the folder
OUT.part beside the output contains its journal. The first line identifies the computation, and
each further line is a finished case. When a process dies, the next one reads all complete lines, so
only the unfinished cases are computed again. A case that is computed again gives the same numbers.
The store OUT is written once, with all cases in order, so its bytes do not depend on interruptions.
"""

from tweezer.sweeps.sweep import sweep

__all__ = ["sweep"]
