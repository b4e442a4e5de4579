"""How one quantity of the multibody model agrees with the lumped model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import xarray as xr

import lumped
from lumped import GearPair
from lumped.errors import NumericalError
from lumped.model.results import VARIABLES
from lumped.typing import FloatArray
from validation.cross_check import metrics
from validation.cross_check.judgement import Judgement
from validation.cross_check.metrics import SpragueGeers
from validation.cross_check.tolerances import GROUPS, LOST, LOST_REASON, Tolerance

Fidelity = Literal["linear", "exact"]

QUANTITIES: tuple[str, ...] = tuple(GROUPS)
FIDELITIES: tuple[Fidelity, ...] = ("linear", "exact")
#: A sample this close to a switch, in mesh cycles, may lie on either side of the jump by rounding alone.
_SWITCH_MARGIN = 1e-6
#: Quantity whose size scales the difference when the reference does not vary, as y without friction.
_COMPANION = {
    "y_p": "x_p",
    "y_g": "x_g",
    "friction_force": "normal_load",
}


@dataclass(frozen=True)
class Agreement:
    """How one quantity of the multibody model agrees with the lumped model.

    Attributes
    ----------
    quantity, unit, long_name : what is compared
    fidelity : "linear" or "exact"
    relative_l2 : L2 norm of the difference over that of the lumped history
    predicted_l2 : the same of what finite motions must change (``validation.cross_check.finite_motion``)
    remainder_l2 : the same of the difference after that change is taken off
    effects : finite-motion effect -> what it alone changes, likewise
    maximum_over_span, rms_over_span, mean_shift : difference over the peak to peak of the lumped history:
        largest, root mean square, of the means (signed)
    peak_to_peak_ratio : multibody over lumped; None where the lumped history does not vary
    sprague_geers : of the oscillations about the means; None likewise
    tolerance : metric judged, limit and reason
    raw_limit : of ``relative_l2``; None at fidelity "linear"
    """

    quantity: str
    unit: str
    long_name: str
    fidelity: Fidelity
    relative_l2: float
    predicted_l2: float
    remainder_l2: float
    maximum_over_span: float
    rms_over_span: float
    mean_shift: float
    peak_to_peak_ratio: float | None
    sprague_geers: SpragueGeers | None
    tolerance: Tolerance
    raw_limit: Tolerance | None = None
    effects: Mapping[str, float] = field(default_factory=dict)

    @property
    def judged(self) -> float:
        """Value of the metric that the tolerance limits."""
        return float(getattr(self, self.tolerance.metric))

    @property
    def within(self) -> bool:
        """Whether the judged metric is within its limit."""
        return self.judged <= self.tolerance.limit

    @property
    def judgements(self) -> tuple[Judgement, ...]:
        """What must hold of this quantity."""
        limit = self.tolerance
        if self.fidelity == "linear":
            return (Judgement(f"linear: {self.quantity}", self.judged, limit.limit, limit.reason),)
        found = [Judgement(f"remainder: {self.quantity}", self.judged, limit.limit, limit.reason)]
        if self.quantity == "dte":
            found.append(Judgement("same motion: dte", self.relative_l2, LOST, LOST_REASON))
        return tuple(found)

    @property
    def whole_limit(self) -> float | None:
        """Limit of ``relative_l2``: what finite motions explain, and whether it is the same motion at all."""
        limits = [] if self.raw_limit is None else [self.raw_limit.limit]
        limits += [j.limit for j in self.judgements if j.check == "same motion: dte"]
        return min(limits, default=None)

    @property
    def raw(self) -> tuple[Judgement, ...]:
        """The whole difference against its limit; beyond it, it needs an explanation."""
        limit = self.raw_limit
        if limit is None:
            return ()
        return (Judgement(f"raw: {self.quantity}", self.relative_l2, limit.limit, limit.reason),)


def relative_size(change: FloatArray, quantity: str, reference: Mapping[str, FloatArray]) -> float:
    """Norm of a change over the norm of the history it changes.

    Of a history that does not vary, as y without friction: root mean square over the size of its companion.

    Parameters
    ----------
    change : change of the quantity, of the shape of its history
    quantity : a key of ``GROUPS``
    reference : quantity -> history
    """
    history = reference[quantity]
    if metrics.is_constant(history):
        companion = reference[_COMPANION.get(quantity, quantity)]
        scale = max(float(np.abs(companion).max()), np.finfo(float).tiny)
        return float(np.sqrt(np.mean(change**2))) / scale
    return float(np.linalg.norm(change) / np.linalg.norm(history))


def contact_shift(pair: GearPair, motion: xr.Dataset) -> float:
    """Mean shift of the contact by finite motions, over the base pitch, from a lumped motion."""
    g = pair.geometry
    return float(np.mean(np.abs(motion["theta_p"].to_numpy()))) * g.base_radius_pinion / g.base_pitch


def off_switch_samples(
    pair: GearPair, time: FloatArray, beyond: float = 0.0
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which times [s] (k,) lie clear of every switch of the nominal mesh cycle, starts of cycles included.

    ``beyond`` is the part of a cycle by which contact may go on beyond the nominal path, which is not
    predicted: a sample so close to an end may lie on either side of the jump there.
    """
    cycle = lumped.mesh_cycle(pair)
    phase = np.mod(time / cycle.period, 1.0)
    switches = cycle.edges / cycle.period
    nearest = np.abs(phase[:, None] - switches).min(axis=1)
    return np.asarray(nearest > _SWITCH_MARGIN + beyond, dtype=np.bool_)


def agreement(
    quantity: str,
    fidelity: Fidelity,
    candidate: xr.Dataset,
    reference: xr.Dataset,
    keep: np.ndarray[tuple[int], np.dtype[np.bool_]],
    limit: Tolerance,
    predicted: FloatArray | float,
    raw_limit: Tolerance | None = None,
    effects: Mapping[str, float] | None = None,
) -> Agreement:
    """Compare one quantity of a multibody motion with the lumped one.

    Parameters
    ----------
    quantity, fidelity : what is compared
    candidate, reference : multibody and lumped motion at the same times
    keep : (k,) which of these times count, see ``off_switch_samples``
    limit : tolerance of the judged metric
    predicted : change by finite motions, see ``validation.cross_check.finite_motion``; 0 where there are none
    raw_limit, effects : limit of the whole difference, and what each effect changes alone

    Raises
    ------
    NumericalError : a history is not finite
    """
    a, b = (d[quantity].to_numpy()[..., keep] for d in (candidate, reference))
    change = np.broadcast_to(predicted, reference[quantity].shape)[..., keep]
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        raise NumericalError(
            f"{quantity} is not finite at fidelity '{fidelity}'; lower the torque or the speed."
        )
    _, unit, long_name = VARIABLES[quantity]
    ratio: float | None = None
    oscillation: SpragueGeers | None = None
    foreseen = relative_size(change, quantity, {q: reference[q].to_numpy()[..., keep] for q in GROUPS})
    if metrics.is_constant(b):
        companion = reference[_COMPANION.get(quantity, quantity)].to_numpy()
        scale = max(float(np.abs(companion).max()), np.finfo(float).tiny)
        l2 = rms = float(np.sqrt(np.mean((a - b) ** 2))) / scale
        remainder = float(np.sqrt(np.mean((a - change - b) ** 2))) / scale
        largest = float(np.abs(a - b).max()) / scale
        shift = float(a.mean() - b.mean()) / scale
    else:
        l2, largest = metrics.relative_l2(a, b), metrics.maximum_over_span(a, b)
        remainder = metrics.relative_l2(a - change, b)
        rms, shift = metrics.rms_over_span(a, b), metrics.mean_shift(a, b)
        ratio = metrics.peak_to_peak_ratio(a, b)
        if not metrics.is_constant(a):
            oscillation = metrics.sprague_geers(a - a.mean(), b - b.mean())
    return Agreement(
        quantity=quantity,
        unit=unit,
        long_name=long_name,
        fidelity=fidelity,
        relative_l2=l2,
        predicted_l2=foreseen,
        remainder_l2=remainder,
        maximum_over_span=largest,
        rms_over_span=rms,
        mean_shift=shift,
        peak_to_peak_ratio=ratio,
        sprague_geers=oscillation,
        tolerance=limit,
        raw_limit=raw_limit,
        effects={} if effects is None else effects,
    )
