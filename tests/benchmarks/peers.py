"""Other solvers, with the same compiled force called at its own cost: by address.

The right-hand side and its Jacobian are compiled functions of pointers. They call the kernel of
the force, and the emitted rates, by their addresses, in memory that is laid out once: no Python
object is made. SciPy and CVODE reach them by a thin Python function, JAX by a custom call.
"""

from __future__ import annotations

import ctypes
import functools
import importlib.util
import os
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numba import carray, cfunc, types
from numba.extending import intrinsic
from numpy.typing import NDArray
from scipy import integrate

from tweezer.compiled import address, cached_njit, call, named_njit
from tweezer.dynamics.integrators.system import RATES
from tweezer.dynamics.models import EquationsOfMotion
from tweezer.dynamics.solution import BEFORE
from tweezer.forces.data import COLUMNS, Data
from tweezer.forces.force import Pose, Wrench, bound, clear

Array = NDArray[np.float64]

_vector, _matrix = types.float64[::1], types.float64[:, ::1]
_inputs = (types.float64, _vector, _vector)
#: The emitted Jacobians, of a bead that only moves and of one that turns
_JACOBIANS = {
    2: types.void(*_inputs, _vector, _matrix, _matrix, _vector, _matrix),
    3: types.void(*_inputs, _vector, _vector, _matrix, _matrix, _matrix, _vector, _matrix),
}
#: Where each of the arrays begins in the memory of a right-hand side, and the length of that
_TIME, _PLACE, _FORCE, _MOMENT, _FORCE_GRADIENT, _MOMENT_GRADIENT, _ERROR = 0, 1, 4, 7, 10, 19, 28
_MOBILITY, _MOBILITY_GRADIENT, _LENGTH = 29, 34, 49


@intrinsic
def _numbers_at(typing: Any, at: Any) -> Any:
    """Pointer to the numbers at an address."""
    kind = types.CPointer(types.float64)

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.inttoptr(values[0], context.get_value_type(kind))

    return kind(types.int64), emitted


@intrinsic
def _integers_at(typing: Any, at: Any) -> Any:
    """Pointer to the integers at an address."""
    kind = types.CPointer(types.int64)

    def emitted(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return builder.inttoptr(values[0], context.get_value_type(kind))

    return kind(types.int64), emitted


@named_njit(inner=True, error_model="numpy")
def _act(about, kernel, many, t, y):  # type: ignore[no-untyped-def]
    """Force, moment and, of `many` = 1, their gradients at a state."""
    data = Data(
        carray(_numbers_at(about[2]), (about[3],)),
        carray(_integers_at(about[4]), (about[5], COLUMNS)),
    )
    memory = _numbers_at(about[0])
    work = carray(memory, (_LENGTH,))
    pose = Pose(
        work[_TIME : _TIME + 1],
        work[_PLACE : _PLACE + 3].reshape((1, 3)),
        carray(memory, (0, 4)),
        carray(memory, (0, 3)),
    )
    wrench = Wrench(
        work[_FORCE : _FORCE + 3].reshape((1, 3)), work[_MOMENT : _MOMENT + 3].reshape((1, 3)),
        work[_FORCE_GRADIENT : _FORCE_GRADIENT + 9 * many].reshape((many, 3, 3)),
        work[_MOMENT_GRADIENT : _MOMENT_GRADIENT + 9 * many].reshape((many, 3, 3)),
        work[_ERROR : _ERROR + 1],
    )  # fmt: skip
    work[_TIME] = t
    for i in range(3):
        work[_PLACE + i] = y[i]
    clear(wrench)
    call(kernel, (pose, data, wrench))
    return work


@cached_njit(error_model="numpy")
def rates(about, t, y, out):  # type: ignore[no-untyped-def]
    """Fill out (state,) with the rate of change of y; about: `Direct.about`."""
    work = _act(about, about[1], 0, t, y)
    params = carray(_numbers_at(about[8]), (about[9],))
    none = work[_FORCE_GRADIENT : _FORCE_GRADIENT + 9].reshape((3, 3))
    call(
        about[6],
        (t, y, work[_FORCE : _FORCE + 3], work[_MOMENT : _MOMENT + 3], none, none,
         work[_MOBILITY : _MOBILITY + 5], params, out),
    )  # fmt: skip


@cached_njit(error_model="numpy")
def jacobian(about, t, y, out):  # type: ignore[no-untyped-def]
    """Fill out (state, state) with the derivative of the rates."""
    work = _act(about, about[10], 1, t, y)
    params = carray(_numbers_at(about[8]), (about[9],))
    force, moment = work[_FORCE : _FORCE + 3], work[_MOMENT : _MOMENT + 3]
    by_place = work[_FORCE_GRADIENT : _FORCE_GRADIENT + 9].reshape((3, 3))
    of_moment = work[_MOMENT_GRADIENT : _MOMENT_GRADIENT + 9].reshape((3, 3))
    mobility = work[_MOBILITY : _MOBILITY + 5]
    uniform = work[_MOBILITY_GRADIENT : _MOBILITY_GRADIENT + 15].reshape((5, 3))
    if about[11] == 0:
        call(about[7], (t, y, force, mobility, by_place, uniform, params, out))
    else:
        call(about[7], (t, y, force, moment, mobility, by_place, of_moment, uniform, params, out))


class Direct:
    """The right-hand side of equations of motion, compiled, for a force and drag of no direction.

    `rates` and `jacobian` are what solvers take that give a time and a state; the same with `fill`
    are those of solvers that bring the memory. `calls` counts calls of the force.
    """

    def __init__(self, equations: EquationsOfMotion) -> None:
        self.calls = 0
        module, self._size = equations.module, len(equations.module.STATE)
        plain, gradient = (bound(equations.force, gradient=which) for which in (False, True))
        memory = np.zeros(_LENGTH)
        mobility = equations.drag.mobilities(np.zeros((1, 3)), gradient=True)
        memory[_MOBILITY:_MOBILITY_GRADIENT] = mobility.value[0]
        memory[_MOBILITY_GRADIENT:] = mobility.gradient[0].ravel()
        numbers, shapes = plain.data
        turns = "moment" in module.JACOBIAN_INPUTS
        # pointers are held by this object
        self._held = memory, numbers, shapes, equations.params, gradient
        self.about = np.array(
            [
                memory.ctypes.data, plain.kernel, numbers.ctypes.data, len(numbers),
                shapes.ctypes.data, len(shapes), address(module.rates, RATES),
                address(module.jacobian, _JACOBIANS[3 if turns else 2]),
                equations.params.ctypes.data, len(equations.params), gradient.kernel, int(turns),
            ]
        )  # fmt: skip

    def rates(self, t: float, y: Array) -> Array:
        """Rate of change of the state y."""
        self.calls += 1
        out = np.empty(self._size)
        rates(self.about, t, y, out)
        return out

    def jacobian(self, t: float, y: Array) -> Array:
        """Its derivative."""
        self.calls += 1
        out = np.empty((self._size, self._size))
        jacobian(self.about, t, y, out)
        return out

    def fill_rates(self, t: float, y: Array, out: Array) -> None:
        """As `rates`, into `out`."""
        self.calls += 1
        rates(self.about, t, y, out)

    def fill_jacobian(self, t: float, y: Array, _: Array, out: Array) -> None:
        """As `jacobian`, into `out`."""
        self.calls += 1
        jacobian(self.about, t, y, out)


#: Largest number of steps of a solver
_MOST_STEPS = 1_000_000
#: Modules of the peers that may be missing; what has no wheel to install cannot be met
_MODULES = {"CVODE": "sksundae", "diffrax": "diffrax", "heyoka": "heyoka"}
_NO_WHEEL = {"numbalsoda": "has no wheel"}


@functools.cache
def missing() -> dict[str, str]:
    """Peers that cannot be met, and why."""
    absent = (name for name, module in _MODULES.items() if not importlib.util.find_spec(module))
    return dict.fromkeys(absent, "not installed") | _NO_WHEEL


def states(method: str, direct: Direct, equations: EquationsOfMotion, times: Array) -> Array:
    """(n, state) at `times`, ascending from 0, by the tolerances of the equations."""
    y, found = equations.initial_state, []
    for begin, end, within in _smooth_parts(equations, times):
        solve = _SOLVERS[method](direct, equations)
        output = solve(y, np.unique([begin, *within, end]))
        found.append(output[1 if begin not in within else 0 :][: len(within)])
        y = output[-1]
    return np.concatenate(found)


def seconds(method: str, direct: Direct, equations: EquationsOfMotion, ends: Array) -> float:
    """Time of the steps from ends[0] to ends[1]."""
    y, took = equations.initial_state, 0.0
    for begin, end, _ in _smooth_parts(equations, ends):
        solve = _SOLVERS[method](direct, equations)
        began = time.perf_counter()
        y = solve(y, np.array([begin, end]))[-1]
        took += time.perf_counter() - began
    return took


def _smooth_parts(
    equations: EquationsOfMotion, times: Array
) -> Iterator[tuple[float, float, Array]]:
    """Begin, end and times of the parts in each of which the force is smooth in time."""
    last = float(times[-1])
    begins = [0.0, *equations.force.kinks(last).tolist()]
    for begin, end in zip(begins, [*begins[1:], np.inf], strict=True):
        within = times[(times >= begin) & (times < end)]
        yield begin, min(end * BEFORE, last), within[within <= end * BEFORE]


def _scipys(method: str, direct: Direct, equations: EquationsOfMotion) -> Any:
    """A solver of `scipy.integrate`, step by step."""
    options: dict[str, Any] = {
        "rtol": equations.scene.simulation.relative_tolerance,
        "atol": equations.absolute_tolerance,
    }
    if method != "DOP853":
        options["jac"] = direct.jacobian

    def solve(y: Array, times: Array) -> Array:
        if len(times) > 2:
            run = integrate.solve_ivp(
                direct.rates, times[[0, -1]], y, method, t_eval=times, **options
            )
            return np.asarray(run.y.T)
        solver = getattr(integrate, method)(direct.rates, times[0], y, times[1], **options)
        while solver.status == "running":
            solver.step()
        return np.array([y, solver.y])

    return solve


def _odeint(direct: Direct, equations: EquationsOfMotion) -> Any:
    """LSODA with its steps in C."""

    def solve(y: Array, times: Array) -> Array:
        return np.asarray(
            integrate.odeint(
                direct.rates, y, times, Dfun=direct.jacobian, tfirst=True, mxstep=_MOST_STEPS,
                rtol=equations.scene.simulation.relative_tolerance,
                atol=equations.absolute_tolerance,
            )
        )  # fmt: skip

    return solve


def _cvode_solver(direct: Direct, equations: EquationsOfMotion, **options: Any) -> Any:
    """CVODE of SUNDIALS, by backward differentiation."""
    from sksundae.cvode import CVODE

    return CVODE(
        direct.fill_rates, jacfn=direct.fill_jacobian, max_num_steps=_MOST_STEPS,
        rtol=equations.scene.simulation.relative_tolerance, atol=equations.absolute_tolerance,
        **options,
    )  # fmt: skip


def _cvode(direct: Direct, equations: EquationsOfMotion) -> Any:
    solver = _cvode_solver(direct, equations)

    def solve(y: Array, times: Array) -> Array:
        if len(times) > 2:
            return np.asarray(solver.solve(times, y).y)
        solver.init_step(times[0], y)
        return np.array([y, solver.step(times[1]).y])

    return solve


def _capsule(function: Any) -> Any:
    """A compiled function as JAX takes its address."""
    make = ctypes.pythonapi.PyCapsule_New
    make.restype = ctypes.py_object
    make.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
    return make(function.address, b"xla._CUSTOM_CALL_TARGET", None)


@functools.cache
def _custom_calls(size: int) -> tuple[Any, Any]:
    """The right-hand side as a function of JAX, of a state of that size; what it holds on to."""
    import jax

    # JAX gives addresses: of the result, and of those of the time, the state and `about`
    typed = types.void(types.CPointer(types.float64), types.CPointer(types.int64))

    @cfunc(typed)
    def by_rates(out, at):  # type: ignore[no-untyped-def]
        t, y = carray(_numbers_at(at[0]), (1,)), carray(_numbers_at(at[1]), (size,))
        rates(carray(_integers_at(at[2]), (12,)), t[0], y, carray(out, (size,)))

    @cfunc(typed)
    def by_jacobian(out, at):  # type: ignore[no-untyped-def]
        t, y = carray(_numbers_at(at[0]), (1,)), carray(_numbers_at(at[1]), (size,))
        jacobian(carray(_integers_at(at[2]), (12,)), t[0], y, carray(out, (size, size)))

    calls, held = [], (by_rates, by_jacobian)
    for name, function, shape in (
        ("rates", by_rates, (size,)), ("jacobian", by_jacobian, (size, size))
    ):  # fmt: skip
        target = f"tweezer_{name}_{size}"
        jax.ffi.register_ffi_target(target, _capsule(function), platform="cpu", api_version=0)
        result = jax.ShapeDtypeStruct(shape, np.float64)
        calls.append(
            jax.ffi.ffi_call(target, result, custom_call_api_version=1, vmap_method="sequential")
        )
    field = jax.custom_jvp(calls[0])
    field.defjvp(lambda at, moved: (field(*at), calls[1](*at) @ moved[1]))
    return field, held


@functools.cache
def _jitted(size: int) -> Any:
    """Kvaerno5 of diffrax, compiled: of a state, `about`, times and tolerances."""
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")  # a line for each custom call
    import diffrax
    import jax

    jax.config.update("jax_enable_x64", True)
    field, _ = _custom_calls(size)

    def solve(y, about, times, relative, absolute):  # type: ignore[no-untyped-def]
        return diffrax.diffeqsolve(
            diffrax.ODETerm(field), diffrax.Kvaerno5(), times[0], times[-1], None, y, args=about,
            stepsize_controller=diffrax.PIDController(rtol=relative, atol=absolute),
            saveat=diffrax.SaveAt(ts=times), max_steps=_MOST_STEPS,
        ).ys  # fmt: skip

    return jax.jit(solve)


def _diffrax(direct: Direct, equations: EquationsOfMotion) -> Any:
    """An implicit Runge-Kutta method of order 5, in JAX."""
    run = _jitted(len(equations.initial_state))
    tolerances = equations.scene.simulation.relative_tolerance, equations.absolute_tolerance

    def solve(y: Array, times: Array) -> Array:
        return np.asarray(run(y, direct.about, times, *tolerances))

    return solve


def entry(
    method: str, direct: Direct, equations: EquationsOfMotion, end: float, edge: float
) -> float:
    """Time at which the bead comes within a distance of the focus, s, by the solver's events."""
    y = equations.initial_state
    if method == "CVODE":

        def beyond(_: float, y: Array, events: Array) -> None:
            events[0] = y[0] ** 2 + y[1] ** 2 + y[2] ** 2 - edge**2

        beyond.terminal, beyond.direction = [False], [-1]  # type: ignore[attr-defined]
        solver = _cvode_solver(direct, equations, eventsfn=beyond, num_events=1)
        return float(solver.solve(np.array([0.0, end]), y).t_events[0])

    def distance(_: float, y: Array) -> float:
        return float(y[0] ** 2 + y[1] ** 2 + y[2] ** 2 - edge**2)

    distance.direction = -1  # type: ignore[attr-defined]
    run = integrate.solve_ivp(
        direct.rates, (0.0, end), y, method, events=distance, jac=direct.jacobian,
        rtol=equations.scene.simulation.relative_tolerance, atol=equations.absolute_tolerance,
    )  # fmt: skip
    return float(run.t_events[0][0])


_SOLVERS: dict[str, Any] = {
    "LSODA": functools.partial(_scipys, "LSODA"),
    "Radau": functools.partial(_scipys, "Radau"),
    "odeint": _odeint,
    "CVODE": _cvode,
    "diffrax": _diffrax,
}
