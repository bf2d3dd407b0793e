"""Many Brownian trajectories of one scene, written to a Zarr store or summarised as statistics.

Trajectories are computed in blocks, and each block in windows of time. While an ensemble runs, its
checkpoints are in the folder OUT.part beside the output. The checkpoint of a block contains the
states at the end of its last window and, for statistics, the block's statistics so far. After
minutes of work a checkpoint is also written within a window, with the samples so far. The folder
also contains the joined statistics of finished blocks. Blocks of Dask workers are joined from these
files, so their statistics neither pass through the scheduler nor wait in memory. A checkpoint names
its ensemble, and replaces the previous one atomically after the samples that it covers are written.
The next process therefore reads valid files whenever a process dies. A window that is computed
again gives the same bytes.

The running process holds OUT.lock, and Dask workers continue as long as the file of their run is in
OUT.part. A marker file in OUT.part names its owner. A folder of that name without the marker, or a
link, is refused, and other files in it are not touched.

All chunks of an array have the same size, so a missing or truncated chunk is found without reading
it, and a resumed ensemble computes its block again. A chunk with wrong bytes is detected by its
checksum when it is read.
"""

from tweezer.ensembles.ensemble import ensemble
from tweezer.ensembles.first_passage import EscapeTimes, escape_times

__all__ = ["EscapeTimes", "ensemble", "escape_times"]
