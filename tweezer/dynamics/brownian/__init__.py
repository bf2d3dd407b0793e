"""Brownian motion at fixed steps: noise by counter, exact drag, one small file a scheme."""
