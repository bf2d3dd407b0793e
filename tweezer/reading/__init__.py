"""Tables of positions over time, as programs of measurement write them: text, arrays, HDF5, TDMS.

A file is opened as a `Table` of columns; those that are wanted are chosen by their headings, or by
name (`Reading`), and put into SI units (`read_table`). `without_gaps` is the rule on what lacks.
"""

from tweezer.reading.columns import Columns, Wanted, only
from tweezer.reading.digits import copied, measured, step_of, unmeasured
from tweezer.reading.formats import HDF5, damaged, read_table
from tweezer.reading.gaps import without_gaps
from tweezer.reading.hdf5 import datasets
from tweezer.reading.options import Reading
from tweezer.reading.table import refuse_too_long

__all__ = [
    "HDF5",
    "Columns",
    "Reading",
    "Wanted",
    "copied",
    "damaged",
    "datasets",
    "measured",
    "only",
    "read_table",
    "refuse_too_long",
    "step_of",
    "unmeasured",
    "without_gaps",
]
