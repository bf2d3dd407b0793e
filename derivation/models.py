"""The catalogue of emitted modules: which equations, for which scene, with which arguments."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from . import bodies, chains, heat, media, ray, spline, water, waves
from . import body_motion as bm
from . import drag as dg
from . import euler_parameters as ep
from . import hydrodynamics as hd
from . import langevin as lv
from . import multiscale as ms
from . import rigid_body as rb
from . import symbols as sy
from .lowering import Argument, Function
from .symbols import Quantity, vector


@dataclass(frozen=True)
class Module:
    """One file of `generated/`."""

    name: str
    title: str
    notes: str
    state: tuple[Quantity, ...]
    params: tuple[Quantity, ...]
    functions: tuple[Function, ...]
    #: files of `derivation/` that hold its equations
    sources: tuple[str, ...]
    #: numba options of its functions, written out literally in the module; None: plain Python, for
    #: what is evaluated once
    jit_options: str | None = "cache=True"
    #: of a model: whether each velocity decays exponentially by itself under a uniform drag
    linear_drag: bool = False


FORCE = Argument("force", sy.FORCE, (3,))
MOMENT = Argument("moment", sy.MOMENT, (3,))
FORCE_GRADIENT = Argument("force_gradient", sy.FORCE_GRADIENT, (3, 3))
MOMENT_GRADIENT = Argument("moment_gradient", sy.MOMENT_GRADIENT, (3, 3))
FORCE_CURVATURE = Argument("force_curvature", sy.FORCE_CURVATURE, (3, 3))
MOMENT_CURVATURE = Argument("moment_curvature", sy.MOMENT_CURVATURE, (3, 3))

MOBILITY = Argument("mobility", sy.MOBILITY, (5,))
MOBILITY_GRADIENT = Argument("mobility_gradient", sy.MOBILITY_GRADIENT, (5, 3))

_DF = sp.Matrix(3, 3, vector(sy.FORCE_GRADIENT))
_DM = sp.Matrix(3, 3, vector(sy.MOMENT_GRADIENT))
_HF = sp.Matrix(3, 3, vector(sy.FORCE_CURVATURE))
_HM = sp.Matrix(3, 3, vector(sy.MOMENT_CURVATURE))

#: Derivative of each input over the position: dF/dq, dM/dq and db/dq. The rates along
#: u = (F + W)/beta_v give d(DF u)/dq = HF + DF DF/beta_v
_OVER_POSITION = (
    (vector(sy.FORCE), _DF),
    (vector(sy.MOMENT), _DM),
    (ms.Fdot, _HF + _DF * _DF / rb.beta_v),
    (ms.Mdot, _HM + _DM * _DF / rb.beta_v),
    (vector(sy.MOBILITY), sp.Matrix(5, 3, vector(sy.MOBILITY_GRADIENT))),
)


def jacobian(rates: sp.MatrixBase, state: tuple[Quantity, ...]) -> sp.MatrixBase:
    """Return d(rates)/d(state), including force, moment and mobility that depend on position."""
    result = rates.jacobian(vector(state))
    for inputs, gradient in _OVER_POSITION:
        result[:, :3] += rates.jacobian(inputs) * gradient
    return result


Named = tuple[tuple[Quantity, sp.Expr], ...]


def _named(quantities: tuple[Quantity, ...], values: sp.MatrixBase) -> Named:
    return tuple(zip(quantities, values, strict=True))


def _scalars(quantities: tuple[Quantity, ...]) -> tuple[Argument, ...]:
    return tuple(Argument(quantity.name, (quantity,)) for quantity in quantities)


def _dynamics(
    name: str,
    title: str,
    notes: str,
    state: tuple[Quantity, ...],
    params: tuple[Quantity, ...],
    rates: sp.MatrixBase,
    inputs: tuple[Argument, ...],
    jacobian_inputs: tuple[Argument, ...],
    sources: tuple[str, ...],
    intermediates: tuple[tuple[Quantity, sp.Expr], ...] = (),
    extra: tuple[Function, ...] = (),
    keep: tuple[Quantity, ...] = (),
    linear_drag: bool = False,
) -> Module:
    """A model: its right-hand side and its Jacobian.

    Intermediates in `keep` stay named in the Jacobian too: they depend on the inputs alone, and
    `_OVER_POSITION` has their derivatives; the others are differentiated through.
    """
    arguments = (Argument("t", (sy.TIME,)), Argument("state", state, (len(state),)), *inputs)
    parameters = Argument("params", params, (len(params),))
    rhs = Function(
        "rhs", "Rate of change of the state.", (*arguments, parameters), rates, intermediates
    )
    differentiated = Function(
        "", "", (), rates, tuple(pair for pair in intermediates if pair[0] not in keep)
    ).expanded()
    derivative = Function(
        "jacobian",
        "Derivative of the right-hand side: out[i, j] = d(rate i)/d(state j).",
        (*arguments, *jacobian_inputs, parameters),
        jacobian(differentiated, state),
        tuple(pair for pair in intermediates if pair[0] in keep),
    )
    functions = (rhs, derivative, *extra)
    return Module(name, title, notes, state, params, functions, sources, linear_drag=linear_drag)


_SPHERE = (sy.SPHERE_INERTIA,)
_TRANSLATION_NOTES = "No rotation: for a bead on which the light exerts no moment."
_SPHERE_NOTES = "A sphere: K (A.17) vanishes. State (e, omega), which no constraint can leave."
_BODY_NOTES = "Any principal moments of inertia. State (e, omega), which no constraint can leave."
_RATES_NOTES = (
    "The thesis's own state (e, e'), with (A.24) solved in closed form. The constraints (A.21)\n"
    "and (A.22) hold along exact solutions only: project the state (`kinematics.project`)."
)


def _inertia(kind: str) -> tuple[tuple[Quantity, ...], sp.MatrixBase]:
    return (_SPHERE, rb.I_sphere) if kind == "sphere" else (sy.INERTIA, rb.I_AA)


def _inertial_models(scaling: bool) -> list[Module]:
    """`full` (A.25), or `scaled` (4.17): translation, and the rotation of sphere and rigid body."""
    prefix = "scaled" if scaling else "full"
    title = "Scaled model (4.17)" if scaling else "Full model (A.25)"
    # (4.16): a2 multiplies all that is not inertia
    a2 = ms.a2 if scaling else sp.Integer(1)
    leading = (sy.SCALING,) if scaling else ()
    sources = (*(("multiscale.py",) if scaling else ()), "rigid_body.py", "drag.py")
    moment = a2 * (rb.M_others + dg.drag_moment)
    translation_params = (sy.MASS, *leading, *sy.WEIGHT)
    modules = [
        _dynamics(
            f"{prefix}_translation",
            f"{title}: translation.",
            _TRANSLATION_NOTES,
            (*sy.POSITION, *sy.VELOCITY),
            translation_params,
            rb.v.col_join(a2 * dg.acceleration_without_rotation),
            (FORCE, MOBILITY),
            (FORCE_GRADIENT, MOBILITY_GRADIENT),
            sources,
            linear_drag=True,
        )
    ]
    for kind, notes in (("sphere", _SPHERE_NOTES), ("rigid_body", _BODY_NOTES)):
        quantities, inertia = _inertia(kind)
        params = (sy.MASS, *quantities, *leading, *sy.WEIGHT)
        label = kind.replace("_", " ")
        modules.append(
            _dynamics(
                f"{prefix}_{kind}",
                f"{title}: translation and rotation of a {label}.",
                notes,
                (*sy.POSITION, *sy.EULER_PARAMETERS, *sy.VELOCITY, *sy.ANGULAR_VELOCITY),
                params,
                sp.Matrix.vstack(
                    rb.v,
                    ep.euler_rates_from_omega,
                    a2 * dg.acceleration,
                    rb.angular_acceleration(inertia, moment),
                ),
                (FORCE, MOMENT, MOBILITY),
                (FORCE_GRADIENT, MOMENT_GRADIENT, MOBILITY_GRADIENT),
                sources,
                linear_drag=kind == "sphere",
            )
        )
        omega_of_rates = _named(sy.ANGULAR_VELOCITY, ep.L * ep.edot)
        # with L' e' = 0, K (A.17) is w x (I w), and zero for the sphere
        gyroscopic = rb.reduced_K(inertia)
        modules.append(
            _dynamics(
                f"{prefix}_{kind}_euler_rates",
                f"{title}: translation and rotation of a {label}, Euler-parameter rates.",
                _RATES_NOTES,
                (*sy.POSITION, *sy.EULER_PARAMETERS, *sy.VELOCITY, *sy.EULER_RATES),
                params,
                sp.Matrix.vstack(
                    rb.v,
                    ep.edot,
                    a2 * dg.acceleration,
                    rb.euler_acceleration(inertia, moment, gyroscopic),
                ),
                (FORCE, MOMENT, MOBILITY),
                (FORCE_GRADIENT, MOMENT_GRADIENT, MOBILITY_GRADIENT),
                sources,
                omega_of_rates,
            )
        )
    return modules


def _turning(omega: sp.MatrixBase) -> sp.MatrixBase:
    return ep.euler_rates_from_omega.subs(
        dict(zip(ep.omega, omega, strict=True)), simultaneous=True
    )


def _overdamped_models() -> list[Module]:
    return [
        _dynamics(
            "overdamped_translation",
            "Overdamped model (5.2): translation.",
            _TRANSLATION_NOTES,
            sy.POSITION,
            sy.WEIGHT,
            dg.overdamped_velocity_without_rotation,
            (FORCE, MOBILITY),
            (FORCE_GRADIENT, MOBILITY_GRADIENT),
            ("drag.py",),
        ),
        _dynamics(
            "overdamped_rotation",
            "Overdamped model (5.2): translation and rotation.",
            "Without inertia: the same for a sphere and for any other body of this drag.",
            (*sy.POSITION, *sy.EULER_PARAMETERS),
            sy.WEIGHT,
            dg.overdamped_velocity.col_join(_turning(dg.overdamped_angular_velocity)),
            (FORCE, MOMENT, MOBILITY),
            (FORCE_GRADIENT, MOMENT_GRADIENT, MOBILITY_GRADIENT),
            ("drag.py",),
        ),
    ]


def _first_order_models() -> list[Module]:
    """Return the modules of (4.11) solved to order epsilon, with matched start and initial layer.

    They require a uniform drag: one beta_v and one beta_w at every position.
    """
    rates = (
        *_named(sy.FORCE_RATE, ms.force_rate),
        *_named(sy.MOMENT_RATE, ms.moment_rate),
    )
    modules = []
    for kind in ("translation", "sphere", "rigid_body"):
        rotating = kind != "translation"
        quantities, inertia = _inertia(kind) if rotating else ((), None)
        state = (*sy.POSITION, *(sy.EULER_PARAMETERS if rotating else ()))
        released = (*state, *sy.VELOCITY, *(sy.ANGULAR_VELOCITY if rotating else ()))
        params = (
            (sy.MASS, *quantities, sy.DRAG, sy.ROTATIONAL_DRAG, *sy.WEIGHT)
            if rotating
            else (sy.MASS, sy.DRAG, *sy.WEIGHT)
        )
        kept = (*sy.FORCE_RATE, *sy.MOMENT_RATE) if rotating else sy.FORCE_RATE
        fields = (FORCE, MOMENT) if rotating else (FORCE,)
        gradients = (FORCE_GRADIENT, MOMENT_GRADIENT) if rotating else (FORCE_GRADIENT,)
        curvatures = (FORCE_CURVATURE, MOMENT_CURVATURE) if rotating else (FORCE_CURVATURE,)
        velocity = ms.first_order_velocity
        start = ms.matched_position
        if rotating:
            velocity = velocity.col_join(_turning(ms.first_order_angular_velocity(inertia)))
            start = start.col_join(ms.matched_euler_parameters(inertia))
        parameters = Argument("params", params, (len(params),))
        released_and_fields = (
            Argument("released", released, (len(released),)),
            *fields,
            parameters,
        )
        matched = Function(
            "matched_start",
            "Start of the slow motion for a bead released with (position, ..., velocities).",
            released_and_fields,
            start,
        )
        remains = ms.layer(inertia)
        layer = Function(
            "initial_layer",
            "What the release still adds to the slow motion at time t: "
            + (
                "displacement, velocity,\nangle turned and angular velocity (body frame)."
                if rotating
                else "displacement and velocity."
            ),
            (Argument("t", (sy.TIME,)), *released_and_fields),
            remains,
        )
        modules.append(
            _dynamics(
                f"first_order_{kind}",
                f"First-order slow model: {kind.replace('_', ' ')}.",
                "The expansion (4.11) solved to order epsilon: q' = u - tau (Du) u with\n"
                "u = (F + W)/beta_v and tau = m/beta_v. Free of stiffness.",
                state,
                params,
                velocity,
                (*fields, *gradients),
                curvatures,
                ("multiscale.py",),
                tuple(pair for pair in rates if pair[0] in kept),
                (matched, layer),
                keep=kept,
            )
        )
    return modules


_BODY_FRAME = (
    "q is the centre of mass, and the moment is that about it. The matrices are constant and\n"
    "symmetric; rows and columns 1-3 are along P1..P3, rows and columns 4-6 about them."
)


def _body_models() -> list[Module]:
    """Return the models of a body of any shape, without Jacobians."""
    placed = (*sy.POSITION, *sy.EULER_PARAMETERS)
    released = (*placed, *sy.VELOCITY, *sy.ANGULAR_VELOCITY)

    def model(
        name: str, title: str, notes: str, state: tuple[Quantity, ...],
        params: tuple[Quantity, ...], rates: sp.MatrixBase, extra: tuple[Function, ...] = (),
    ) -> Module:  # fmt: skip
        arguments = (
            Argument("t", (sy.TIME,)),
            Argument("state", state, (len(state),)),
            FORCE,
            MOMENT,
            Argument("params", params, (len(params),)),
        )
        rhs = Function("rhs", "Rate of change of the state.", arguments, rates)
        notes = f"{notes}\n{_BODY_FRAME}"
        return Module(name, title, notes, state, params, (rhs, *extra), ("body_motion.py",))

    inertia, drag = sy.upper(sy.BODY_INERTIA), sy.upper(sy.BODY_DRAG)
    mobility = sy.upper(sy.BODY_MOBILITY)
    of_overdamped = (*mobility, *sy.WEIGHT)
    of_first_order = (*of_overdamped, *inertia)
    parameters = Argument("params", of_first_order, (len(of_first_order),))
    e = Argument("e", sy.EULER_PARAMETERS, (4,))
    slow = bm.slow_twist
    overdamped = (ep.R * slow[:3, :]).col_join(_turning(slow[3:, :]))
    slow_motion = (
        Function(
            "slow_velocity",
            "V_0 = B W, the twist (u, omega) without inertia, body frame.",
            (e, FORCE, MOMENT, parameters),
            slow,
        ),
        Function(
            "slow_wrench",
            "Force and moment in the inertial frame, for `rates`: those of the light less the\n"
            "inertial ones, M B W' + N(V_0). They do not contain the weight. The rates of the\n"
            "light's force and moment are those along `slow_velocity`, inertial frame.",
            (
                e,
                FORCE,
                MOMENT,
                Argument("force_rate", sy.FORCE_RATE, (3,)),
                Argument("moment_rate", sy.MOMENT_RATE, (3,)),
                parameters,
            ),
            bm.equivalent_wrench,
        ),
        Function(
            "matched_start",
            "Displacement B M (V - V_0) from the release (position, ..., velocities) to the start\n"
            "of the slow motion: translation and rotation vector, body frame.",
            (Argument("released", released, (len(released),)), FORCE, MOMENT, parameters),
            bm.matched_displacement,
        ),
    )
    return [
        model(
            "full_body",
            "Full model of a body of any shape: M V' + N(V) = W - R V.",
            "H is the inverse of the inertia M. M may contain the added mass of the fluid.",
            released,
            (*inertia, *sy.upper(sy.BODY_INVERSE_INERTIA), *drag, *sy.WEIGHT),
            sp.Matrix.vstack(
                rb.v, ep.euler_rates_from_omega, bm.acceleration, bm.angular_acceleration
            ),
        ),
        model(
            "overdamped_body",
            "Overdamped model of a body of any shape: V = B W.",
            "B is the inverse of the drag.",
            placed,
            of_overdamped,
            overdamped,
        ),
        model(
            "first_order_body",
            "First-order slow model of a body of any shape: V = B (W - M B W' - N(V_0)).",
            "V_0 = B W, and B is the inverse of the drag. `rhs` is the overdamped motion. It is\n"
            "correct to first order in the inertia M if force and moment are those of\n"
            "`slow_wrench`.",
            placed,
            of_first_order,
            overdamped,
            slow_motion,
        ),
    ]


def _body_motion() -> Module:
    arguments = (
        Argument("velocity", sy.TWIST, (6,)),
        Argument("inertia", sy.BODY_INERTIA, (6, 6)),
    )
    steady = bm.kirchhoff(bm.V, bm.M)
    return Module(
        "body_motion",
        "Inertial forces and moments of a body of any shape (Kirchhoff).",
        "Of the symmetric matrix of inertia the upper triangle is read.",
        (),
        (),
        (
            Function(
                "kirchhoff",
                "N(V) = (omega x p, omega x l + u x p) with (p, l) = M V, body frame.",
                arguments,
                steady,
            ),
            Function(
                "kirchhoff_gradient",
                "dN/dV: out[i, j] = dN_i/dV_j.",
                arguments,
                steady.jacobian(bm.V),
            ),
        ),
        ("body_motion.py",),
    )


def _kinematics() -> Module:
    e = Argument("e", sy.EULER_PARAMETERS, (4,))
    edot = Argument("edot", sy.EULER_RATES, (4,))
    omega = Argument("omega", sy.ANGULAR_VELOCITY, (3,))
    return Module(
        "kinematics",
        "Rotation by Euler parameters (A.2)-(A.9).",
        "For e of any length but 0, where nothing else is said.",
        (),
        (),
        (
            Function("rotation_matrix", "R (A.2): body to inertial components.", (e,), ep.R),
            Function(
                "angular_velocity",
                "omega = L e'/|e|^2 (A.7), body frame.",
                (e, edot),
                ep.L * ep.edot / ep.norm_squared,
            ),
            Function(
                "euler_rates",
                "e' = L^T omega/4: the rates with e.e' = 0 (A.22).",
                (e, omega),
                ep.euler_rates_from_omega,
            ),
            Function(
                "project",
                "n = e/|e| and its rate, which meet (A.21) and (A.22), in place of (A.26).",
                (e, edot),
                ep.unit_euler_parameters.col_join(
                    ep.tangent_euler_rates / sp.sqrt(ep.norm_squared)
                ),
            ),
        ),
        ("euler_parameters.py",),
    )


def _ray() -> Module:
    arguments = (Argument("S", (sy.SINE_SQUARED,)), Argument("n_mP", (sy.INDEX_RATIO,)))
    ray_and_impact = (*_scalars(sy.RAY), *_scalars(sy.IMPACT))
    jacobian = tuple(f"J{i}{j}" for i in "123" for j in "123")
    radius = Argument("r", (sy.RADIUS,))
    cosine = Argument("cos_alpha", (sy.COS_ALPHA,))
    values = q_sc, _, g, _ = _scalars(
        (sy.SCATTERING, sy.SCATTERING_RATE, sy.GRADIENT, sy.GRADIENT_RATE)
    )
    efficiencies = {
        "circular": (
            "circular or unpolarised light: Q averaged over s and p",
            ray.CIRCULAR,
            _parts_of_light(ray.CIRCULAR_PARTS, sy.OF_CIRCULAR, ray.CIRCULAR),
        ),
        "averaged_reflectance": (
            "the thesis's: R averaged over s and p (3.17)",
            ray.AVERAGED,
            _parts_of_light(ray.AVERAGED_PARTS, sy.OF_AVERAGED, ray.AVERAGED),
        ),
    }
    cosines = tuple(
        zip((sy.COS_SQUARED, sy.COS_ALPHA, sy.COS_BETA), ray.COSINES.values(), strict=True)
    )
    surface = tuple(zip(sy.SURFACE, ray.SURFACE_PARTS.values(), strict=True))
    functions = []
    for name, (meaning, light, of_light) in efficiencies.items():
        scattering, gradient = ray.shared_scattering(light), ray.shared_gradient(light)
        parts = (*surface, *of_light)
        functions.append(
            Function(
                name,
                f"Efficiencies of a ray (3.19-3.22), {meaning}.",
                arguments,
                sp.Matrix([scattering, gradient]),
                (*cosines, *parts),
                ("Q_sc", "G"),
            )
        )
        functions.append(
            Function(
                f"{name}_rates",
                f"Efficiencies of a ray and their derivatives over S, {meaning}.",
                arguments,
                sp.Matrix(
                    [
                        scattering,
                        ray.rate_in_S(scattering),
                        gradient,
                        ray.rate_in_S(gradient),
                    ]
                ),
                (*cosines, *parts, *_with_rates(parts)),
                ("Q_sc", "dQ_sc", "G", "dG"),
            )
        )
    total = (ray.TOTAL_SCATTERING, ray.TOTAL_GRADIENT)
    functions += [
        Function(
            "total_reflection",
            "Efficiencies of a totally reflected ray: S >= 1/n_mP^2, n_mP > 1.",
            arguments[:1],
            sp.Matrix(total),
            cosines[:2],
            ("Q_sc", "G"),
        ),
        Function(
            "total_reflection_rates",
            "Efficiencies of a totally reflected ray and their derivatives over S.",
            arguments[:1],
            sp.Matrix([total[0], ray.rate_in_S(total[0]), total[1], ray.rate_in_S(total[1])]).subs(
                ray.h, 1 / (2 * ray.c * ray.b)
            ),
            cosines[:2],
            ("Q_sc", "dQ_sc", "G", "dG"),
        ),
    ]
    return Module(
        "ray",
        "The force of one ray on the bead (3.14)-(3.26).",
        "The ray passes through the focus, the origin, along u. Forces in units of n_m P/c;\n"
        "moments in n_m P/c times metres. Efficiencies hold for 0 <= S < 1 (and S < 1/n_mP^2).",
        (),
        (),
        (
            *functions,
            Function(
                "cos_squared_beta",
                "cos^2 of the angle of refraction (3.15); negative where all is reflected.",
                arguments,
                sp.Matrix([ray.cos_squared_beta]),
                output_names=("cos_squared",),
            ),
            Function(
                "impact",
                "n, from the bead's centre to the nearest point of the ray, and S = |n|^2/r^2.\n"
                "The ray hits the bead where S < 1, (3.8).",
                (*_scalars(sy.RAY), *_scalars(sy.POSITION), radius),
                ray.n.col_join(sp.Matrix([(ray.n.T * ray.n)[0] / ray.r**2])),
                _named(sy.IMPACT, ray.n_of_p),
                ("n1", "n2", "n3", "S"),
            ),
            Function(
                "force",
                "Force of the ray on the bead (3.24).",
                (*ray_and_impact, radius, q_sc, g),
                ray.force,
                output_names=("F1", "F2", "F3"),
            ),
            Function(
                "passage",
                "s = u.p, the centre's place along the ray, and S = |p|^2 - s^2 by (3.12).\n"
                "p is in radii; the digits of |p|^2 are lost.",
                (*_scalars(sy.RAY), *_scalars(sy.PLACE)),
                sp.Matrix([sy.ALONG_RAY.symbol, ray.S_by_place]),
                ((sy.ALONG_RAY, ray.along_ray),),
                ("s", "S"),
            ),
            Function(
                "force_along_ray",
                "F + G p, along the ray, of its force F (3.24) on the bead: p in radii.",
                (*_scalars(sy.RAY), *_scalars((sy.ALONG_RAY,)), q_sc, g),
                ray.force_along_ray,
                output_names=("F1", "F2", "F3"),
            ),
            Function(
                "moment",
                "Moment (3.25) of that force, applied where the ray enters the bead.",
                (*ray_and_impact, cosine, q_sc, g),
                ray.moment_reduced,
                output_names=("M1", "M2", "M3"),
            ),
            Function(
                "gradient_of_force",
                "dF/dp (3.24), row by row; derivatives over S come from the `_rates` functions.",
                (*ray_and_impact, radius, *values),
                sp.Matrix(list(ray.force_gradient)),
                output_names=jacobian,
            ),
            Function(
                "gradient_of_moment",
                "dM/dp of the moment (3.25), row by row.",
                (*ray_and_impact, radius, cosine, *values),
                sp.Matrix(list(ray.moment_gradient)),
                output_names=jacobian,
            ),
            *_polarised(arguments, cosines),
        ),
        ("ray.py",),
        'cache=True, error_model="numpy", forceinline=True',
    )


def _parts_of_light(
    parts: Mapping[sp.Symbol, sp.Expr], names: tuple[Quantity, ...], light: ray.Light
) -> Named:
    """Named parts of the efficiencies of one kind of light."""
    shared = ray.efficiency_parts(light)
    return (
        *zip(names, parts.values(), strict=True),
        *zip(sy.EFFICIENCIES, shared.values(), strict=True),
    )


def _with_rates(parts: Named) -> Named:
    """Return 1/(2 q) and the derivatives over S of named parts."""
    return (
        (sy.PER_COSINES, ray.per_cosines),
        *((sy.over_S(part), ray.rate_of_part(part.symbol, value)) for part, value in parts),
    )


def _polarised(arguments: tuple[Argument, ...], cosines: Named) -> tuple[Function, ...]:
    """Return functions for the difference that linear or elliptical polarisation makes."""
    u, n = _scalars(sy.RAY), _scalars(sy.IMPACT)
    radius = Argument("r", (sy.RADIUS,))
    cosine = Argument("cos_alpha", (sy.COS_ALPHA,))
    field = (*_scalars(sy.FIELD_REAL), *_scalars(sy.FIELD_IMAGINARY))
    x, y = _scalars((sy.SPLIT_SCATTERING, sy.SPLIT_GRADIENT))
    dsigma = _scalars(sy.POLARISATION_RATES)
    scattering, gradient = ray.split(ray.scattering), ray.split(ray.gradient)
    surface = zip(sy.SURFACE, ray.SURFACE_PARTS.values(), strict=True)
    parts = (*surface, *zip(sy.OF_CIRCULAR, ray.CIRCULAR_PARTS.values(), strict=True))
    jacobian = tuple(f"J{i}{j}" for i in "123" for j in "123")
    return (
        Function(
            "electric_field",
            "Field of a ray, real and imaginary part, from the Jones vector in the pupil.",
            (*u, *_scalars(sy.JONES)),
            ray.field_real.col_join(ray.field_imaginary),
            output_names=("E1", "E2", "E3", "H1", "H2", "H3"),
        ),
        Function(
            "polarisation",
            "sigma = S (f_s - f_p), the excess of s-polarised power.",
            (*u, *n, radius, *field),
            sp.Matrix([ray.sigma]),
            output_names=("sigma",),
        ),
        Function(
            "gradient_of_polarisation",
            "dsigma/dp.",
            (*u, *n, radius, *field),
            ray.sigma_gradient,
            output_names=("dsigma1", "dsigma2", "dsigma3"),
        ),
        Function(
            "split",
            "Half the differences of the efficiencies of s and p, over S: what sigma multiplies.",
            arguments,
            sp.Matrix([scattering, gradient]),
            (*cosines, *parts),
            ("X", "Y"),
        ),
        Function(
            "split_rates",
            "The same and their derivatives over S.",
            arguments,
            sp.Matrix([scattering, ray.rate_in_S(scattering), gradient, ray.rate_in_S(gradient)]),
            (*cosines, *parts, *_with_rates(parts)),
            ("X", "dX", "Y", "dY"),
        ),
        Function(
            "turning_force",
            "What the turning plane of incidence adds to dF/dp.",
            (*u, *n, radius, x, y, *dsigma),
            sp.Matrix(list(ray.turning_force)),
            output_names=jacobian,
        ),
        Function(
            "turning_moment",
            "What the turning plane of incidence adds to dM/dp.",
            (*u, *n, cosine, x, y, *dsigma),
            sp.Matrix(list(ray.turning_moment)),
            output_names=jacobian,
        ),
    )


def _langevin() -> Module:
    step, tau, kappa = (
        Argument(each.name, (each,)) for each in (sy.STEP, sy.RELAXATION, sy.TRAP_RATE)
    )

    def functions(
        prefix: str,
        arguments: tuple[Argument, ...],
        quantities: tuple[Quantity, ...],
        short: Mapping[sp.Symbol, sp.Expr],
        doubled: Mapping[sp.Symbol, sp.Expr],
        reduced: tuple[tuple[Quantity, sp.Expr], ...],
        weights: Mapping[str, sp.Expr],
    ) -> tuple[Function, ...]:
        names = tuple(each.name for each in quantities)
        block = Argument("block", quantities, (len(quantities),))
        return (
            Function(
                f"{prefix}_of_a_short_step",
                "Taylor's series: complete to rounding where h/tau and |kappa| h <= 1/64, and\n"
                "|kappa| h^2/tau <= 1/4096.",
                arguments,
                sp.Matrix([short[each.symbol] for each in quantities]),
                reduced,
                names,
            ),
            Function(
                f"{prefix}_of_twice_the_step",
                "From those of h those of 2 h.",
                (*arguments, block),
                sp.Matrix([doubled[each.symbol] for each in quantities]),
                (),
                tuple(f"{name}_twice" for name in names),
            ),
            Function(
                f"{prefix}_step",
                "What a step makes of its begin: see `derivation.langevin`.",
                (*arguments, block),
                sp.Matrix(list(weights.values())),
                (),
                tuple(weights),
            ),
        )

    inertial = (sy.DISPLACEMENT, sy.FIRST_INTEGRAL, sy.SECOND_INTEGRAL, sy.COVARIANCE_X,
                sy.COVARIANCE_V)  # fmt: skip
    return Module(
        "langevin",
        "Drag, spring and thermal noise (2.13-2.20) of one coordinate over a step, exactly.",
        "dx = v dt, dv = ((u - v)/tau - (kappa/tau) x) dt + sqrt(2 (kT/m)/tau) dW; without\n"
        "inertia dx = (u - kappa x) dt + sqrt(2 D) dW. d is the displacement by a unit of\n"
        "velocity, without inertia by a unit of u; j its integral, and l that of j.",
        (),
        (),
        (
            *functions(
                "inertial", (step, tau, kappa), inertial, lv.SHORT, lv.DOUBLED,
                ((sy.STEP_IN_TAU, lv.h / lv.tau), (sy.STEP_IN_SWINGS, lv.kappa * lv.h**2 / lv.tau)),
                lv.STEP_WEIGHTS,
            ),
            *functions(
                "overdamped", (step, kappa), inertial[:2], lv.SHORT_WITHOUT_INERTIA,
                lv.DOUBLED_WITHOUT_INERTIA, ((sy.STEP_IN_TRAP, lv.kappa * lv.h),),
                lv.STEP_WEIGHTS_WITHOUT_INERTIA,
            ),
        ),
        ("langevin.py",),
    )  # fmt: skip


def _hydrodynamics() -> Module:
    root = ((sy.ROOT_OF_FREQUENCY, hd.ROOT),)
    by_frequency = (sy.FREQUENCY, sy.DRAG, sy.VORTICITY_TIME)
    return Module(
        "hydrodynamics",
        "A sphere in a fluid with inertia, by angular frequency: s = i w.",
        "gamma is the drag in the unsteady Stokes flow; its imaginary part has the added mass.",
        (),
        (),
        (
            Function(
                "drag_of_translation",
                "gamma(i w) = beta_v (1 + x + x^2/9), x = sqrt(i w tau_f).",
                _scalars(by_frequency),
                hd.TRANSLATION_BY_FREQUENCY,
                root,
                ("real", "imaginary"),
            ),
            Function(
                "drag_of_rotation",
                "beta_w (3 + 3 x + x^2)/(3 (1 + x)), x = sqrt(i w tau_f).",
                _scalars((sy.FREQUENCY, sy.ROTATIONAL_DRAG, sy.VORTICITY_TIME)),
                hd.ROTATION_BY_FREQUENCY,
                root,
                ("real", "imaginary"),
            ),
            Function(
                "impedance",
                "Z(i w) = i w m + gamma(i w), the force by a unit of velocity.",
                _scalars((*by_frequency, sy.MASS)),
                hd.IMPEDANCE,
                root,
                ("real", "imaginary"),
            ),
            Function(
                "noise",
                "Two-sided spectrum of the force of the fluid's noise, 2 kT Re gamma, N^2/Hz.",
                _scalars((*by_frequency, sy.THERMAL_ENERGY)),
                sp.Matrix([hd.NOISE]),
                root,
                ("spectrum",),
            ),
            Function(
                "position",
                "One-sided spectrum of the position in a trap, m^2/Hz.",
                _scalars((*by_frequency, sy.MASS, sy.STIFFNESS, sy.THERMAL_ENERGY)),
                sp.Matrix([hd.SPECTRUM]),
                root,
                ("spectrum",),
            ),
        ),
        ("hydrodynamics.py",),
    )


def _parts(*names: tuple[Quantity, Quantity]) -> tuple[Argument, ...]:
    """Real and imaginary parts as arguments."""
    return tuple(argument for pair in names for argument in _scalars(pair))


#: amplitudes at (n, m) and its neighbours
_NEIGHBOURS = _parts(
    *(sy.DOWN_BEFORE, sy.DOWN, sy.DOWN_ABOVE),
    *(sy.BEFORE, sy.AMPLITUDE, sy.ABOVE),
    *(sy.UP_BEFORE, sy.UP, sy.UP_ABOVE),
    *(sy.PARTNER_DOWN, sy.PARTNER, sy.PARTNER_UP),
)
_ELEMENTS_UP = (sy.RAISED, sy.TURNED, sy.LOWERED)
#: elements of the direction s between them
_ELEMENTS = _scalars(
    (
        *(sy.ALONG, sy.ALONG_ABOVE, sy.WITHIN),
        *(sy.RAISED_DOWN, sy.TURNED_DOWN, sy.LOWERED_DOWN),
        *_ELEMENTS_UP,
    )
)
_WAVES_OPTIONS = 'cache=True, error_model="numpy", forceinline=True'


def _waves() -> Module:
    order = _scalars((sy.DEGREE, sy.ORDER))
    weights = _parts(sy.WEIGHT_ABOVE, sy.WEIGHT_BEFORE, sy.WEIGHT_WITHIN)
    jacobian = tuple(f"{i}{j}" for i in "xyz" for j in "xyz")
    return Module(
        "waves",
        "The force of focused light on a sphere, exactly: what is summed over harmonics (n, m).",
        "Amplitudes p_nm = 2 pi i^m P_nm about the bead's centre: of one component (light of\n"
        "helicity +1, its own partner) or of two (electric and magnetic, each the other's\n"
        "partner). The elements are those of helicity +1. Sums over n, m and components are\n"
        "forces and gradients over k r in units of 4 pi^2 n_m/c, moments in those of\n"
        "4 pi^2/omega. In a name, before and above are n-1 and n+1, down and up m-1 and m+1.",
        (),
        (),
        (
            Function(
                "squared_elements",
                "Elements of the direction s between harmonics: the squares of <n m|s_z|n-1 m>,\n"
                "<n+1 m+1|s_+|n m> (itself negative), <n m+1|s_+|n m> and <n-1 m+1|s_+|n m>, and\n"
                "within = <n m|s_z|n m> itself.",
                order,
                waves.SQUARED_ELEMENTS,
                output_names=("along", "within", "raised", "turned", "lowered"),
            ),
            Function(
                "electric_across",
                "z f'/f - (n+1) of electric waves outside of a surface, from that inside; that of\n"
                "magnetic waves is continuous.",
                _scalars((sy.FIELD_DERIVATIVE, sy.INNER_INDEX, sy.RELATIVE_INDEX, sy.DEGREE)),
                sp.Matrix([waves.electric_across]),
                output_names=("g_out",),
            ),
            Function(
                "layer",
                "z f'/f - (n+1) at the outer surface of a layer, from that at its inner surface.",
                _scalars((sy.FIELD_DERIVATIVE, *sy.LAYER_DERIVATIVES, sy.LAYER_RATIO)),
                sp.Matrix([waves.layer]),
                output_names=("g_out",),
            ),
            Function(
                "reflected",
                "P and Q of the Mie coefficient P/(P - iQ), from g just outside of the bead.",
                _scalars((sy.FIELD_DERIVATIVE, *sy.OUTER_DERIVATIVES, sy.OUTER_RATIO)),
                waves.reflected,
                output_names=("P", "Q"),
            ),
            Function(
                "force_summand",
                "What (n, m) of one component adds to the force; each pair of neighbours once.",
                (
                    *_parts(sy.AMPLITUDE, sy.ABOVE, sy.PARTNER),
                    *_parts(sy.UP_BEFORE, sy.UP, sy.UP_ABOVE),
                    *weights,
                    *_scalars((sy.ALONG_ABOVE, sy.WITHIN, *_ELEMENTS_UP)),
                ),
                waves.FORCE,
                waves.FORCE_PARTS,
                ("x", "y", "z"),
            ),
            Function(
                "force_and_gradient_summand",
                "What (n, m) of one component adds to the force and to dF_i/d(k r_j), row by row.\n"
                "Both neighbours of each pair count, so that the summands of the force are not\n"
                "those of `force_summand`; the sums are.",
                (*_NEIGHBOURS, *weights, *_ELEMENTS),
                waves.FORCE_AND_GRADIENT,
                waves.GRADIENT_PARTS,
                ("x", "y", "z", *jacobian),
            ),
            Function(
                "moment_summand",
                "What (n, m) of one component adds to the moment and to the absorbed power.",
                (*_parts(sy.AMPLITUDE, sy.UP), *_scalars((sy.WEIGHT_OF_TURN, sy.ORDER, sy.LIFT))),
                waves.MOMENT,
                output_names=("x", "y", "z", "absorbed"),
            ),
            Function(
                "moment_gradient_summand",
                "What (n, m) of one component adds to dM_i/d(k r_j), row by row.",
                (
                    *_NEIGHBOURS,
                    *_scalars((sy.WEIGHT_OF_TURN, sy.ORDER, sy.LIFT_DOWN, sy.LIFT)),
                    *_ELEMENTS,
                ),
                waves.MOMENT_GRADIENT,
                waves.MOMENT_GRADIENT_PARTS,
                jacobian,
            ),
            Function(
                "cover_amplitudes",
                "Amplitudes behind a plane face over those before it, as square roots of power\n"
                "per solid angle: field in the plane of incidence, and across it.",
                _scalars(
                    (
                        sy.COSINE_BEFORE_FACE,
                        sy.COSINE_BEHIND_FACE,
                        sy.INDEX_BEFORE_FACE,
                        sy.INDEX_BEHIND_FACE,
                    )
                ),
                waves.COVER_AMPLITUDES,
                output_names=("p", "s"),
            ),
            Function(
                "reflect",
                "Amplitudes that a plane face reflects over those that meet it: field in the\n"
                "plane of incidence, and across it. Cosine and index behind the face may be\n"
                "complex.",
                _scalars(
                    (
                        sy.COSINE_BEFORE_FACE,
                        sy.COSINE_BEHIND_FACE,
                        sy.INDEX_BEFORE_FACE,
                        sy.INDEX_BEHIND_FACE,
                    )
                ),
                waves.REFLECTED_BY_SNELL,
                output_names=("p", "s"),
            ),
        ),
        ("waves.py",),
        _WAVES_OPTIONS,
    )


def _spline() -> Module:
    return Module(
        "spline",
        "Uniform splines of degree 7.",
        "Between two knots, at 0 and 1, eight coefficients count. Their weights at t are sums of\n"
        "powers of t.",
        (),
        (),
        (
            Function(
                "spline_weights",
                "Coefficients of the weights: row k those of t^k, from the lowest knot up.",
                (),
                spline.SPLINE_WEIGHTS,
            ),
        ),
        ("spline.py",),
        jit_options=None,
    )


def _bodies() -> Module:
    turning = _scalars((sy.ORDER, sy.LIFT_DOWN, sy.LIFT))
    return Module(
        "bodies",
        "The force and torque of light on a body of any shape: what is summed over (n, m).",
        "The light before and after the body has the amplitudes p and q = S p, about the body's\n"
        "origin and in its frame; t = q - p and v = p + q. They have two components, electric and\n"
        "magnetic, each the other's partner. The elements are those of helicity +1. Sums over n,\n"
        "m and components are forces in units of n_m/c and torques in those of 1/omega, if |p|^2\n"
        "is a power. If t ends at the degree N, v is needed to N+1. In a name, before and above\n"
        "are n-1 and n+1, down and up m-1 and m+1.",
        (),
        (),
        (
            Function(
                "force_summand",
                "What (n, m) of one component adds to the force, -Re(t* s_i v).",
                (*_parts(sy.CHANGE), *_NEIGHBOURS, *_ELEMENTS),
                bodies.FORCE,
                bodies.FORCE_PARTS,
                ("x", "y", "z"),
            ),
            Function(
                "torque_summand",
                "What (n, m) of one component adds to the torque, -Re(t* J_i v), and to the\n"
                "absorbed power, -Re(t* v).",
                (*_parts(sy.CHANGE, sy.DOWN, sy.AMPLITUDE, sy.UP), *turning),
                bodies.TORQUE,
                bodies.TORQUE_PARTS,
                ("x", "y", "z", "absorbed"),
            ),
            Function(
                "generators",
                "s_x, s_y, s_z, J_x, J_y and J_z on amplitudes, at (n, m).",
                (*_NEIGHBOURS, *turning, *_ELEMENTS),
                bodies.parts(bodies.GENERATORS),
                bodies.GENERATORS_PARTS,
                tuple(
                    f"{operator}_{i}_{part}"
                    for operator in "sJ"
                    for i in "xyz"
                    for part in ("re", "im")
                ),
            ),
            Function(
                "derivative_summand",
                "What (n, m) of one component adds to the derivatives of one component of force\n"
                "(A = s_i) or torque (A = J_i) over k r_j and over the angles about the body's\n"
                "axes j. Force and torque are in the body's axes, which turn with it. If t ends\n"
                "at N, the sum goes to N+1.",
                _parts(sy.RETURNED, *sy.GENERATED),
                bodies.DERIVATIVE,
                bodies.DERIVATIVE_PARTS,
                ("x", "y", "z", "about_x", "about_y", "about_z"),
            ),
        ),
        ("bodies.py", "waves.py"),
        _WAVES_OPTIONS,
    )


def _water() -> Module:
    return Module(
        "water",
        "Liquid water at one atmosphere: density, viscosity and refractive index.",
        "IAPWS SR6-08(2011) for density and viscosity, R9-97 for the refractive index.",
        (),
        (),
        (
            Function(
                "density",
                "Density at one atmosphere, kg/m^3.",
                _scalars((sy.TEMPERATURE,)),
                sp.Matrix([water.density]),
                output_names=("rho",),
            ),
            Function(
                "viscosity",
                "Viscosity, Pa s.",
                _scalars((sy.TEMPERATURE,)),
                sp.Matrix([water.viscosity]),
                ((sy.LOG_TEMPERATURE, water.LOG_TEMPERATURE),),
                ("mu_m",),
            ),
            Function(
                "refractive_index",
                "Refractive index at a density and a wavelength in vacuum.",
                _scalars((sy.DENSITY, sy.TEMPERATURE, sy.WAVELENGTH)),
                sp.Matrix([water.refractive_index]),
                ((sy.LORENTZ_LORENZ, water.LORENTZ_LORENZ),),
                ("n",),
            ),
        ),
        ("water.py",),
        jit_options=None,
    )


def _media() -> Module:
    temperature, of_water = sy.TEMPERATURE, (sy.WATER_DENSITY, sy.WATER_VISCOSITY)

    def mixture(
        name: str,
        summary: str,
        part: Quantity,
        density: sp.Expr,
        viscosity: sp.Expr,
        intermediates: Named = (),
    ) -> Function:
        """Density and viscosity of a mixture from those of water at its temperature."""
        return Function(
            name,
            summary,
            _scalars((temperature, part, *of_water)),
            sp.Matrix([density, viscosity]),
            intermediates,
            ("rho", "mu_m"),
        )

    return Module(
        "media",
        "Mixtures with water, gases, and the drag in a gas.",
        "Cheng (2008) and Volk and Kaehler (2018) for glycerol, Kestin (1981) for salt water, "
        "Lemmon\nand Jacobsen (2004) for gases, Beresnev, Chernyak and Fomyagin (1990) for the "
        "drag.",
        (),
        (),
        (
            mixture(
                "glycerol",
                "Density and viscosity of glycerol in water.",
                sy.MASS_FRACTION,
                media.GLYCEROL_DENSITY,
                media.GLYCEROL_VISCOSITY,
                (
                    (sy.LOG_FRACTION, media.LOG_FRACTION),
                    (sy.LOG_SINE, media.LOG_SINE),
                ),
            ),
            mixture(
                "salt_water",
                "Density and viscosity of sodium chloride in water.",
                sy.MOLALITY,
                media.SALT_DENSITY,
                media.SALT_VISCOSITY,
            ),
            mixture(
                "sucrose",
                "Density and viscosity of sucrose in water.",
                sy.MASS_FRACTION,
                media.SUCROSE_DENSITY,
                media.SUCROSE_VISCOSITY,
            ),
            Function(
                "refractive_index",
                "Refractive index of a mixture; without water, w = 1 and n_w = rho_w = 1.",
                _scalars(
                    (sy.DENSITY, sy.MASS_FRACTION, sy.REFRACTION, sy.WATER_DENSITY, sy.WATER_INDEX)
                ),
                sp.Matrix([water.refractive_index]),
                ((sy.LORENTZ_LORENZ, media.LORENTZ_LORENZ),),
                ("n",),
            ),
            Function(
                "gas_viscosity",
                "Viscosity of a dilute gas.",
                _scalars((temperature, sy.MOLAR_MASS, sy.COLLISION_DIAMETER, sy.WELL_DEPTH)),
                sp.Matrix([media.gas_viscosity]),
                ((sy.LOG_REDUCED, media.LOG_REDUCED),),
                ("mu_m",),
            ),
            Function(
                "power_viscosity",
                "Viscosity of helium.",
                _scalars((temperature, *sy.HELIUM)),
                sp.Matrix([media.power_viscosity]),
                ((sy.LOG_TEMPERATURE, water.LOG_TEMPERATURE),),
                ("mu_m",),
            ),
            Function(
                "gas",
                "Density of an ideal gas, and its mean free path.",
                _scalars((temperature, sy.PRESSURE, sy.MOLAR_MASS, sy.VISCOSITY)),
                sp.Matrix([media.gas_density, media.mean_free_path]),
                output_names=("rho", "mean_free_path"),
            ),
            Function(
                "drag_factors",
                "Drag and rotational drag of a sphere in a gas, over Stokes's.",
                _scalars((sy.KNUDSEN, sy.ACCOMMODATION)),
                sp.Matrix([media.drag_factor, media.rotational_factor]),
                output_names=("translation", "rotation"),
            ),
        ),
        ("media.py",),
        jit_options=None,
    )


def _heat() -> Module:
    return Module(
        "heat",
        "Heating by the laser, and the motion of a hot bead.",
        "Peterman, Gittes and Schmidt (2003) for water, Rings et al. (2010) for hot Brownian "
        "motion,\nIAPWS SR6-08(2011) for the conductivity.",
        (),
        (),
        (
            Function(
                "conductivity",
                "Thermal conductivity of liquid water.",
                _scalars((sy.TEMPERATURE,)),
                sp.Matrix([heat.conductivity]),
                ((sy.LOG_TEMPERATURE, water.LOG_TEMPERATURE),),
                ("conductivity",),
            ),
            Function(
                "water_rise",
                "Temperature rise of a fluid at the focus, beside a plane that conducts heat.",
                _scalars(
                    (
                        sy.LIGHT_POWER,
                        sy.ABSORPTION,
                        sy.CONDUCTIVITY,
                        sy.WAVELENGTH,
                        sy.SINK_DISTANCE,
                    )
                ),
                sp.Matrix([heat.water_rise]),
                output_names=("rise",),
            ),
            Function(
                "bead_rise",
                "Temperature rise of a sphere that absorbs light, far from walls.",
                _scalars((sy.LIGHT_POWER, sy.CONDUCTIVITY, sy.RADIUS)),
                sp.Matrix([heat.bead_rise]),
                output_names=("rise",),
            ),
            Function(
                "dissipation",
                "Dissipation of two flows about a sphere, per viscosity, 6 pi r and du.",
                _scalars((sy.NEARNESS, *sy.FLOW_SLOPES, *sy.FLOW_CURVATURES)),
                sp.Matrix([heat.dissipation]),
                output_names=("dissipation",),
            ),
            Function(
                "hot_in_gas",
                "Drag over that of a bead as warm as the gas, and temperature of its motion.",
                _scalars((sy.ACCOMMODATION, sy.TEMPERATURE, sy.SURFACE_TEMPERATURE)),
                sp.Matrix([heat.hot_drag, heat.hot_temperature]),
                output_names=("drag", "temperature"),
            ),
        ),
        ("heat.py",),
        jit_options=None,
    )


def _chains() -> Module:
    def function(
        name: str,
        summary: str,
        arguments: tuple[Quantity, ...],
        outputs: sp.MatrixBase,
        names: tuple[str, str] = ("extension", "slope"),
    ) -> Function:
        return Function(name, summary, _scalars(arguments), outputs, output_names=names)

    return Module(
        "chains",
        "Force and extension of a polymer between two points.",
        "Extension is over the contour length, force is F Lp/kT. They also accept arrays.",
        (),
        (),
        (
            function(
                "marko_siggia",
                "Force on a worm-like chain by Marko and Siggia, and its derivative over l.",
                (sy.SCALED_EXTENSION,),
                chains.MARKO_SIGGIA,
                ("force", "slope"),
            ),
            function(
                "bouchiat",
                "Force on a worm-like chain by Bouchiat, and its derivative over l.",
                (sy.SCALED_EXTENSION,),
                chains.BOUCHIAT,
                ("force", "slope"),
            ),
            function(
                "odijk",
                "Extension of a stiff chain that stretches, and its derivative over y.",
                (sy.ROOT_FORCE, sy.COMPLIANCE),
                chains.ODIJK,
            ),
            function(
                "twistable",
                "Extension of a stiff chain that stretches and twists, and its derivative over y.",
                (sy.ROOT_FORCE, sy.COMPLIANCE, *sy.TWIST_COUPLING),
                chains.TWISTABLE,
            ),
            function(
                "langevin",
                "Extension of freely jointed segments, and its derivative over u.",
                (sy.LANGEVIN_ARGUMENT, sy.LANGEVIN_DECAY),
                chains.LANGEVIN,
            ),
            function(
                "langevin_series",
                f"The same for u below {chains.SMALL}, by {chains.TERMS} terms of a series.",
                (sy.LANGEVIN_ARGUMENT,),
                chains.LANGEVIN_SERIES,
            ),
        ),
        ("chains.py",),
        jit_options=None,
    )


@functools.cache
def catalogue() -> tuple[Module, ...]:
    """Every module of `generated/`, derived once in a program."""
    return (
        *_inertial_models(scaling=False),
        *_inertial_models(scaling=True),
        *_overdamped_models(),
        *_first_order_models(),
        *_body_models(),
        _body_motion(),
        _kinematics(),
        _langevin(),
        _hydrodynamics(),
        _ray(),
        _waves(),
        _bodies(),
        _spline(),
        _water(),
        _media(),
        _heat(),
        _chains(),
    )
