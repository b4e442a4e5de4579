"""The response of a variant of the model: periodic motion, balances and Floquet multipliers in one record."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from floquet import PeriodicSystem, monodromy
from lumped import GearPair, MeshCycle, PathFunction, mesh_cycle, periodic_system, simulate
from lumped.model.results import dataset
from lumped.model.steady import periodic_solution, sample_times
from lumped.quasi_static.elements import MeshElements
from lumped.typing import FloatArray

_MICRO = 1e6


@dataclass(frozen=True, eq=False)
class Response:
    """Periodic motion of one variant of the equations.

    Attributes
    ----------
    cycle : results over one mesh cycle, as ``lumped.steady_state``
    efficiency : T_g Omega_g/(T_p Omega_p) with the brake torque that holds the mean speed
    brake_torque : that torque [N m]
    created_power : mean power that the tooth forces bring into the bodies beyond what the contact gives, over
        the driving power: 0 for forces that obey Newton's third law at the contact point
    third_law_x, third_law_y : largest sum of the tooth forces on both bodies [N]
    radius : spectral radius of one mesh cycle in the 10-state relative form
    multipliers : (10,) Floquet multipliers, largest modulus first
    """

    cycle: xr.Dataset
    efficiency: float
    brake_torque: float
    created_power: float
    third_law_x: float
    third_law_y: float
    radius: float
    multipliers: NDArray[np.complex128]

    def peak_to_peak(self, name: str) -> float:
        """Peak to peak of a variable [um]."""
        return float(np.ptp(self.cycle[name].to_numpy())) * _MICRO

    def mean(self, name: str) -> float:
        """Mean of a variable [um]."""
        return float(self.cycle[name].mean()) * _MICRO


def response(
    pair: GearPair,
    *,
    as_printed: Collection[int] = (),
    friction: PathFunction | None = None,
    samples_per_cycle: int = 512,
) -> Response:
    """Solve one variant of the equations.

    Parameters
    ----------
    pair : a validated gear pair
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used
    friction : signed mu(xi) instead of the pair's own, e.g. a law as printed
    samples_per_cycle : output times

    Raises
    ------
    NumericalError : the variant has no periodic motion
    """
    cycle = mesh_cycle(pair)
    if friction is not None:
        e = cycle.elements
        cycle = MeshCycle(cycle.geometry, MeshElements(e.stiffness, e.damping, friction, e.error))
    absolute = periodic_system(pair, "full", as_printed=as_printed, cycle=cycle)
    times = sample_times(cycle.period, samples_per_cycle)
    solution = periodic_solution(absolute, times, estimate_error=False)
    data = dataset(absolute, times, solution.states, {})
    relative = periodic_system(pair, "elastic", as_printed=as_printed, cycle=cycle)
    floquet = monodromy(
        PeriodicSystem(
            relative.matrices, relative.period, tuple(relative.breakpoints.tolist()), vectorized=True
        ),
        rtol=1e-9,
    )
    g = cycle.geometry
    s = absolute.structure
    normal = data["normal_load"].to_numpy()
    sliding = data["friction_force"].to_numpy()
    driving = solution.pinion_torque * g.omega_pinion
    return Response(
        cycle=data,
        efficiency=solution.brake_torque * g.omega_gear / driving,
        brake_torque=solution.brake_torque,
        created_power=float(np.mean(created_power(pair, data, as_printed))) / driving,
        third_law_x=float(np.abs((s.normal[2] + s.normal[3]) * normal.sum(0)).max()),
        third_law_y=float(np.abs((s.friction_arm[4, 0] + s.friction_arm[5, 0]) * sliding.sum(0)).max()),
        radius=floquet.spectral_radius,
        multipliers=floquet.multipliers,
    )


def created_power(pair: GearPair, data: xr.Dataset, as_printed: Collection[int] = ()) -> FloatArray:
    """Power of the tooth forces on all coordinates beyond that of the contact itself, (k,) [W].

    Forces that act on both teeth at one point, equal and opposite, have the power -N d(delta)/dt - F v_s with
    the relative velocities of the teeth at that point: it does not depend on how the bodies move together.
    What the generalised forces of the equations deliver beyond this comes from nowhere.

    Parameters
    ----------
    pair : the gear pair
    data : a result of the lumped model
    as_printed : equations whose printed sign is used
    """
    s = periodic_system(pair, "full", as_printed=as_printed).structure
    g = pair.geometry
    names = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g")
    rates = np.stack([data[f"{name}_dot"].to_numpy() for name in names], axis=-1)
    rates[:, 0] += g.omega_pinion
    rates[:, 1] += g.omega_gear
    normal = data["normal_load"].to_numpy()
    friction = data["friction_force"].to_numpy()
    on_bodies = normal.sum(0) * (rates @ s.normal)
    on_bodies += (friction * np.einsum("pkc,kc->pk", s.friction(data["position"].to_numpy()), rates)).sum(0)
    contact = -normal.sum(0) * data["dte_dot"].to_numpy()
    contact -= (friction * data["sliding_velocity"].to_numpy()).sum(0)
    return np.asarray(on_bodies - contact, dtype=np.float64)


def speed_drift(pair: GearPair, *, as_printed: Collection[int] = (), cycles: int = 20) -> float:
    """Change of the mean speed in a free run under the torques that hold it in the repaired model.

    The run starts in the repaired model's periodic motion. The rate of the rigid rotation, weighted by
    J_p/r_bp and J_g/r_bg, sees torques only, not the mesh.

    Parameters
    ----------
    pair : a validated gear pair
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used
    cycles : mesh cycles to run

    Returns
    -------
    change of the mean pinion speed over these cycles, relative to the nominal speed
    """
    run = simulate(pair, cycles, samples_per_cycle=64, initial="periodic", as_printed=as_printed)
    g = pair.geometry
    s = periodic_system(pair, "full").structure
    weights = s.mass[:2] / np.array([g.base_radius_pinion, g.base_radius_gear])
    rates = np.stack([run["theta_p_dot"].to_numpy(), run["theta_g_dot"].to_numpy()])
    rigid = weights @ rates / (weights @ np.array([1.0, g.omega_gear / g.omega_pinion]))
    # One whole cycle each at the start and at the end: what is periodic with the mesh cancels.
    change = rigid[-65:-1].mean() - rigid[:64].mean()
    return float(change / g.omega_pinion * cycles / (cycles - 1))
