"""Many Brownian trajectories of one scene: written to a Zarr store, or their statistics.

Trajectories are computed in blocks, and a block in windows of time. While an ensemble runs, its
checkpoints are in the folder OUT.part beside the output. For each block begun a checkpoint holds
the states at the end of its last window (after minutes of work also within a window, with the
samples so far), and for statistics what that block gathered. The statistics of all blocks joined so
far are there too. Blocks of Dask workers are joined from these files, so their statistics neither
pass through the scheduler nor wait in memory. A file is replaced as a whole, after the samples that
it stands for were written, and names its ensemble: whenever a process dies, the next one reads
valid files. A window computed again gives the same bytes.

The running process holds OUT.lock, and Dask workers continue as long as the file of its run is in
OUT.part. A marker file in OUT.part names its owner: a folder of that name without the marker, or a
link, is refused, and other files in it are not touched.

All chunks of an array have one size, so that a missing or truncated chunk is found without reading
it; a resumed ensemble computes its block again. Wrong bytes in a chunk are found by its checksum
when it is read.
"""

from tweezer.ensembles.ensemble import ensemble
from tweezer.ensembles.first_passage import EscapeTimes, escape_times

__all__ = ["EscapeTimes", "ensemble", "escape_times"]
