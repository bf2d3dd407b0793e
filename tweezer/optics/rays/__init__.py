"""Ray optics: sums over rays (3.26), of the thesis's grid and of a quadrature over the lens."""
