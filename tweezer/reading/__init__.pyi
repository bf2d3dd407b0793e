from .columns import Columns, Wanted, only
from .digits import copied, measured, step_of, unmeasured
from .formats import HDF5, damaged, read_table
from .gaps import without_gaps
from .hdf5 import datasets
from .options import Reading
from .recording import Recording, Track, load_recording, load_track
from .table import refuse_too_long

__all__ = [
    "HDF5",
    "Columns",
    "Reading",
    "Recording",
    "Track",
    "Wanted",
    "copied",
    "damaged",
    "datasets",
    "load_recording",
    "load_track",
    "measured",
    "only",
    "read_table",
    "refuse_too_long",
    "step_of",
    "unmeasured",
    "without_gaps",
]
