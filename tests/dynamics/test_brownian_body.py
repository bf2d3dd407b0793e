"""Steps of rigid bodies: one step by Gauss quadrature over its noise, and many in wells.

The oracles are exponentials of the generator in a representation, its square in polynomials of the
pose, Boltzmann's integral, and closed forms. Sampled tests fail for one seed in 1.7 million.
"""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation
from sympy.polys.domains import RR
from sympy.polys.rings import ring

from tests.reference.poses import UPRIGHT, Well, a_body, follow, nodes, one_step
from tweezer.dynamics.brownian import body, body_with_inertia

RNG = np.random.default_rng(3)
FAR = 5.0


def generators():
    """Matrices (6, 4, 4) of translations and rotations, which act on poses from the right."""
    E = np.zeros((6, 4, 4))
    for i in range(3):
        E[i, i, 3] = 1.0
        j, k = (i + 1) % 3, (i + 2) % 3
        E[3 + i, k, j], E[3 + i, j, k] = 1.0, -1.0
    return E


E = generators()
#: on pairs of poses, whose means are the second moments
PAIRS = np.array([np.kron(each, np.eye(4)) + np.kron(np.eye(4), each) for each in E])
_root = np.eye(6) + 0.35 * RNG.normal(size=(6, 6))
COUPLED = _root @ _root.T
AXES = np.diag([1.0, 1.3, 0.8, 0.5, 0.8, 2.0])


def turned(e):
    return Rotation.from_quat(e, scalar_first=True).as_matrix()


def poses(q, e):
    found = np.tile(np.eye(4), (len(q), 1, 1))
    found[:, :3, :3], found[:, :3, 3] = turned(e), q
    return found


def moments(scheme, mobility, h, many=5):
    """Means of pairs of poses after a free step from the origin, (16, 16)."""
    normal, weights = nodes(many, 6)
    g = poses(*one_step(scheme, a_body(mobility), h, normal)[:2])
    return np.einsum("n,nij,nkl->ikjl", weights, g, g).reshape(16, 16)


def semigroup(mobility, h):
    return expm(h * np.einsum("ab,aij,bjk->ik", mobility, PAIRS, PAIRS))


@pytest.mark.parametrize("scheme", [body.TRAPEZOID, body.ONE_CALL])
def test_free_rotation_about_unequal_axes_decays_at_the_exact_rates(scheme):
    D = np.array([0.5, 0.8, 2.0])
    x, weights = nodes(11, 3)
    normal = np.vstack([np.zeros_like(x), x])
    pairs = [np.kron(each, np.eye(3)) + np.kron(np.eye(3), each) for each in E[3:, :3, :3]]
    of_pairs = np.linalg.eigvalsh(-np.einsum("a,aij,ajk->ik", D, pairs, pairs))[1:]
    off = []
    for h in (0.05, 0.025):
        _, e, _ = one_step(scheme, a_body(np.diag([1, 1, 1, *D])), h, normal)
        R = turned(e)
        left = np.einsum("n,nii->i", weights, R)
        squares = np.einsum("n,nij,nkl->ikjl", weights, R, R).reshape(9, 9)
        found = -np.log(np.linalg.eigvalsh(squares)[-2::-1]) / h
        off.append([
            np.abs(-np.log(left) / h / (D.sum() - D) - 1).max(), np.abs(found / of_pairs - 1).max()
        ])  # fmt: skip
    assert off[0][0] < 5e-4
    assert off[0][1] < 1.6e-3
    assert np.divide(*off) == pytest.approx([4, 4], rel=0.05)


@pytest.mark.parametrize("scheme", [body.TRAPEZOID, body.ONE_CALL])
def test_free_steps_of_a_coupled_body_are_of_order_two(scheme):
    off = [np.abs(moments(scheme, COUPLED, h) - semigroup(COUPLED, h)).max() for h in (0.02, 0.01)]
    assert off[0] / off[1] == pytest.approx(8, rel=0.1)
    plain = np.linalg.cholesky(2 * 0.01 * COUPLED)
    assert off[1] < 0.1 * np.abs(expected_of(plain) - semigroup(COUPLED, 0.01)).max()


def expected_of(root):
    """Means of pairs of poses exp(xi) for xi with a root of its covariance."""
    normal, weights = nodes(4, 6)
    xi = root @ normal
    g = np.array([expm(each) for each in np.einsum("an,aij->nij", xi, E)])
    return np.einsum("n,nij,nkl->ikjl", weights, g, g).reshape(16, 16)


def generated_twice(mobility, well, q, R, kT):
    """f, L f and L L f at a pose for f of x, y^2 and n_z, (3, 3), in exact polynomials of the pose.

    L = (B W)_a X_a + kT B_ab X_a X_b, with the derivatives X_a along translations and rotations.
    """
    names = [*(f"q{i}" for i in range(3)), *(f"R{i}{j}" for i in range(3) for j in range(3))]
    field, *symbols = ring(names, RR)
    x, r = np.array(symbols[:3], object), np.array(symbols[3:], object).reshape(3, 3)
    zero, n, b = field(0), r[:, 2], r[:, 0]
    along, b_x = well.k_c * sum(x * n), well.K_1 * b[0]
    force = -well.k * x - n * along + [well.push - well.swirl * x[1], well.swirl * x[0], zero]
    moment = np.cross(x * along - [zero, zero, well.K_3 * n[2]], n)
    moment += np.array([zero, b_x * b[2], well.torque - b_x * b[1]])
    W = np.hstack([r.T @ force, r.T @ moment])
    g, B = np.hstack([r, x[:, None]]), mobility.astype(object)

    def along_field(a, f):
        change = (np.vstack([g, [zero] * 4]) @ E[a].astype(int).astype(object))[:3]
        return sum(change[k, j] * f.diff(g[k, j]) for k in range(3) for j in range(4))

    def generator(f):
        flow = B @ np.array([along_field(a, f) for a in range(6)], object)
        return sum(W * flow) + sum(kT * along_field(a, flow[a]) for a in range(6))

    at = list(zip(symbols, [*q.tolist(), *R.ravel().tolist()], strict=True))
    rows = [(f, first := generator(f), generator(first)) for f in (x[0], x[1] ** 2, n[2])]
    return np.array([[float(each.evaluate(at)) for each in row] for row in rows]).T


PULLED = Well(k=1.0, k_c=0.7, K_3=1.5, K_1=0.8, torque=0.9, swirl=0.6, push=0.4)


def test_trapezoid_is_of_weak_order_two_under_any_force():
    q, rotation, kT = np.array([0.3, -0.4, 0.5]), Rotation.random(random_state=4), 0.6
    mobility = 0.5 * COUPLED
    f, first, second = generated_twice(mobility, PULLED, q, rotation.as_matrix(), kT)
    normal, weights = nodes(5, 6)
    pose = q, rotation.as_quat(scalar_first=True)
    off = []
    for h in (0.02, 0.01):
        there, e, _ = one_step(
            body.TRAPEZOID, a_body(mobility), h, normal, PULLED, pose=pose, kT=kT
        )
        found = np.array([there[:, 0], there[:, 1] ** 2, turned(e)[:, 2, 2]])
        off.append(np.abs(found @ weights - (f + h * first + h**2 / 2 * second)).max())
    assert off[0] / off[1] == pytest.approx(8, rel=0.15)


# --- wells, by many steps ------------------------------------------------------------------------


def boltzmann(K_3, K_1):
    """<n_z^2> and <b_x^2> by quadrature over all rotations."""
    c, w = np.polynomial.legendre.leggauss(40)
    c, w = c[:, None, None], w[:, None, None]
    angle = np.arange(48) * 2 * np.pi / 48
    spin, about = angle[:, None], angle
    b_x = np.cos(spin) * c * np.cos(about) - np.sin(spin) * np.sin(about)
    w = w * np.exp((K_3 * c**2 + K_1 * b_x**2) / 2)
    return (w * c**2).sum() / w.sum(), (w * b_x**2).sum() / w.sum()


WELL = Well(k=1.0, k_c=1.0, K_3=4.0, K_1=2.0)
#: largest rate of `AXES` in this well: of a rotation about the third axis
FASTEST = 6.0


def seen_in_well(scheme, h, n=512, tau=None, inertia=None):
    """Errors of <U>, <n_z^2>, <b_x^2> in the well, and the standard errors, (2, 3); samples."""
    out = follow(scheme, a_body(AXES, inertia), h, n, 1100, 2, WELL, tau=tau, seed=5)[:, 100:]
    first = 3 if tau is None else 6
    q, R = out[..., :3], turned(out[..., first : first + 4].reshape(-1, 4))
    R = R.reshape(n, -1, 3, 3)
    n_z, b_x = R[..., 2, 2] ** 2, R[..., 0, 0] ** 2
    across = np.einsum("...i,...i", q, R[..., 2])
    U = ((q**2).sum(axis=-1) + across**2 - 4 * n_z - 2 * b_x) / 2
    exact = boltzmann(4, 2)
    exact = np.array([1.5 - 2 * exact[0] - exact[1], *exact])
    means = np.array([U, n_z, b_x]).mean(axis=2)
    return np.array([means.mean(axis=1) - exact, means.std(axis=1) / np.sqrt(n)]), out, R


@pytest.mark.parametrize("scheme", [body.TRAPEZOID, body.ONE_CALL])
def test_bodies_in_a_well_are_distributed_as_boltzmann_has_it(scheme):
    off, _, _ = seen_in_well(scheme, 0.2 / FASTEST)
    allowed = np.array([0.009, 0.001, 0.003])
    assert (np.abs(off[0]) < allowed + FAR * off[1]).all()


def test_inertia_changes_no_distribution_and_adds_thermal_velocities():
    h = 0.2 / FASTEST
    inertia = np.diag([1, 1, 1, 1, 2, 3]) * 1e-3 * h
    tau = a_body(AXES, inertia).relaxation_times
    off, out, R = seen_in_well(body_with_inertia.HEUN, h, tau=tau, inertia=inertia)
    allowed = np.array([0.009, 0.001, 0.003])
    assert (np.abs(off[0]) < allowed + FAR * off[1]).all()
    velocities = [np.einsum("...ji,...j", R, out[..., at : at + 3]) for at in (3, 10)]
    energies = np.concatenate(velocities, axis=-1) ** 2 * np.diag(inertia)
    count = energies[..., 0].size
    assert np.abs(energies.mean(axis=(0, 1)) - 1).max() < FAR * np.sqrt(2 / count)


def test_driven_top_spins_and_heats_the_fluid_at_the_exact_mean_rates():
    """A torque about z adds the rate torque (b + (b_3 - b) n_z^2), with Boltzmann's n_z.

    The heat is the work of all torques along the path, in Stratonovich's sense. Its mean
    equals the work of the constant torque, because the well takes none.
    """
    b, b_3, torque, K_3, n = 0.5, 2.0, 3.0, 5.0, 512
    h = 0.2 / (b * 2 * K_3)
    top = a_body(np.diag([1, 1, 1, b, b, b_3]))
    out = follow(body.TRAPEZOID, top, h, n, 2200, 1, Well(K_3=K_3, torque=torque), seed=2)[:, 200:]
    R = turned(out[..., 3:].reshape(-1, 4)).reshape(n, -1, 3, 3)
    step = R[:, 1:] @ np.swapaxes(R[:, :-1], -1, -2)
    angle = Rotation.from_matrix(step.reshape(-1, 3, 3)).as_rotvec().reshape(n, -1, 3)
    z, axis = np.array([0, 0, 1.0]), R[..., 2]
    torques = torque * z + K_3 * axis[..., 2:] * np.cross(axis, z)
    work = np.einsum("nsk,nsk->n", (torques[:, 1:] + torques[:, :-1]) / 2, angle)
    c, w = np.polynomial.legendre.leggauss(40)
    w = w * np.exp(K_3 * c**2 / 2)
    exact = torque * (b + (b_3 - b) * (w * c**2).sum() / w.sum())
    duration = h * angle.shape[1]
    for sums, rate in ((angle[..., 2].sum(axis=1), exact), (work, torque * exact)):
        found = sums / duration
        sampling = FAR * found.std() / np.sqrt(n)
        assert found.mean() == pytest.approx(rate, abs=0.003 * rate + sampling)


def test_velocity_of_a_free_body_relaxes_in_its_modes():
    """A coupled resistance and unequal inertia, to first order in a small velocity."""
    inertia = np.diag([1.0, 1.0, 1.0, 0.2, 0.3, 0.5])
    one = a_body(COUPLED, inertia)
    tau = one.relaxation_times
    V, h = 1e-7 * RNG.normal(size=6), 0.7 * tau[2]
    scheme = body_with_inertia.HEUN
    q, e, after = one_step(scheme, one, h, np.zeros((12, 1)), velocity=V, kT=1e-9, tau=tau)
    rates = np.linalg.solve(inertia, one.resistance)
    left = expm(-h * rates)
    way = np.linalg.solve(rates, (np.eye(6) - left) @ V)
    np.testing.assert_allclose(after[0], left @ V, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(np.hstack([q[0], 2 * e[0, 1:]]), way, rtol=1e-6, atol=1e-13)


def test_bodies_do_not_depend_on_their_company():
    one = a_body(COUPLED)
    many = follow(body.TRAPEZOID, one, 0.02, 150, 3, 2, WELL)
    few = follow(body.TRAPEZOID, one, 0.02, 5, 3, 2, WELL)
    assert np.array_equal(many[:5], few)
    assert np.abs(np.linalg.norm(many[..., 3:], axis=-1) - 1).max() < 1e-14
    assert not np.array_equal(few[0, 0, 3:], UPRIGHT)
