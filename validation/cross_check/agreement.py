"""How one quantity of the multibody model agrees with the lumped model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr

from lumped import GearPair
from lumped.errors import NumericalError
from lumped.model.mesh_cycle import MeshCycle
from lumped.model.results import VARIABLES
from lumped.typing import BoolArray, FloatArray
from validation.cross_check.verdict import SAME_EQUATIONS, Judgement

Fidelity = Literal["linear", "exact"]

QUANTITIES: tuple[str, ...] = tuple(SAME_EQUATIONS)
FIDELITIES: tuple[Fidelity, ...] = ("linear", "exact")
#: A history whose variation is below this share of its size is constant up to rounding.
_CONSTANT = 1e-13
#: The same of what another quantity drives, of that one's size: corners whose teeth carry nothing yet.
_DRIVEN = 1e-9
#: A sample this close to a switch, in mesh cycles, may lie on either side of the jump by rounding alone.
_SWITCH_MARGIN = 1e-6
#: Tooth forces jump where teeth enter and leave and where sliding reverses. Finite motions move these places,
#: and the whole jump would count for a difference. Up to this share of a mesh cycle they may move; a contact
#: that moves farther is outside the linear model (``validation.validity.flags.REVERSAL_LIMITS``).
_FORCE_MARGIN = 0.02
#: Quantity whose size scales the difference when the reference does not vary, as y without friction.
COMPANION = {"y_p": "x_p", "y_g": "x_g", "friction_force": "normal_load"}


@dataclass(frozen=True)
class Agreement:
    """How one quantity of the multibody model agrees with the lumped model.

    Attributes
    ----------
    quantity, unit, long_name : the compared quantity; tooth forces at "exact" are sums over the pairs
    fidelity : "linear" or "exact"
    difference : largest difference over ``scale``; of y at fidelity "exact" see ``_off_line``
    scale : peak to peak of the lumped history, or a larger scale (``_scale``), in ``unit``
    peak_to_peak, peak_to_peak_multibody : of both histories, in ``unit``
    limit, reason : largest ``difference`` within the limit, and the reason for the limit
    """

    quantity: str
    unit: str
    long_name: str
    fidelity: Fidelity
    difference: float
    scale: float
    peak_to_peak: float
    peak_to_peak_multibody: float
    limit: float
    reason: str

    @property
    def within(self) -> bool:
        """Whether the difference is within the limit. NaN is not within the limit."""
        return self.difference <= self.limit

    @property
    def judgement(self) -> Judgement:
        """The difference against its limit."""
        kind = "same equations" if self.fidelity == "linear" else "exact"
        return Judgement(f"{kind}: {self.quantity}", self.difference, self.limit, self.reason)


def is_constant(values: FloatArray, driver: FloatArray | float = 0.0) -> bool:
    """Whether a history varies by rounding alone. A difference relative to the variation then means nothing.

    driver : history of a quantity that drives this history, so that rounding of the driver moves the history
    """
    size = float(np.abs(values).max())
    size_of_driver = float(np.abs(driver).max())
    return bool(np.ptp(values) <= max(_CONSTANT * size, _DRIVEN * size_of_driver, np.finfo(float).tiny))


def off_switch_samples(pair: GearPair, time: FloatArray, margin: float = _SWITCH_MARGIN) -> BoolArray:
    """Whether each time [s] (k,) lies clear of every switch of the nominal mesh cycle and of its start.

    margin : least distance from a switch, in mesh cycles
    """
    cycle = MeshCycle.of(pair.healthy)
    phase = np.mod(time / cycle.period, 1.0)
    nearest = np.abs(phase[:, None] - cycle.edges / cycle.period).min(axis=1)
    return np.asarray(nearest > margin, dtype=np.bool_)


def agreement(
    pair: GearPair,
    quantity: str,
    fidelity: Fidelity,
    candidate: xr.Dataset,
    reference: xr.Dataset,
    limit: tuple[float, str],
) -> Agreement:
    """Compare one quantity of a multibody motion with the quantity of the lumped motion at the same times.

    pair : times near the switches of this pair are left out
    candidate, reference : the multibody motion and the lumped motion
    limit : the result of ``verdict.limit_of``: largest difference within the limit, and the reason
    Raises NumericalError : a value is not finite
    """
    exact = fidelity == "exact"

    def history(motion: xr.Dataset, name: str) -> FloatArray:
        values = motion[name].to_numpy()
        return np.asarray(values.sum(axis=0) if exact and values.ndim == 2 else values, dtype=np.float64)

    by_pair = reference[quantity].ndim == 2
    margin = _FORCE_MARGIN if exact and by_pair else _SWITCH_MARGIN
    keep = off_switch_samples(pair, reference["time"].to_numpy(), margin)
    a, b = (history(motion, quantity)[..., keep] for motion in (candidate, reference))
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise NumericalError(
            f"{quantity} is not finite at fidelity '{fidelity}'; lower the torque or the speed."
        )
    _, unit, long_name = VARIABLES[quantity]
    scale = float(np.ptp(b))
    companion = history(reference, COMPANION.get(quantity, quantity))
    constant = is_constant(b, companion if quantity in COMPANION else 0.0)
    if constant:
        scale = max(float(np.abs(companion).max()), np.finfo(float).tiny)
    elif exact:
        scale = max(scale, _scale(quantity, history(reference, "dte"), b))
    difference = float(np.abs(a - b).max()) / scale
    if exact and not constant and quantity in ("y_p", "y_g"):
        gear = pair.bearings.pinion if quantity == "y_p" else pair.bearings.gear
        pushed = float(np.ptp(history(reference, "friction_force")[keep])) / gear.oloa_stiffness
        difference = _off_line(a - b, scale, max(pushed, abs(float(b.mean()))))
    return Agreement(
        quantity=quantity,
        unit=unit,
        long_name=long_name,
        fidelity=fidelity,
        difference=difference,
        scale=scale,
        peak_to_peak=float(np.ptp(b)),
        peak_to_peak_multibody=float(np.ptp(a)),
        limit=limit[0],
        reason=limit[1],
    )


def _scale(quantity: str, dte: FloatArray, history: FloatArray) -> float:
    """Least scale of the difference of a quantity at "exact", in the unit of the quantity.

    A gear centre moves with the changing part of the bearing load alone, so away from resonance the centre
    hardly swings. Along the line of action the displacement of the centre is a part of the transmission
    error, and the swing of the transmission error is the scale. The normal load of a slow pair is the static
    load: the load swings with the forces of inertia, which grow with the square of the speed. The scale of
    the load is the force that bends the teeth by the swing of the transmission error, and at most the static
    force.
    """
    swing = float(np.ptp(dte))
    if quantity in ("x_p", "x_g"):
        return swing
    if quantity == "normal_load":
        return float(history.mean()) * min(swing / abs(float(dte.mean())), 1.0)
    return 0.0


def _off_line(difference: FloatArray, swing: float, static: float) -> float:
    """Difference of a motion across the line of action: of the vibration or of the mean, the larger share.

    The scale of the vibration is the swing of y. The mean of y is no vibration: it is the deflection of the
    bearing by the mean of the friction force and of the force of tip corners. This mean is the same at any
    speed, but above resonance the swing of y falls with the speed. The mean of the friction force is the
    difference of friction in approach and in recess. So the scale of the mean is ``static``: the deflection
    by the swing of the friction force, or the mean of y, if larger.
    """
    mean = float(difference.mean())
    return max(float(np.abs(difference - mean).max()) / swing, abs(mean) / max(swing, static))
