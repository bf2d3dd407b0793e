"""Motion of several beads that the fluid, tethers and forces couple."""
