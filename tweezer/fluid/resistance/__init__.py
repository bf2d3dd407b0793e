"""Drag of bodies of any shape: the 6 x 6 resistance in Stokes flow."""
