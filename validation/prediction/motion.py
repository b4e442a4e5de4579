"""The prediction for a pair at its operating point: the best motion of the program, and its numbers.

The prediction is the motion of the pair as given, with its own teeth and on its shafts. Contact is
unilateral; stiffness and dampers follow the momentary load. Where no such motion is found, the linear
motion stands in, with the reason. Contact is lost where the total mesh force is zero.

Sources: docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import xarray as xr

from lumped.display.progress import reported_to, shows_progress
from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError, UnsettledError, typed_errors
from lumped.labelling import provenance
from lumped.model.momentary_load import steps_of
from lumped.model.periodic_system import LTVSystem, Supports, supports_of, with_supports
from lumped.model.results import PlainMotion, peak_to_peak, plain
from lumped.model.revolution_motion import Origin, default_samples, plain_motion
from lumped.model.steady import UNSTABLE
from lumped.model.steady_state import periodic_motion
from lumped.model.unilateral_motion import settled_motion
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.meeting_teeth import period_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress, ProgressRequest, unheard
from validation.signals.complex_orders import orders_of_period

if TYPE_CHECKING:
    from validation.signals.orders import Shaft

#: Samples in a mesh cycle of a pair with like teeth.
_SAMPLES = 512
#: Number of mesh orders of a result.
ORDERS = 10
#: Vibration over the mean value that is rounding: a mesh of constant stiffness without friction stands still.
NOTHING = 1e-12


class Motion(Enum):
    """Kind of the predicted motion. The value is the phrase that a user reads."""

    UNILATERAL = "the motion with unilateral contact"
    SETTLED = "the motion with unilateral contact to which a run settles"
    FOLLOWED = "the motion with unilateral contact that is followed from a neighbouring torque or speed"
    LINEAR = "the linear motion, in which teeth may pull"
    SECOND = "the motion of the multibody model"

    @property
    def text(self) -> str:
        """The phrase that a user reads."""
        return self.value


#: Kind of a motion of like teeth, by the attribute ``origin`` of the motion.
_KINDS = {Origin.SETTLED.value: Motion.SETTLED, Origin.NEIGHBOUR.value: Motion.FOLLOWED}


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(DisplayedResult):
    """The predicted motion of a pair at its operating point.

    Attributes
    ----------
    pair : the gear pair
    motion : kind of the motion
    plain : the motion at equal time steps over its period, as plain arrays
    peak_to_peak : peak to peak of the transmission error, with peaks between samples [m]
    stable : whether the motion returns after a small disturbance, by the multipliers of the motion; for
        unlike teeth by the multipliers of the twin with like teeth
    mesh_cycles : mesh cycles in the period of the motion
    losses : mean power lost at each place of ``PLACES`` [W]; empty: the motion is not periodic
    reason : why the linear motion stands in for the motion with unilateral contact; empty: it does not
    roams : whether runs with unilateral contact came to no motion that repeats: they beat, are chaotic, or
        grow. The numbers are then those of a motion followed from a neighbour, or of the linear motion
    """

    shown: ClassVar = (
        "motion",
        "reason",
        "peak_to_peak",
        "dynamic_factor",
        "tooth_load",
        "least_force",
        "contact_lost",
        "efficiency",
        "loss",
        "losses",
        "input_power",
        "bearing_rms",
        "bearing_orders",
        "static_force",
        "stable",
        "mesh_cycles",
    )
    instead: ClassVar = {
        "dte": "transmission_error",
        "save": "write_results(prediction.cycle, 'motion.nc')",
        "summary": "numbers, or print the prediction",
        "power_loss": "loss",
        "force": "mesh_force",
        "max_force": "mesh_force.max()",
        "bearing_force": "cycle['bearing_force_x_p'], or bearing_rms",
        "gear_bearing_rms": "cycle['bearing_force_x_g'].std()",
        "frequency": "pair.geometry.mesh_frequency",
        "mesh_frequency": "pair.geometry.mesh_frequency",
        "speed_rpm": "pair.operating.pinion_speed",
        "orders": "bearing_orders, orders_of('dte') or spectrum()",
        "to_dict": "numbers",
        "to_json": "json.dumps(prediction.numbers)",
        "to_dataframe": "cycle.to_dataframe(), or to_dataset()",
        "speed": "pair.operating.pinion_speed",
        "torque": "pair.operating.pinion_torque",
        "power_balance": "crosscheck(pair).power_balance()",
        "waterfall": "spurcheck.waterfall(spurcheck.run_up(pair, (500, 3000)))",
    }

    pair: GearPair
    motion: Motion
    plain: PlainMotion
    peak_to_peak: float
    stable: bool
    mesh_cycles: int
    losses: Mapping[str, float]
    reason: str = ""
    roams: bool = False

    @property
    def cycle(self) -> xr.Dataset:
        """Motion at equal time steps over its period, with the variables of ``lumped.steady_state``."""
        return self.plain.dataset

    @property
    def transmission_error(self) -> xr.DataArray:
        """Dynamic transmission error over the times of ``cycle`` [m]."""
        return self.cycle["dte"]

    @property
    def static_force(self) -> float:
        """Static mesh force without friction, T_p / r_bp [N]."""
        return self.pair.operating.pinion_torque / self.pair.geometry.base_radius_pinion

    @cached_property
    def mesh_force(self) -> FloatArray:
        """Total normal load of all tooth pairs at the times of ``cycle`` [N]."""
        return np.asarray(self.plain.values["normal_load"].sum(axis=0), dtype=np.float64)

    @cached_property
    def mean_force(self) -> float:
        """Mean mesh force: mean of ``mesh_force`` over the period [N].

        The moments on the pinion have no mean over a period, so the mean mesh force is the static one less
        what friction carries: r_bp <N> = T_p - <sum F_n xi_n>.
        """
        return float(self.mesh_force.mean())

    @property
    def input_power(self) -> float:
        """Driving power, T_p Omega_p [W]."""
        return self.pair.operating.pinion_torque * self.pair.geometry.omega_pinion

    @property
    def loss(self) -> float:
        """Mean power lost at all places together [W]; NaN: the motion is not periodic."""
        return sum(self.losses.values()) if self.losses else math.nan

    @property
    def efficiency(self) -> float:
        """1 - loss / input power [-]."""
        return 1.0 - self.loss / self.input_power

    @property
    def dynamic_factor(self) -> float:
        """Largest mesh force over the mean mesh force; 1: the mesh force is constant [-]."""
        return float(self.mesh_force.max()) / self.mean_force

    @property
    def least_force(self) -> float:
        """Smallest mesh force over the mean mesh force; 0: contact is lost [-]."""
        return max(float(self.mesh_force.min()) / self.mean_force, 0.0)

    @property
    def contact_lost(self) -> bool:
        """Whether the total mesh force reaches zero."""
        return float(self.mesh_force.min()) <= 0.0

    @property
    def tooth_load(self) -> float:
        """Largest load of one tooth pair over the mean mesh force [-]."""
        return float(self.plain.values["normal_load"].max()) / self.mean_force

    @cached_property
    def bearing_orders(self) -> FloatArray:
        """(``ORDERS``,) amplitudes of the pinion bearing force at the mesh orders 1, 2, ... [N].

        Both directions together: the root of the sum of the squared amplitudes.
        """
        along, across = (self.orders_of(f"bearing_force_{line}_p") for line in "xy")
        return np.asarray(np.hypot(along, across), dtype=np.float64)

    @property
    def bearing_rms(self) -> float:
        """Root mean square of the pinion bearing force about its mean, both directions together [N]."""
        along, across = (float(self.plain.values[f"bearing_force_{line}_p"].std()) for line in "xy")
        rms = float(np.hypot(along, across))
        return rms if rms > NOTHING * self.static_force else 0.0

    def orders_of(self, name: str) -> FloatArray:
        """(``ORDERS``,) amplitudes of a variable of ``cycle`` at the mesh orders 1, 2, ..."""
        return mesh_orders(self.plain.values[name], self.mesh_cycles)

    def spectrum(self, shaft: Shaft = "mesh", variable: str = "dte") -> xr.Dataset:
        """Return the amplitudes of a variable of ``cycle`` over the orders of a shaft, by ``order_spectrum``.

        Parameters
        ----------
        shaft : "mesh", "pinion" or "gear"
        variable : of ``cycle``, over time alone

        Raises
        ------
        ParameterError : another shaft, or no variable over time
        """
        from validation.signals.orders import order_spectrum

        return order_spectrum(self.cycle, shaft, variable=variable)

    def to_dataset(self) -> xr.Dataset:
        """Return ``cycle`` with the numbers of ``QUANTITIES`` as variables without dimension."""
        labels = {name: {"units": unit, "long_name": words} for name, (unit, words) in QUANTITIES.items()}
        numbers = {name: ((), value, labels[name]) for name, value in self.numbers.items()}
        attributes = {"motion": self.motion.text, "reason": self.reason}
        return self.cycle.assign(numbers).assign_attrs(attributes)

    @property
    def numbers(self) -> dict[str, float]:
        """The scalar results by name, in SI. ``QUANTITIES`` has units and plain names."""
        return {
            "dte_peak_to_peak": self.peak_to_peak,
            "dynamic_factor": self.dynamic_factor,
            "tooth_load": self.tooth_load,
            "least_force": self.least_force,
            "bearing_rms": self.bearing_rms,
            "efficiency": self.efficiency,
        }


def mesh_orders(values: FloatArray, mesh_cycles: int = 1) -> FloatArray:
    """Return the (``ORDERS``,) amplitudes at the mesh orders 1, 2, ...

    ``values``: samples at equal steps over ``mesh_cycles`` mesh cycles.
    """
    return orders_of_period(values, ORDERS, mesh_cycles).amplitudes[mesh_cycles - 1 :: mesh_cycles]


#: Place where power is lost -> plain name.
PLACES = {
    "sliding": "sliding",
    "tooth_dampers": "tooth damping",
    "bearings": "bearing damping",
    "shafts": "damping of shafts and couplings",
}
#: Result -> SI unit and plain name.
QUANTITIES = {
    "dte_peak_to_peak": ("m", "transmission error, peak to peak"),
    "dynamic_factor": ("1", "largest mesh force over the mean one"),
    "tooth_load": ("1", "largest load of a tooth over the mean mesh force"),
    "least_force": ("1", "smallest mesh force over the mean one"),
    "bearing_rms": ("N", "force on the pinion bearings, rms about its mean"),
    "efficiency": ("1", "mesh efficiency"),
}


@shows_progress("prediction")
def predict(
    pair: AnyPair, *, supports: Supports | None = None, progress: ProgressRequest = None
) -> Prediction:
    """Return the prediction for a pair at its operating point: the best motion of the program, and its
    numbers.

    The motion is ``lumped.steady_state`` with ``contact="unilateral"``, which follows the momentary load.
    Unlike teeth have the motion over their whole period. A pair with shafts is computed on the shafts.
    Where no such motion is found, a stable linear motion stands in: ``Prediction.motion`` names the motion,
    ``Prediction.reason`` the reason. ``uncertainty`` gives the range with the uncertain inputs. Charts,
    margins and jumps use other forms.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    Prediction: ``numbers``, ``dynamic_factor``, ``peak_to_peak`` [m], ``efficiency``; ``cycle`` is the motion

    Raises
    ------
    ParameterError : a refused parameter
    NumericalError : no motion was found, or it does not stay bounded
    """
    tell = reported_to(progress) or unheard
    result = predicted(
        with_supports(load_gear_pair(pair), supports),
        progress=lambda share, stage="", /: tell(0.95 * share),
    )
    tell(1.0)
    return result


def dynamic_factor(pair: AnyPair, *, supports: Supports | None = None) -> float:
    """Return the dynamic factor of ``predict``: largest mesh force over the mean mesh force [-].

    Arguments (``pair``, ``supports``) and errors as for ``predict``.
    """
    return predict(pair, supports=supports).dynamic_factor


def predicted(
    pair: GearPair, samples_of_like_teeth: int = _SAMPLES, progress: Progress = unheard
) -> Prediction:
    """Return the prediction for a pair at its operating point, on the shafts of a pair that has shafts.

    ``samples_of_like_teeth``: samples in a mesh cycle where all teeth are alike. ``progress`` is called with
    the finished fraction and what is being done.
    """
    samples = samples_of_like_teeth if pair.healthy is pair else None
    try:
        with typed_errors():
            motion = periodic_motion(pair, "unilateral", samples_per_cycle=samples, progress=progress)
    except NumericalError as error:
        return _stand_in(pair, samples, error)
    kind = _KINDS.get(str(motion.attributes.get("origin"))) if pair.healthy is pair else None
    prediction = _of_plain(pair, motion, kind or Motion.UNILATERAL)
    return replace(prediction, roams=True) if kind is Motion.FOLLOWED else prediction


def predicted_by_long_steps(pair: GearPair, factor: int) -> Prediction:
    """Return the prediction for a pair whose teeth differ, with steps that are ``factor`` times as long.

    Over a long hunting period it takes so much less time. ``docs/verification/uncertainty.md`` says how far
    results with steps four times as long are from those of ``predict``.

    Raises
    ------
    NumericalError : no motion was found. No linear motion stands in
    """
    supports = supports_of(pair, None)
    steps = steps_of(LTVSystem.of(pair.healthy, "full", supports=supports)) // factor
    with typed_errors():
        motion = settled_motion(pair, default_samples(period_of(pair)), supports, steps)
    return _of_plain(pair, plain_motion(motion, partial(provenance, pair)), Motion.UNILATERAL)


def _stand_in(pair: GearPair, samples: int | None, error: NumericalError) -> Prediction:
    """The linear motion, stable or not, in place of the unilateral motion that was not found."""
    try:
        linear = _of_plain(pair, periodic_motion(pair, samples_per_cycle=samples), Motion.LINEAR)
    except NumericalError:
        raise error from None
    return replace(linear, reason=str(error), roams=isinstance(error, UnsettledError))


def measured(pair: GearPair, cycle: xr.Dataset, motion: Motion) -> Prediction:
    """Return the numbers of a periodic motion of either model, sampled at equal steps over its period."""
    return _of_plain(pair, plain(cycle), motion)


def _of_plain(pair: GearPair, cycle: PlainMotion, motion: Motion) -> Prediction:
    """Numbers of a periodic motion as plain arrays, sampled at equal steps over its period."""
    attributes = cycle.attributes
    dte = cycle.values["dte"]
    swing = attributes.get("dte_peak_to_peak")
    if swing is None:
        swing = peak_to_peak(cycle.time, dte, cycle.values["dte_dot"])
    return Prediction(
        pair=pair,
        motion=motion,
        plain=cycle,
        peak_to_peak=float(swing) if swing > NOTHING * float(np.abs(dte).max()) else 0.0,
        stable=float(attributes.get("spectral_radius", 0.0)) <= UNSTABLE,
        mesh_cycles=int(attributes.get("period_cycles", 1)),
        losses=losses_of(attributes),
    )


def losses_of(attributes: Mapping[str, Any]) -> dict[str, float]:
    """Return the mean losses by place [W]: the attributes ``power_*`` of a motion of either model."""
    return {place: float(attributes[f"power_{place}"]) for place in PLACES if f"power_{place}" in attributes}
