"""Brownian motion with fixed steps: counter-based noise, exact drag, and one file per scheme."""
