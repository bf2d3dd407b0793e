"""Quantities that follow from a trajectory: forces, speeds, Reynolds number, energies."""

from __future__ import annotations

import numpy as np
import xarray as xr

from tweezer.dynamics import Problem


def derived_quantities(problem: Problem, run: xr.Dataset) -> xr.Dataset:
    """Derived variables over the `time` of `run`, which holds position and perhaps velocity.

    * optical_force: force of the light (3.26), N
    * force_error: its error as estimated, or certified by the map, or for the thesis's grid the
      distance to the quadrature, N
    * net_force: all forces but drag, the thesis's net motion force Gamma_others (4.2), N
    * speed; terminal_speed: |net_force|/beta_v (5.2), with the drag at the place, m/s
    * reynolds_number: 2 rho_m v r/mu_m (5.1)
    * distance: from the focus, m
    * kinetic_energy: of translation and, with a rotation, of rotation, J
    * potential_energy: of gravity and buoyancy, zero at the focus, J
    * total_energy: their sum, J. The force of the light has no potential.

    Without a velocity there is no speed, Reynolds number, kinetic and total energy.
    """
    scene, bead = problem.scene, problem.bead
    weight = xr.DataArray(np.array(bead.weight), dims="axis")
    position = run["position"]
    places = np.ascontiguousarray(position.values)
    times = run["time"].values
    bound = problem.light
    field = bound.field(places, time=times)
    optical_force = position.copy(data=field.force)
    force_error = position.isel(axis=0, drop=True).copy(data=bound.error_of(places, field, times))
    net_force = optical_force + weight
    orientations = run["orientation"].values if "orientation" in run else None
    for each in problem.others:
        pushed = each.field(places, time=times, orientations=orientations)
        net_force = net_force + position.copy(data=pushed.force)
    terminal = net_force * problem.mobilities(places, times)[:, :3]
    potential = -(weight * position).sum("axis")
    quantities = {
        "optical_force": (optical_force, "N", "force of the light"),
        "force_error": (force_error, "N", "error of the force of the light"),
        "net_force": (net_force, "N", "net motion force, all forces but drag"),
        "terminal_speed": (_length(terminal), "m/s", "terminal speed"),
        "distance": (_length(position), "m", "distance to the focus"),
        "potential_energy": (potential, "J", "energy of gravity and buoyancy, zero at the focus"),
    }
    if "velocity" in run:
        speed = _length(run["velocity"])
        kinetic = 0.5 * bead.mass * speed**2
        if "angular_velocity" in run:
            moments = xr.DataArray(np.array(bead.moments_of_inertia), dims="body_axis")
            kinetic = kinetic + 0.5 * (moments * run["angular_velocity"] ** 2).sum("body_axis")
        medium, r = scene.medium, scene.bead.radius
        quantities |= {
            "speed": (speed, "m/s", "speed"),
            "reynolds_number": (
                2 * medium.density * r / medium.viscosity * speed, "1", "Reynolds number",
            ),
            "kinetic_energy": (kinetic, "J", "kinetic energy"),
            "total_energy": (
                kinetic + potential, "J", "energy of motion and weight, without the light",
            ),
        }  # fmt: skip
    return xr.Dataset(
        {
            name: values.drop_attrs().assign_attrs(units=units, long_name=long_name)
            for name, (values, units, long_name) in quantities.items()
        }
    )


def _length(vectors: xr.DataArray) -> xr.DataArray:
    return (vectors**2).sum("axis") ** 0.5
