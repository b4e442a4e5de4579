"""The prediction for a pair at its operating point: the best motion that the program has, and its numbers.

The prediction is the motion with unilateral contact whose contact and dampers follow the momentary load. It
is looked for near the linear motion about the static state where every tooth pair of that pushes; else near
the motion with unilateral contact that Newton's method finds from the linear motion, if it is stable, or to
which a run from there settles. Where no such motion is near, and with prescribed contact, which knows no
other load, the prediction is the motion near which it was looked for. On the shafts it is the linear motion.
Contact is lost where the total mesh force is zero.

Sources: docs/theory/orbits.md, "Gear pair"; docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import numpy as np
import xarray as xr

import floquet
import lumped
from floquet.gear.motions import GearOrbit
from floquet.gear.unilateral import contact_cycle
from lumped.errors import NumericalError
from lumped.labelling import provenance
from lumped.model.closed import closed_motion
from lumped.model.equations import COORDINATES
from lumped.model.periodic_system import LTVSystem
from lumped.model.results import cycle_peak_to_peak
from lumped.quasi_static.contacts import contact_of
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

_SAMPLES = 512
#: Load of a tooth pair over the mean mesh force that counts as pulling: rounding of a pair that just touches.
_PULLS = -1e-6
#: Change of the peak to peak by momentary loads, at most, that is still the same motion.
_NEAR = 0.25
ORDERS = 10


class Motion(Enum):
    """Which motion the prediction is; the value is the text that a reader gets."""

    LINEAR = "the linear motion: every tooth pair pushes"
    SHAFTS = "the linear motion on the shafts"
    UNILATERAL = "the motion with unilateral contact"
    SETTLED = "the motion with unilateral contact to which a run settles"
    SECOND = "the motion of the multibody model"

    @property
    def text(self) -> str:
        """The meaning, as a phrase."""
        return self.value


@dataclass(frozen=True, eq=False)
class Prediction:
    """The predicted motion of a pair at its operating point.

    Attributes
    ----------
    pair : the gear pair
    motion : which motion it is
    cycle : that motion at even times over its period, with the variables of ``lumped.steady_state``
    peak_to_peak : of the transmission error, between samples too [m]
    stable : whether the motion returns after a small disturbance
    mesh_cycles : after which the motion repeats
    losses : place of ``PLACES`` -> mean power that is lost there [W]; empty where the motion is not periodic
    """

    pair: GearPair
    motion: Motion
    cycle: xr.Dataset
    peak_to_peak: float
    stable: bool
    mesh_cycles: int
    losses: Mapping[str, float]

    @property
    def transmission_error(self) -> xr.DataArray:
        """Dynamic transmission error over the times of ``cycle`` [m]."""
        return self.cycle["dte"]

    @property
    def static_force(self) -> float:
        """Mean mesh force, T_p / r_bp [N]."""
        return self.pair.operating.pinion_torque / self.pair.geometry.base_radius_pinion

    @cached_property
    def mesh_force(self) -> FloatArray:
        """Total normal load of all tooth pairs at the times of ``cycle`` [N]."""
        return np.asarray(self.cycle["normal_load"].sum("pair").to_numpy(), dtype=np.float64)

    @property
    def input_power(self) -> float:
        """Driving power, T_p Omega_p [W]."""
        return self.pair.operating.pinion_torque * self.pair.geometry.omega_pinion

    @property
    def loss(self) -> float:
        """Mean power that all places lose together [W]; NaN where the motion is not periodic."""
        return sum(self.losses.values()) if self.losses else math.nan

    @property
    def efficiency(self) -> float:
        """Share of the driving power that is not lost [-], 1 - loss / input."""
        return 1.0 - self.loss / self.input_power

    @property
    def dynamic_factor(self) -> float:
        """Largest mesh force over the static one [-]."""
        return float(self.mesh_force.max()) / self.static_force

    @property
    def least_force(self) -> float:
        """Smallest mesh force over the static one; 0 is contact loss [-]."""
        return max(float(self.mesh_force.min()) / self.static_force, 0.0)

    @property
    def contact_lost(self) -> bool:
        """Whether the total mesh force reaches zero."""
        return float(self.mesh_force.min()) <= 0.0

    @property
    def tooth_load(self) -> float:
        """Largest load of one tooth pair over the static mesh force [-]."""
        return float(self.cycle["normal_load"].max()) / self.static_force

    @cached_property
    def bearing_orders(self) -> FloatArray:
        """(``ORDERS``,) amplitudes of the pinion's bearing force at the mesh orders 1, 2, ... [N].

        Both directions together: the root of the sum of their squared amplitudes.
        """
        along, off = (self.orders_of(f"bearing_force_{line}_p") for line in "xy")
        return np.asarray(np.hypot(along, off), dtype=np.float64)

    @property
    def bearing_rms(self) -> float:
        """Root mean square of the pinion's bearing force about its mean, both directions together [N]."""
        along, off = (float(self.cycle[f"bearing_force_{line}_p"].std()) for line in "xy")
        return float(np.hypot(along, off))

    def orders_of(self, name: str) -> FloatArray:
        """(``ORDERS``,) amplitudes of a variable of ``cycle`` at the mesh orders 1, 2, ..."""
        return mesh_orders(self.cycle[name].to_numpy(), self.mesh_cycles)

    @property
    def numbers(self) -> dict[str, float]:
        """The scalar results by name, in SI; see ``QUANTITIES``."""
        return {
            "dte_peak_to_peak": self.peak_to_peak,
            "dynamic_factor": self.dynamic_factor,
            "tooth_load": self.tooth_load,
            "least_force": self.least_force,
            "bearing_rms": self.bearing_rms,
            "efficiency": self.efficiency,
        }


def mesh_orders(values: FloatArray, mesh_cycles: int = 1) -> FloatArray:
    """(``ORDERS``,) amplitudes at the mesh orders 1, 2, ... of values at even times over so many cycles."""
    found = 2.0 * np.abs(np.fft.rfft(values)) / values.size
    return np.asarray(found[mesh_cycles::mesh_cycles][:ORDERS], dtype=np.float64)


#: Where power is lost -> its plain name.
PLACES = {
    "sliding": "sliding",
    "tooth_dampers": "tooth damping",
    "bearings": "bearing damping",
    "shafts": "damping of shafts and couplings",
}
#: Result -> its unit and plain name.
QUANTITIES = {
    "dte_peak_to_peak": ("m", "transmission error, peak to peak"),
    "dynamic_factor": ("1", "largest mesh force over the static one"),
    "tooth_load": ("1", "largest load of a tooth over the static mesh force"),
    "least_force": ("1", "smallest mesh force over the static one"),
    "bearing_rms": ("N", "force on the pinion bearings, rms about its mean"),
    "efficiency": ("1", "mesh efficiency"),
}


def predict(pair: AnyPair) -> Prediction:
    """Return the best motion that the program has for a pair at its operating point, and its numbers.

    The motion with unilateral contact by momentary load, of teeth that differ over their whole period; on the
    shafts the linear motion. ``Prediction.motion`` says which one it is, ``uncertainty`` how far the inputs
    move it.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file

    Returns
    -------
    Prediction: ``numbers``, ``dynamic_factor``, ``peak_to_peak`` [m], ``efficiency``; ``cycle`` is the motion

    Raises
    ------
    ParameterError : a refused parameter
    NumericalError : no motion was found, or it does not stay bounded
    """
    return predicted(load_gear_pair(pair))


def dynamic_factor(pair: AnyPair) -> float:
    """Return the largest mesh force of ``predict`` over the static one [-]; the same errors."""
    return predict(pair).dynamic_factor


def predicted(pair: GearPair, motion: Callable[..., xr.Dataset] = lumped.steady_state) -> Prediction:
    """Return the prediction for a pair at its operating point, on its shafts where it has them.

    ``motion`` computes the linear motion.
    """
    if pair.shafts is not None:
        return _of_cycle(pair, motion(pair, supports="shafts", samples_per_cycle=_SAMPLES))
    if pair.healthy is not pair:
        found = measured(pair, motion(pair), Motion.UNILATERAL)
        stable = float(found.cycle.attrs["spectral_radius"]) <= 1.0  # of the twin with like teeth
        return replace(found, stable=stable, mesh_cycles=int(found.cycle.attrs["period_cycles"]))
    try:
        linear = motion(pair, samples_per_cycle=_SAMPLES)
    except NumericalError:
        linear = None
    if linear is not None and not pulls(pair, linear):
        cycle = near_linear(pair, linear)
        return _of_cycle(pair, linear) if cycle is None else measured(pair, cycle, Motion.UNILATERAL)
    orbit, which = unilateral_motion(pair)
    cycle = by_momentary_load(orbit)
    if cycle is None:
        return _of_orbit(orbit, which)
    return replace(measured(pair, cycle, which), stable=orbit.stable)


def pulls(pair: GearPair, linear: xr.Dataset) -> bool:
    """Whether a tooth pair pulls in a linear motion."""
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    return float(linear["normal_load"].min()) < _PULLS * force


def near_linear(pair: GearPair, linear: xr.Dataset) -> xr.Dataset | None:
    """Return the motion by momentary load near a linear motion in which every pair of like teeth pushes.

    None with prescribed contact, of an unstable motion, or where no such motion is near.
    """
    radius = float(linear.attrs["spectral_radius"])
    if contact_of(pair).name != "loaded" or pair.healthy is not pair or radius > 1.0:
        return None
    first, g = linear.isel(time=0), pair.geometry
    start = []
    for suffix in ("", "_dot"):
        turned = float(first[f"theta_p{suffix}"]), float(first[f"theta_g{suffix}"])
        start.append(g.base_radius_pinion * turned[0] - g.base_radius_gear * turned[1])
        start += [float(first[f"{name}{suffix}"]) for name in ("x_p", "x_g", "y_p", "y_g")]
    balanced = pair.operating.brake_torque == "balanced"
    torque = float(linear.attrs["brake_torque" if balanced else "pinion_torque"])
    size = float(linear.attrs["dte_peak_to_peak"])
    return _momentary(pair, np.array(start), torque, radius, size, linear.sizes["time"])


def _momentary(
    pair: GearPair, start: FloatArray, torque: float, radius: float, size: float, samples: int
) -> xr.Dataset | None:
    """The motion by momentary load near a motion of that peak to peak; None where there is none."""
    try:
        found = closed_motion(pair, samples, start, torque, radius)
    except NumericalError:
        return None
    if abs(cycle_peak_to_peak(found, "dte") - size) > _NEAR * size:
        return None
    return found.assign_attrs(provenance(pair, samples_per_cycle=samples))


def by_momentary_load(orbit: GearOrbit, samples: int = _SAMPLES) -> xr.Dataset | None:
    """Return the motion near an orbit whose contact and dampers follow the momentary load, over its cycle.

    An orbit has the tangents and dampers of the static load. None with prescribed contact, which knows no
    other, with back sides that strike, after several cycles, or where no such motion is near.
    """
    pair = orbit.pair
    if contact_of(pair).name != "loaded" or orbit.n > 1 or orbit.reaches_back_side:
        return None
    balanced = pair.operating.brake_torque == "balanced"
    torque = orbit.brake_torque if balanced else orbit.pinion_torque
    start, known = np.zeros((2, 5)), orbit.orbit.start.reshape(2, -1)
    start[:, : known.shape[1]] = known  # y, which friction alone drives, follows
    start[1] /= orbit.orbit.period
    low, high = orbit.dte_range
    return _momentary(pair, start.ravel(), torque, orbit.spectral_radius, high - low, samples)


def unilateral_motion(pair: GearPair) -> tuple[GearOrbit, Motion]:
    """Return the motion with unilateral contact that a run from the linear motion comes to, and which it is.

    It is the one that Newton's method finds from the linear motion, if that is stable; else the one to which
    a run settles. A NumericalError says that the motion does not repeat, or does not stay bounded.
    """
    with suppress(NumericalError):
        orbit = floquet.periodic_orbit(pair)
        if orbit.stable:
            return orbit, Motion.UNILATERAL
    settled = floquet.long_run(pair)
    if settled.orbit is None:
        raise NumericalError(
            f"The motion with unilateral contact does not repeat: {settled.kind}. Read its branches over "
            "speed: spurcheck response."
        )
    return GearOrbit(pair, settled.orbit), Motion.SETTLED


def measured(pair: GearPair, cycle: xr.Dataset, motion: Motion) -> Prediction:
    """Return the numbers of any motion over one mesh cycle at even times, as of the multibody model."""
    return Prediction(
        pair=pair,
        motion=motion,
        cycle=cycle,
        peak_to_peak=cycle_peak_to_peak(cycle, "dte"),
        stable=True,
        mesh_cycles=1,
        losses=losses_of(cycle),
    )


def _of_cycle(pair: GearPair, cycle: xr.Dataset) -> Prediction:
    attributes = cycle.attrs
    return Prediction(
        pair=pair,
        motion=Motion.LINEAR if attributes["supports"] == "springs" else Motion.SHAFTS,
        cycle=cycle,
        peak_to_peak=float(attributes["dte_peak_to_peak"]),
        stable=float(attributes["spectral_radius"]) <= 1.0,
        mesh_cycles=1,
        losses=losses_of(cycle),
    )


def losses_of(motion: xr.Dataset) -> dict[str, float]:
    """Return the mean losses by place [W] that a periodic motion of either model carries as ``power_*``."""
    return {
        place: float(motion.attrs[f"power_{place}"]) for place in PLACES if f"power_{place}" in motion.attrs
    }


def _of_orbit(orbit: GearOrbit, motion: Motion) -> Prediction:
    pair, cycle = orbit.pair, orbit.sampled(_SAMPLES)
    low, high = orbit.dte_range
    return Prediction(
        pair=pair,
        motion=motion,
        cycle=cycle,
        peak_to_peak=high - low,
        stable=orbit.stable,
        mesh_cycles=orbit.n,
        losses=losses(pair, cycle),
    )


def losses(pair: GearPair, motion: xr.Dataset) -> dict[str, float]:
    """Mean losses by place [W] of a motion with unilateral contact.

    Where the damper would make a compressed pair pull, the load is zero, and the damper takes what the
    elastic force gives: the power (N - N_e) (delta' - e') is positive (docs/theory/contact_energy.md).
    """
    mesh = contact_cycle(pair)
    at = mesh.sample(np.mod(motion["time"].to_numpy(), mesh.period))
    load, closing = motion["normal_load"].to_numpy(), motion["dte_dot"].to_numpy() - at.error_rate
    elastic = at.stiffness * (motion["dte"].to_numpy() - at.error)
    # Where teeth that do not pull cut the load to zero, the damper still takes what the pair expands by.
    damper = np.where(load > 0.0, load - elastic, np.minimum(-elastic, 0.0))
    closing = closing if at.closing is None else closing * at.closing
    rates = np.stack([motion[f"{name}_dot"].to_numpy() for name in COORDINATES])
    bearings = LTVSystem.of(pair, "full").structure.damping @ rates**2
    return {
        "sliding": -float(motion["friction_power"].sum("pair").mean()),
        "tooth_dampers": float((damper * closing).sum(axis=0).mean()),
        "bearings": float(bearings.mean()),
    }
