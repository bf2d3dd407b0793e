"""Spheres in Stokes flow by three formulations that share nothing with the product's.

* Along the line of centres: the stream function (M. Stimson and G. B. Jeffery, 1926, and A. D.
  Maude, 1961). Each degree has four equations, which are solved with any number of digits.
* Across it: bispherical harmonics of the pressure and of three potentials, with eight unknown
  coefficients for each degree. The equations hold on the surfaces alone: the velocity is given,
  and n.(n.grad)u = 0. The divergence of u is harmonic, so it vanishes if it does on the surfaces.
* Any number of spheres: H. Lamb's solution about each of them, fitted to points of their surfaces.

Mobilities are over 1/(6 pi mu) and powers of length. The names are those of
`tweezer.pair_mobilities`. `python -m tests.reference.spheres` makes tests/data/spheres.json in
minutes.
"""

from __future__ import annotations

import json
from pathlib import Path

import mpmath as mp
import numpy as np

FILE = Path(__file__).parents[1] / "data" / "spheres.json"
#: second radius and gap of the rows of the table; radius 1 is 1
ROWS = [
    (radius, gap)
    for radius, gaps in {
        "1": ("0.001", "0.004", "0.03", "0.2", "1", "10"),
        "0.5": ("0.001", "0.02", "0.3", "3"),
        "0.2": ("0.001", "0.01", "0.1", "1", "10"),
        "0.05": ("0.01", "0.5"),
    }.items()
    for gap in gaps
]
#: digits of the numbers of the table, made with 30
SHOWN = 20


def surfaces(radius, gap):
    """alpha, beta and c of spheres with the radii 1 and `radius`."""
    a, g = mp.mpf(radius), mp.mpf(gap)
    d = 1 + a + g
    alpha = mp.acosh((d**2 + 1 - a**2) / (2 * d))
    return alpha, mp.asinh(mp.sinh(alpha) / a), mp.sinh(alpha)


def _last(alpha, beta, digits):
    return int(mp.ceil((digits + 4) * mp.log(10) / min(alpha, beta))) + 10


# --- along the line of centres -------------------------------------------------------------------
def along(radius, gap, digits=30):
    """x11, x12, x22 and relative_x."""
    with mp.workdps(2 * digits):
        alpha, beta, c = surfaces(radius, gap)
        root = mp.sqrt(2)
        forces = mp.matrix(2, 2)
        for n in range(1, _last(alpha, beta, digits)):
            low, high, weight = n - mp.mpf(1) / 2, n + mp.mpf(3) / 2, mp.mpf(2 * n + 1)
            k = n * (n + 1) / (root * (2 * n - 1) * weight * (2 * n + 3))
            rows = mp.matrix(4, 4)
            sides = mp.matrix(4, 2)
            for sphere, xi in enumerate((alpha, -beta)):
                # e^(low xi), e^(high xi) over their values at alpha; e^(-low xi), .. at -beta
                grow = [mp.exp(p * (xi - alpha)) for p in (low, high)]
                fall = [mp.exp(-p * (xi + beta)) for p in (low, high)]
                slopes = [low * grow[0], high * grow[1], -low * fall[0], -high * fall[1]]
                for column, value in enumerate((*grow, *fall)):
                    rows[2 * sphere, column] = value
                    rows[2 * sphere + 1, column] = slopes[column]
                below, above = mp.exp(-low * abs(xi)), mp.exp(-high * abs(xi))
                sides[2 * sphere, sphere] = -k * ((2 * n + 3) * below - (2 * n - 1) * above)
                slope = k * (2 * n - 1) * (2 * n + 3) / 2 * (below - above)
                sides[2 * sphere + 1, sphere] = mp.sign(xi) * slope
            for motion in (0, 1):
                found = mp.lu_solve(rows, sides[:, motion])
                by = found[0] * mp.exp(-low * alpha) + found[1] * mp.exp(-high * alpha)
                forces[0, motion] -= weight * by
                by = found[2] * mp.exp(-low * beta) + found[3] * mp.exp(-high * beta)
                forces[1, motion] -= weight * by
        m = mp.inverse(forces * (4 * root * mp.pi * c / (6 * mp.pi)))
        return {
            "x11": m[0, 0], "x12": m[0, 1], "x22": m[1, 1],
            "relative_x": m[0, 0] + m[1, 1] - 2 * m[0, 1],
        }  # fmt: skip


def spin(radius, gap, digits=30):
    """rrx11, rrx12 and rrx22: the flow has one harmonic, and no pressure."""
    with mp.workdps(2 * digits):
        alpha, beta, c = surfaces(radius, gap)
        own, other, between = mp.mpf(0), mp.mpf(0), mp.mpf(0)
        # G. B. Jeffery (1915): images at the distances sinh(k (alpha + beta) + ..)
        for j in range(_last(alpha, beta, digits)):
            step = j * (alpha + beta)
            own += mp.sinh(step + alpha) ** -3
            other += mp.sinh(step + beta) ** -3
            between += mp.sinh(step + alpha + beta) ** -3
        resistance = mp.matrix([[own, -between], [-between, other]]) * c**3 * 8 / 6
        m = mp.inverse(resistance)
        return {"rrx11": m[0, 0], "rrx12": m[0, 1], "rrx22": m[1, 1]}


# --- across it -----------------------------------------------------------------------------------
def across(radius, gap, digits=30):
    """Every mobility of forces across the line, and of torques about such an axis."""
    with mp.workdps(digits + 15):
        alpha, beta, c = surfaces(radius, gap)
        last = _last(alpha, beta, digits)
        solved = _banded(*_equations(alpha, beta, last))
        unit = 4 * mp.sqrt(2) * mp.pi
        resistance = mp.matrix(4, 4)
        for motion in range(4):
            forces, torques = [mp.mpf(0)] * 2, [mp.mpf(0)] * 2
            for n in range(last):
                values = [each[motion] for each in solved[8 * n : 8 * n + 8]]
                for sphere, (xi, sign) in enumerate(((alpha, 1), (beta, -1))):
                    pressure, first, _, axial = values[4 * sphere : 4 * sphere + 4]
                    decay = unit * mp.exp(-(n + mp.mpf(1) / 2) * xi)
                    forces[sphere] += decay * n * (n + 1) * pressure
                    own = sign * (n + mp.mpf(1) / 2) * first - n * (n + 1) * axial
                    torques[sphere] += decay * own
            for sphere, z in enumerate((mp.coth(alpha), -mp.coth(beta))):
                resistance[sphere, motion] = forces[sphere]
                resistance[2 + sphere, motion] = torques[sphere] - z * forces[sphere]
        sizes = [mp.mpf(1), mp.mpf(1), c, c]
        for i in range(4):
            for j in range(4):
                resistance[i, j] *= sizes[i] * sizes[j] * c / (6 * mp.pi)
        m = mp.inverse(resistance)
        return {
            "y11": m[0, 0], "y12": m[0, 1], "y22": m[1, 1],
            "tr11": -m[2, 0], "tr12": -m[2, 1], "tr21": m[3, 0], "tr22": m[3, 1],
            "rry11": m[2, 2], "rry12": m[2, 3], "rry22": m[3, 3],
            "relative_y": m[0, 0] + m[1, 1] - 2 * m[0, 1],
        }  # fmt: skip


def _equations(alpha, beta, last):
    """Rows {column: value} and sides of all degrees.

    Unknowns of a degree: Q, U0, U2, W singular in sphere 1, times e^((n+1/2) alpha), and in 2.
    With X = cosh(xi) - nu and f' the part of the derivative over xi that is not of sqrt(X):

        sinh(xi) Q + 2 X W = 2 X V_z
        X U0 + sin(eta) Q/2 = X (V_rho - V_phi)
        X U2 + sin(eta) Q/2 = 0
        Q - sinh(xi) (nu Q' + sin(eta) (U0' + U2')) + 2 (1 - cosh(xi) nu) W'
            = sinh(xi) (sinh(xi) sin(eta) V_rho - (1 - cosh(xi) nu) V_z)/X
    """
    root, half = mp.sqrt(2), mp.mpf(1) / 2
    rows, sides = [], []
    for n in range(last):
        for sphere, xi in enumerate((alpha, -beta)):
            sh, ch, centre = mp.sinh(xi), mp.cosh(xi), mp.coth(xi)
            fall = [mp.exp(-abs(xi) * (n + shift + half)) for shift in (-1, 0, 1)]
            block = [{} for _ in range(4)]

            def add(row, kind, degree, factor, primed=False, xi=xi, block=block):
                if not (degree >= (1, 0, 2, 1)[kind] and degree < last and factor):
                    return
                k = degree + half
                for part, value in ((0, mp.exp(k * (xi - alpha))), (4, mp.exp(-k * (xi + beta)))):
                    signed = factor * value * ((k if part == 0 else -k) if primed else 1)
                    column = 8 * degree + part + kind
                    block[row][column] = block[row].get(column, 0) + signed

            def cosine(row, kind, order, factor, primed=False, add=add, n=n):
                """Add factor nu f: the degree n of it."""
                add(row, kind, n - 1, factor * mp.mpf(n - order) / (2 * n - 1), primed)
                add(row, kind, n + 1, factor * mp.mpf(n + order + 1) / (2 * n + 3), primed)

            lower, upper = mp.mpf(1) / (2 * n - 1), mp.mpf(1) / (2 * n + 3)
            given = [[mp.mpf(0)] * 4 for _ in range(4)]
            # sqrt(X) times: 1/sqrt(X), sqrt(X), and sin(eta)/sqrt(X)
            plain = root * fall[1]
            rooted = root * (ch * fall[1] - n * lower * fall[0] - (n + 1) * upper * fall[2])
            sine = root * (lower * fall[0] - upper * fall[2])
            if n >= 1:
                add(0, 0, n, sh)
                add(0, 3, n, 2 * ch)
                cosine(0, 3, 1, mp.mpf(-2))
                given[0][2 + sphere] = -2 * sine
            add(1, 1, n, ch)
            cosine(1, 1, 0, mp.mpf(-1))
            add(1, 0, n - 1, -half * n * (n - 1) * lower)
            add(1, 0, n + 1, half * (n + 1) * (n + 2) * upper)
            given[1][sphere] = 2 * rooted
            given[1][2 + sphere] = 2 * sh * plain - 2 * centre * rooted
            if n >= 2:
                add(2, 2, n, ch)
                cosine(2, 2, 2, mp.mpf(-1))
                add(2, 0, n - 1, half * lower)
                add(2, 0, n + 1, -half * upper)
            if n >= 1:
                add(3, 0, n, mp.mpf(1))
                cosine(3, 0, 1, -sh, primed=True)
                add(3, 1, n - 1, -sh * lower, primed=True)
                add(3, 1, n + 1, sh * upper, primed=True)
                add(3, 2, n - 1, sh * (n - 1) * (n - 2) * lower, primed=True)
                add(3, 2, n + 1, -sh * (n + 2) * (n + 3) * upper, primed=True)
                add(3, 3, n, mp.mpf(2), primed=True)
                cosine(3, 3, 1, -2 * ch, primed=True)
                given[3][sphere] = 2 * root * sh**2 * fall[1]
            for kind, (row, side) in enumerate(zip(block, given, strict=True)):
                empty = n < (1, 0, 2, 1)[kind]
                rows.append({8 * n + 4 * sphere + kind: mp.mpf(1)} if empty else row)
                sides.append(side)
    return rows, sides


def _banded(rows, sides):
    """Gauss's elimination with pivots, of rows that reach 16 columns to each side."""
    count = len(rows)
    for column in range(count):
        below = range(column, min(column + 17, count))
        pivot = max(below, key=lambda row: abs(rows[row].get(column, 0)))
        rows[column], rows[pivot] = rows[pivot], rows[column]
        sides[column], sides[pivot] = sides[pivot], sides[column]
        own = rows[column]
        for row in below[1:]:
            if value := rows[row].pop(column, 0):
                factor = value / own[column]
                for at, element in own.items():
                    if at > column:
                        rows[row][at] = rows[row].get(at, 0) - factor * element
                pairs = zip(sides[row], sides[column], strict=True)
                sides[row] = [a - factor * b for a, b in pairs]
    for column in reversed(range(count)):
        own = rows[column]
        for at, element in own.items():
            if at > column:
                pairs = zip(sides[column], sides[at], strict=True)
                sides[column] = [a - element * b for a, b in pairs]
        sides[column] = [each / own[column] for each in sides[column]]
    return sides


# --- any number of spheres -----------------------------------------------------------------------
def _harmonics(x, last):
    """r^(-n-1) P_n^m e^(i m phi) at points (count, 3), by (n, m)."""
    r2, z = (x**2).sum(-1), x[:, 2]
    planar = x[:, 0] + 1j * x[:, 1]
    found = {(0, 0): 1 / np.sqrt(r2) + 0j}
    for m in range(last + 1):
        if m:
            found[m, m] = (2 * m - 1) * found[m - 1, m - 1] * planar / r2
        for n in range(m + 1, last + 1):
            below = (n + m - 1) * found[n - 2, m] if n > m + 1 else 0
            found[n, m] = ((2 * n - 1) * z * found[n - 1, m] - below) / ((n - m) * r2)
    return found


def _lamb(x, degree):
    """Velocities (3 count, flows) outside of a sphere of radius 1, mu = 1.

    The first nine belong to degree 1: of each real harmonic pressure, potential and vorticity.
    """
    harmonics = _harmonics(x, degree + 1)
    r2 = (x**2).sum(-1)[:, None]
    columns = []
    for n in range(1, degree + 1):
        for m in range(n + 1):
            own = harmonics[n, m]
            raised = -harmonics[n + 1, m + 1]
            lowered = (n - m + 1) * (n - m + 2) * harmonics[n + 1, m - 1] if m else np.conj(raised)
            slope = np.stack(
                [(raised + lowered) / 2, (raised - lowered) / 2j, (m - n - 1) * harmonics[n + 1, m]]
            ).T
            size = float(mp.sqrt(mp.factorial(n - m) / mp.factorial(n + m)))
            pressure = (
                -mp.mpf(n - 2) / (2 * n * (2 * n - 1)), mp.mpf(n + 1) / (n * (2 * n - 1))
            )  # fmt: skip
            flows = (
                float(pressure[0]) * r2 * slope + float(pressure[1]) * x * own[:, None],
                slope / n,
                np.cross(slope, x) / n,
            )
            for part in (np.real, np.imag)[: 2 if m else 1]:
                columns += [size * part(flow).ravel() for flow in flows]
    return np.array(columns).T


def mobility(centres, radii, degree):
    """Mobility (6N, 6N) of spheres over 1/(6 pi mu): velocities, then angular velocities.

    By least squares over points on the surfaces, up to a degree of Lamb's solution.
    """
    centres, radii = np.asarray(centres, float), np.asarray(radii, float)
    count = len(radii)
    cosines, weights = np.polynomial.legendre.leggauss(degree + 2)
    angles = 2 * np.pi * np.arange(2 * degree + 4) / (2 * degree + 4)
    sines = np.sqrt(1 - cosines**2)
    planar = np.stack([np.cos(angles), np.sin(angles)], -1)
    across = (sines[:, None, None] * planar).reshape(-1, 2)
    unit = np.column_stack([across, np.repeat(cosines, len(angles))])
    weight = np.repeat(np.sqrt(np.repeat(weights, len(angles))), 3)[:, None]
    rows, sides = [], []
    for i in range(count):
        points = centres[i] + radii[i] * unit
        rows.append(
            weight
            * np.hstack([_lamb((points - centres[j]) / radii[j], degree) for j in range(count)])
        )
        side = np.zeros((len(unit), 3, 6 * count))
        for axis in range(3):
            side[:, axis, 3 * i + axis] = 1
            turn = np.cross(np.eye(3)[axis], radii[i] * unit)
            side[:, :, 3 * (count + i) + axis] = turn
        sides.append(weight * side.reshape(-1, 6 * count))
    # harmonics of size 1 on their spheres: the normal equations lose few digits
    matrix = np.vstack(rows)
    found = np.linalg.solve(matrix.T @ matrix, matrix.T @ np.vstack(sides))
    per = len(found) // count
    resistance = np.zeros((6 * count, 6 * count))
    for i in range(count):
        # z of degree 1, then x and y of which the harmonics have the factor sqrt(1/2)
        own = found[i * per : i * per + 9].reshape(3, 3, -1)[[1, 2, 0]]
        own = own * np.array([np.sqrt(0.5), np.sqrt(0.5), 1.0])[:, None, None]
        resistance[3 * i : 3 * i + 3] = 4 * np.pi * radii[i] * own[:, 0]
        resistance[3 * (count + i) : 3 * (count + i) + 3] = 8 * np.pi * radii[i] ** 2 * own[:, 2]
    return np.linalg.inv(resistance / (6 * np.pi))


def main():
    """Write the table."""
    rows = []
    for radius, gap in ROWS:
        values = {**along(radius, gap), **spin(radius, gap), **across(radius, gap)}
        shown = {name: mp.nstr(value, SHOWN) for name, value in sorted(values.items())}
        rows.append({"radius": radius, "gap": gap, "values": shown})
    about = (
        "Mobilities of spheres with radii 1 and `radius`, over 1/(6 pi mu) and powers of a length."
    )
    FILE.write_text(json.dumps({"about": about, "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
