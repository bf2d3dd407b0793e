"""Many Brownian trajectories of one scene: written to a Zarr store, or their statistics.

Trajectories are computed in blocks, a block in windows of time. While an ensemble is at work, what
it goes on from lies beside its output, in OUT.part: of every block begun the states at the end of
its last window, or within it after minutes of work with the samples until then, and, of statistics,
what was gathered in that block and in all blocks before. From there the blocks of Dask workers are
joined, too: what they gathered passes through no scheduler and waits in no memory. These files are
replaced whole, after the samples they stand for were written, and name the ensemble they are of; so
whenever a process dies, what is read next is sound. A window computed again gives the same bytes.
The process at work holds OUT.lock, and Dask workers go on as long as the file of its run is in
OUT.part. A file in OUT.part tells whose it is: a folder of that name without it, or a link, is
refused, and of other files there none is touched.

Chunks of a store are of one size each, so that one which is gone or cut is found without reading
any; resumed, its block is computed again. A byte that is wrong in one is found by its checksum when
it is read.
"""

from tweezer.ensembles.ensemble import ensemble

__all__ = ["ensemble"]
