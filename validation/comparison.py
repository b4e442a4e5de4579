"""Cross-check: the lumped model against the independent multibody model, quantity by quantity."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import xarray as xr

import lumped
import multibody
from lumped import GearPair
from lumped.errors import NumericalError, refuse
from lumped.results import VARIABLES
from validation import metrics
from validation.metrics import FloatArray, MeshOrders, SpragueGeers
from validation.sliding_effect import sliding_effect
from validation.tolerances import GROUPS, LOST, Tolerance, stiffness_jumps, tolerance

Fidelity = Literal["linear", "exact"]
Verdict = Literal["confirmed", "bounded", "not confirmed"]
Progress = Callable[[float], None]

QUANTITIES: tuple[str, ...] = tuple(GROUPS)
FIDELITIES: tuple[Fidelity, ...] = ("linear", "exact")
#: Verdict -> what it means.
MEANINGS: Mapping[str, str] = {
    "confirmed": "the multibody model gives the same motion within the stated tolerances",
    "bounded": "the equations agree, and the effect of finite motions is stated but larger than expected",
    "not confirmed": "the multibody model does not support the lumped prediction",
}
#: Tolerances of the integrations: far below the limits they are used to check.
RTOL: Mapping[str, float] = {"lumped": 1e-10, "linear": 1e-10, "exact": 1e-8}
#: A sample this close to a switch, in mesh cycles, may lie on either side of the jump by rounding alone.
_SWITCH_MARGIN = 1e-6
#: Cycles at the end over which the exact model is compared, after its transient has died out.
COMPARED_CYCLES = 4
#: Quantity whose size scales the difference when the reference does not vary, as y without friction.
_COMPANION = {
    "y_p": "x_p",
    "y_g": "x_g",
    "friction_force": "normal_load",
}
_ORDERS = 10


@dataclass(frozen=True)
class Agreement:
    """How one quantity of the multibody model agrees with the lumped model.

    Attributes
    ----------
    quantity, unit, long_name : what is compared
    fidelity : "linear" or "exact"
    relative_l2 : L2 norm of the difference over that of the lumped history
    remainder_l2 : the same after the predicted effect of the actual sliding velocity on the exact model
        (``validation.sliding_effect``) is added to the lumped history
    maximum_over_span, rms_over_span, mean_shift : difference over the peak to peak of the lumped history:
        largest, root mean square, of the means (signed)
    peak_to_peak_ratio : multibody over lumped; None where the lumped history does not vary
    sprague_geers : of the oscillations about the means; None likewise
    tolerance : metric judged, limit and reason
    """

    quantity: str
    unit: str
    long_name: str
    fidelity: Fidelity
    relative_l2: float
    remainder_l2: float
    maximum_over_span: float
    rms_over_span: float
    mean_shift: float
    peak_to_peak_ratio: float | None
    sprague_geers: SpragueGeers | None
    tolerance: Tolerance

    @property
    def judged(self) -> float:
        """Value of the metric that the tolerance limits."""
        return float(getattr(self, self.tolerance.metric))

    @property
    def within(self) -> bool:
        """Whether the judged metric is within its limit."""
        return self.judged <= self.tolerance.limit


@dataclass(frozen=True, eq=False)
class OrderComparison:
    """Mesh orders of one quantity in both models; of tooth forces, of the sum over the pairs in contact."""

    quantity: str
    unit: str
    fidelity: Fidelity
    lumped: MeshOrders
    multibody: MeshOrders

    @property
    def phase_difference(self) -> FloatArray:
        """Phase of multibody - lumped per order [rad]."""
        return metrics.phase_difference(self.multibody.phase, self.lumped.phase)


@dataclass(frozen=True, eq=False)
class CrossCheck:
    """Outcome of ``crosscheck``.

    Attributes
    ----------
    pair : the gear pair
    agreements : one per quantity and fidelity
    orders : mesh orders of both models, per quantity and fidelity
    lumped : dataset of the lumped model
    multibody : fidelity -> dataset of the multibody model, at the same times
    cycles, compared_cycles : mesh cycles simulated, and those at the end over which "exact" is compared
    contact_shift : mean shift of the contact by finite motions, over the base pitch
    unsettled : fidelity -> change of the multibody transmission error over the last two cycles, over its peak
        to peak: what is left of the transient
    """

    pair: GearPair
    agreements: tuple[Agreement, ...]
    orders: tuple[OrderComparison, ...]
    lumped: xr.Dataset
    multibody: Mapping[Fidelity, xr.Dataset]
    cycles: int
    compared_cycles: int
    contact_shift: float
    unsettled: Mapping[Fidelity, float]

    @property
    def verdict(self) -> Verdict:
        """Overall verdict, see ``MEANINGS``."""
        return overall_verdict(self.agreements)

    def of(self, fidelity: Fidelity) -> tuple[Agreement, ...]:
        """Agreements at one fidelity."""
        return tuple(a for a in self.agreements if a.fidelity == fidelity)

    def worst(self, fidelity: Fidelity) -> Agreement:
        """Agreement that uses most of its tolerance."""
        return max(self.of(fidelity), key=lambda a: a.judged / a.tolerance.limit)


def overall_verdict(agreements: Sequence[Agreement]) -> Verdict:
    """Verdict from single agreements.

    "not confirmed": a quantity disagrees at fidelity "linear", or the transmission error of the exact model
    differs by more than ``tolerances.LOST``, or one of the two fidelities is missing; "bounded": one of
    the exact model's quantities exceeds its tolerance; else "confirmed".
    """
    linear = [a for a in agreements if a.fidelity == "linear"]
    exact = [a for a in agreements if a.fidelity == "exact"]
    if not linear or not exact or not all(a.within for a in linear):
        return "not confirmed"
    if any(a.quantity == "dte" and a.relative_l2 > LOST for a in exact):
        return "not confirmed"
    return "confirmed" if all(a.within for a in exact) else "bounded"


def crosscheck(
    pair: GearPair,
    *,
    cycles: int = 40,
    samples_per_cycle: int = 256,
    fidelities: Sequence[Fidelity] = FIDELITIES,
    quantities: Sequence[str] = QUANTITIES,
    progress: Progress | None = None,
) -> CrossCheck:
    """Compare the lumped model with the multibody model of the same pair in settled periodic motion.

    Every model starts from the periodic solution of the lumped model. At fidelity "linear" the equations are
    the same, so the whole history is compared; at "exact" the last cycles are, when the multibody model has
    settled to its own periodic motion. Samples on a switch time are left out: they belong to either side.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles to simulate, 6 to 100000
    samples_per_cycle : output times per mesh cycle, at least 32
    fidelities : of the multibody model, out of ``FIDELITIES``
    quantities : out of ``QUANTITIES``
    progress : called with the finished fraction

    Returns
    -------
    CrossCheck

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : a model fails; the text says what to try
    """
    _check(cycles, samples_per_cycle, fidelities, quantities)
    runs = 1 + len(fidelities)

    def part(done: int) -> Progress | None:
        return None if progress is None else lambda fraction: progress((done + fraction) / runs)

    options = {"cycles": cycles, "samples_per_cycle": samples_per_cycle, "initial": "periodic"}
    reference = lumped.simulate(pair, **options, rtol=RTOL["lumped"], progress=part(0))  # type: ignore[arg-type]
    results: dict[Fidelity, xr.Dataset] = {}
    for done, fidelity in enumerate(fidelities, 1):
        results[fidelity] = multibody.simulate(
            pair,
            **options,  # type: ignore[arg-type]
            fidelity=fidelity,
            rtol=RTOL[fidelity],
            progress=part(done),
        )
    shift = contact_shift(pair, reference)
    jumps = stiffness_jumps(pair)
    sliding = sliding_effect(pair, reference.isel(time=slice(-samples_per_cycle - 1, -1)))
    compared = min(COMPARED_CYCLES, cycles // 2)
    agreements: list[Agreement] = []
    orders: list[OrderComparison] = []
    for fidelity, result in results.items():
        first = 0 if fidelity == "linear" else (cycles - compared) * samples_per_cycle
        keep = off_switch_samples(pair, reference["time"].to_numpy())
        keep[:first] = False
        for quantity in quantities:
            limit = tolerance(quantity, fidelity, shift, jumps)
            predicted = sliding.over(quantity, keep.size) if fidelity == "exact" else 0.0
            agreements.append(agreement(quantity, fidelity, result, reference, keep, limit, predicted))
            orders.append(_orders(quantity, fidelity, result, reference, compared, samples_per_cycle))
    return CrossCheck(
        pair=pair,
        agreements=tuple(agreements),
        orders=tuple(orders),
        lumped=reference,
        multibody=results,
        cycles=cycles,
        compared_cycles=compared,
        contact_shift=shift,
        unsettled={f: _unsettled(r, samples_per_cycle) for f, r in results.items()},
    )


def contact_shift(pair: GearPair, motion: xr.Dataset) -> float:
    """Mean shift of the contact by finite motions, over the base pitch, from a lumped motion."""
    g = lumped.geometry(pair)
    return float(np.mean(np.abs(motion["theta_p"].to_numpy()))) * g.base_radius_pinion / g.base_pitch


def off_switch_samples(pair: GearPair, time: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which times [s] (k,) lie clear of every switch of the nominal mesh cycle, starts of cycles included."""
    cycle = lumped.mesh_cycle(pair)
    phase = np.mod(time / cycle.period, 1.0)
    switches = np.concatenate([cycle.edges / cycle.period])
    nearest = np.abs(phase[:, None] - switches).min(axis=1)
    return np.asarray(nearest > _SWITCH_MARGIN, dtype=np.bool_)


def agreement(
    quantity: str,
    fidelity: Fidelity,
    candidate: xr.Dataset,
    reference: xr.Dataset,
    keep: np.ndarray[tuple[int], np.dtype[np.bool_]],
    limit: Tolerance,
    predicted: FloatArray | float,
) -> Agreement:
    """Compare one quantity of a multibody motion with the lumped one.

    Parameters
    ----------
    quantity, fidelity : what is compared
    candidate, reference : multibody and lumped motion at the same times
    keep : (k,) which of these times count, see ``off_switch_samples``
    limit : tolerance of the judged metric
    predicted : change by the actual sliding velocity, see ``validation.sliding_effect``

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
    if metrics.is_constant(b):
        companion = reference[_COMPANION.get(quantity, quantity)].to_numpy()
        scale = max(float(np.abs(companion).max()), np.finfo(float).tiny)
        rms = float(np.sqrt(np.mean((a - b) ** 2))) / scale
        l2 = remainder = rms
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
        remainder_l2=remainder,
        maximum_over_span=largest,
        rms_over_span=rms,
        mean_shift=shift,
        peak_to_peak_ratio=ratio,
        sprague_geers=oscillation,
        tolerance=limit,
    )


def _orders(
    quantity: str,
    fidelity: Fidelity,
    candidate: xr.Dataset,
    reference: xr.Dataset,
    compared: int,
    samples: int,
) -> OrderComparison:
    def analysed(result: xr.Dataset) -> MeshOrders:
        values = result[quantity].to_numpy()
        total = values.sum(axis=0) if values.ndim == 2 else values
        # The grid ends on the last cycle's end, which is the first sample of a cycle that is not there.
        return metrics.mesh_orders(total[-compared * samples - 1 : -1], samples, _ORDERS)

    unit = VARIABLES[quantity][1]
    return OrderComparison(quantity, unit, fidelity, analysed(reference), analysed(candidate))


def _unsettled(result: xr.Dataset, samples: int) -> float:
    dte = result["dte"].to_numpy()[:-1]
    last, before = dte[-samples:], dte[-2 * samples : -samples]
    return float(np.abs(last - before).max()) / max(float(np.ptp(last)), np.finfo(float).tiny)


def _check(cycles: int, samples: int, fidelities: Sequence[str], quantities: Sequence[str]) -> None:
    if not 6 <= cycles <= 100_000:
        raise refuse("cycles", cycles, "6 to 100000", "Choose a number in that range.")
    if not 32 <= samples <= 65536:
        raise refuse("samples_per_cycle", samples, "32 to 65536", "Choose a number in that range.")
    for field, given, known in (
        ("fidelities", fidelities, FIDELITIES),
        ("quantities", quantities, QUANTITIES),
    ):
        for name in given:
            if name not in known:
                raise refuse(field, repr(name), ", ".join(known), "Choose among these.")
        if not given or len(set(given)) != len(given):
            raise refuse(field, list(given), "at least one, each once", "Correct the list.")
