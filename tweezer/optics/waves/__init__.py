"""The force of focused light on the bead, by waves."""
