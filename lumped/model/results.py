"""Labelled results: one table of variables with units, shared by the lumped and the multibody model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.labelling import Variable, labelled_dataset
from lumped.model.equations import COORDINATES, THETA_G, THETA_P, Y_G, Y_P
from lumped.model.mesh_cycle import PairState
from lumped.model.periodic_system import LTVSystem
from lumped.quasi_static.contacts import contact_of
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr

#: Share of the static load below which a load counts as zero where the question is whether teeth separate.
LOAD_NOISE = 1e-4
#: Variable -> (dimensions, unit, plain name). Every model of the pair returns these.
VARIABLES: dict[str, tuple[tuple[str, ...], str, str]] = {
    "theta_p": (("time",), "rad", "pinion rotation, deviation from nominal"),
    "theta_g": (("time",), "rad", "gear rotation, deviation from nominal"),
    "x_p": (("time",), "m", "pinion displacement along the line of action"),
    "x_g": (("time",), "m", "gear displacement along the line of action"),
    "y_p": (("time",), "m", "pinion displacement off the line of action"),
    "y_g": (("time",), "m", "gear displacement off the line of action"),
    "theta_p_dot": (("time",), "rad/s", "pinion speed, deviation from nominal"),
    "theta_g_dot": (("time",), "rad/s", "gear speed, deviation from nominal"),
    "x_p_dot": (("time",), "m/s", "pinion velocity along the line of action"),
    "x_g_dot": (("time",), "m/s", "gear velocity along the line of action"),
    "y_p_dot": (("time",), "m/s", "pinion velocity off the line of action"),
    "y_g_dot": (("time",), "m/s", "gear velocity off the line of action"),
    "dte": (("time",), "m", "dynamic transmission error"),
    "dte_dot": (("time",), "m/s", "rate of the dynamic transmission error"),
    "mesh_stiffness": (("time",), "N/m", "mesh stiffness of all tooth pairs"),
    "position": (("pair", "time"), "m", "contact position from the pinion's tangent point"),
    "contact": (("pair", "time"), "1", "whether the tooth pair is in contact"),
    "mu": (("pair", "time"), "1", "friction coefficient, signed"),
    "normal_load": (("pair", "time"), "N", "normal load"),
    "friction_force": (("pair", "time"), "N", "friction force on the pinion, off the line of action"),
    "sliding_velocity": (("pair", "time"), "m/s", "sliding velocity, vibration included"),
    "friction_power": (("pair", "time"), "W", "friction power, vibration included"),
    "friction_power_nominal": (("pair", "time"), "W", "friction power at the nominal sliding velocity"),
    "bearing_force_x_p": (("time",), "N", "pinion bearing force on the pinion, along the line of action"),
    "bearing_force_x_g": (("time",), "N", "gear bearing force on the gear, along the line of action"),
    "bearing_force_y_p": (("time",), "N", "pinion bearing force on the pinion, off the line of action"),
    "bearing_force_y_g": (("time",), "N", "gear bearing force on the gear, off the line of action"),
}


class MotionValues(Mapping[str, FloatArray]):
    """Variables of a motion by name: some are known, all others are computed when one of them is first read.

    Parameters
    ----------
    known : variables by name
    others : returns the other variables by name; a known variable replaces one of the same name
    """

    def __init__(
        self, known: Mapping[str, FloatArray], others: Callable[[], Mapping[str, FloatArray]]
    ) -> None:
        self._known = known
        self._others = others

    @cached_property
    def _all(self) -> dict[str, FloatArray]:
        return dict(self._others()) | dict(self._known)

    def __getitem__(self, name: str) -> FloatArray:
        return self._known[name] if name in self._known else self._all[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)


@dataclass(frozen=True, eq=False)
class PlainMotion:
    """A motion as plain arrays. Its dataset, which takes ten times as long, is made when a user needs it.

    Attributes
    ----------
    time : (k,) [s]
    values : name of ``VARIABLES`` -> (k,) or (pairs, k), in SI
    attributes : numbers and texts of the motion; what the dataset has beside them is about its origin
    make_dataset : returns the motion with labels, units and the attributes about its origin
    """

    time: FloatArray
    values: Mapping[str, FloatArray]
    attributes: Mapping[str, Any]
    make_dataset: Callable[[], xr.Dataset]

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The motion as a dataset with names and units."""
        return self.make_dataset()


def plain(motion: xr.Dataset) -> PlainMotion:
    """Return the arrays of a dataset that a model has made."""
    values = {name: motion[name].to_numpy() for name in VARIABLES if name in motion}
    return PlainMotion(motion["time"].to_numpy(), values, motion.attrs, lambda: motion)


def labelled(
    time: FloatArray,
    values: Mapping[str, FloatArray],
    attributes: Mapping[str, Any],
    further: Mapping[str, Variable] | None = None,
) -> xr.Dataset:
    """Return arrays of ``VARIABLES``, and ``further`` variables, as a dataset with names and units."""
    variables: dict[str, Variable] = {
        name: (dims, values[name], unit, text)
        for name, (dims, unit, text) in VARIABLES.items()
        if name in values
    }
    pairs = next((v.shape[0] for n, v in values.items() if VARIABLES[n][0][0] == "pair"), 0)
    coordinates = {"time": (time, "s", "time"), "pair": (np.arange(pairs), "1", "tooth pair, 0 is ahead")}
    return labelled_dataset(variables | dict(further or {}), coordinates, attributes)


def dataset(
    system: LTVSystem, time: FloatArray, states: FloatArray, attributes: Mapping[str, Any]
) -> xr.Dataset:
    """Return states (k, n) of the "full" system as a dataset, with all loads and velocities that follow."""
    return plain_linear(system, time, states, attributes, dict).dataset


def plain_linear(
    system: LTVSystem,
    time: FloatArray,
    states: FloatArray,
    attributes: Mapping[str, Any],
    origin: Callable[[], dict[str, Any]],
) -> PlainMotion:
    """Return states (k, n) of the "full" system as a motion, with all loads and velocities that follow.

    ``origin`` returns the attributes about the origin of the motion, which only the dataset has.
    """
    values = response(system, time, states)

    def make_dataset() -> xr.Dataset:
        return system.supports.labelled(labelled(time, values, origin() | dict(attributes)), states)

    return PlainMotion(time, values, attributes, make_dataset)


def load_range(pair: GearPair, load: FloatArray, contact: FloatArray) -> tuple[float, float]:
    """Largest load of a tooth pair, and least load, which is negative where the teeth would separate [N].

    The form of contact decides whether every pair must press or all pairs together, see ``Contact.pressing``.

    Parameters
    ----------
    load : (pairs, k) [N]
    contact : (pairs, k) whether the pair can touch
    """
    touching = contact > 0
    pressing, where = contact_of(pair).pressing(load, touching)
    return float(load[touching].max()), float(pressing[where].min())


def a_pair_pulls(pair: GearPair, motion: xr.Dataset) -> bool:
    """Whether any tooth pair pulls in a motion, by more than ``LOAD_NOISE`` of the static load.

    The form of contact does not count here: with prescribed contact all pairs together may press all the time
    while one of them pulls. `needs_pull` asks for the form.
    """
    static_load = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    return float(motion["normal_load"].min()) < -LOAD_NOISE * static_load


def needs_pull(pair: GearPair, motion: xr.Dataset) -> bool:
    """Whether a motion of the linear model needs teeth that pull, by more than ``LOAD_NOISE``."""
    least = load_range(pair, *(motion[name].to_numpy() for name in ("normal_load", "contact")))[1]
    return least < -LOAD_NOISE * pair.operating.pinion_torque / pair.geometry.base_radius_pinion


def farthest_reversal(distance: FloatArray, sliding: FloatArray, loaded: BoolArray) -> float:
    """Largest distance from the pitch point at which a loaded pair slides backwards [m]; 0 if no pair does.

    Between two samples the velocity is taken as a straight line.

    Parameters
    ----------
    distance : (pairs, k) signed distance from the pitch point [m]
    sliding : (pairs, k) sliding velocity; without vibration it has the sign of the distance [m/s]
    loaded : (pairs, k) whether the pair carries load
    """
    forwards = sliding * np.sign(distance)
    farthest = float(np.where(loaded & (forwards < 0.0), np.abs(distance), 0.0).max())
    before = np.s_[:, :-1]
    after = np.s_[:, 1:]
    turns = (forwards[before] * forwards[after] < 0.0) & (distance[before] * distance[after] > 0.0)
    turns &= loaded[before] & loaded[after]
    v0 = forwards[before][turns]
    v1 = forwards[after][turns]
    d0 = distance[before][turns]
    d1 = distance[after][turns]
    return float(np.abs(d0 + v0 / (v0 - v1) * (d1 - d0)).max(initial=farthest))


def response(
    system: LTVSystem,
    time: FloatArray,
    states: FloatArray,
    normal_load: FloatArray | None = None,
    pairs: PairState | None = None,
) -> dict[str, FloatArray]:
    """Return the variables of ``VARIABLES`` at states by name, without labels.

    Parameters
    ----------
    time, states : (k,) [s], (k, n) of the "full" system
    normal_load : (pairs, k) load of each pair [N]; by default the load of the linear form
    pairs : coefficients of the pairs; by default those of like teeth
    """
    values = gear_values(system, states)
    pairs = system.cycle.sample(time) if pairs is None else pairs
    normal = pairs.load(values["dte"], values["dte_dot"]) if normal_load is None else normal_load
    return values | pair_values(system, states, normal, pairs)


def gear_values(system: LTVSystem, states: FloatArray) -> dict[str, FloatArray]:
    """Return the variables of both gears and their bearings at states (k, n) of the "full" system."""
    z, rates = system.gear_motion(states)
    values: dict[str, FloatArray] = {name: z[:, j] for j, name in enumerate(COORDINATES)}
    values |= {f"{name}_dot": rates[:, j] for j, name in enumerate(COORDINATES)}
    values |= {
        f"bearing_force_{name}": force for name, force in system.supports.forces_by_gear(states).items()
    }
    deflection = system.structure.deflection
    return values | {"dte": z @ deflection, "dte_dot": rates @ deflection}


def pair_values(
    system: LTVSystem, states: FloatArray, normal: FloatArray, pairs: PairState
) -> dict[str, FloatArray]:
    """Return the variables of the tooth pairs at states, by name. A loss of sliding is here.

    Parameters
    ----------
    states : (k, n) of the "full" system
    normal : (pairs, k) load of each pair [N]
    pairs : coefficients of the pairs
    """
    g = system.pair.geometry
    _, rates = system.gear_motion(states)
    friction = pairs.friction * normal
    arm_g = g.L_XY - pairs.position
    sliding = (
        (g.omega_pinion + rates[:, THETA_P]) * pairs.position
        - (g.omega_gear + rates[:, THETA_G]) * arm_g
        - (rates[:, Y_P] - rates[:, Y_G])
    )
    return {
        "mesh_stiffness": pairs.stiffness.sum(0),
        "position": pairs.position,
        "contact": pairs.contact.astype(np.float64),
        "mu": pairs.friction,
        "normal_load": normal,
        "friction_force": friction,
        "sliding_velocity": np.where(pairs.contact, sliding, 0.0),
        "friction_power": np.where(pairs.contact, -friction * sliding, 0.0),
        "friction_power_nominal": -friction * (g.omega_pinion * pairs.position - g.omega_gear * arm_g),
    }


def corner_force(values: Mapping[str, FloatArray], pairs: PairState) -> FloatArray:
    """Force by which tip corners push the gears apart off the line of action, of all pairs (k,) [N]."""
    tilt = np.zeros(1) if pairs.tilt is None else pairs.tilt
    return np.asarray((tilt * values["normal_load"]).sum(axis=0), dtype=np.float64)


def peaks_to_peaks(time: FloatArray, values: FloatArray, rates: FloatArray) -> FloatArray:
    """Largest minus least value of each row, with the extremes between two samples, (n,).

    Between two samples the motion is the cubic through their values and rates. The error of the cubic falls
    with the fourth power of the interval; where a force jumps inside the interval, with the square.

    Parameters
    ----------
    time, values, rates : (k,), (n, k), (n, k)
    """
    step = np.diff(time)
    rise = np.diff(values)
    start = rates[:, :-1] * step
    end = rates[:, 1:] * step
    # values[:, j] + start s + square s^2 + cube s^3 for s from 0 to 1
    square = 3.0 * rise - 2.0 * start - end
    cube = start + end - 2.0 * rise
    root = np.sqrt(np.maximum(square**2 - 3.0 * cube * start, 0.0))
    sum_of = -(square + np.copysign(root, square))
    with np.errstate(divide="ignore", invalid="ignore"):
        places = np.stack([sum_of / (3.0 * cube), start / sum_of])
    places = np.clip(np.nan_to_num(places, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    between = values[:, :-1] + places * (start + places * (square + places * cube))
    largest = np.maximum(values.max(axis=1), between.max(axis=(0, 2)))
    least = np.minimum(values.min(axis=1), between.min(axis=(0, 2)))
    return np.asarray(largest - least, dtype=np.float64)


def peak_to_peak(time: FloatArray, values: FloatArray, rates: FloatArray) -> float:
    """Largest minus least value, with the extremes between two samples, see ``peaks_to_peaks``."""
    return float(peaks_to_peaks(time, values[None], rates[None])[0])


def cycle_peak_to_peak(run: xr.Dataset, name: str, period: float | None = None) -> float:
    """Peak to peak of a displacement of a result.

    ``period`` [s] is given where the result is periodic and does not contain the end of its period.
    """
    time, values, rates = (run[key].to_numpy() for key in ("time", name, f"{name}_dot"))
    if period is not None:
        time = np.append(time, time[0] + period)
        values = np.append(values, values[0])
        rates = np.append(rates, rates[0])
    return peak_to_peak(time, values, rates)
