"""Cross-check: the lumped model against the independent multibody model, quantity by quantity.

Sources: docs/theory/multibody.md, "The law of torque"; docs/theory/validity.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

import multibody
from floquet.gear.orbit import GearOrbit
from lumped import GearPair
from lumped.arguments import some_of, whole_number
from lumped.errors import SpurcheckError, refuse
from lumped.model.results import VARIABLES
from lumped.model.steady import UNSTABLE, periodic_cycle
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray, Progress
from multibody.contact.machine import machine
from validation.cross_check import metrics
from validation.cross_check.agreement import (
    FIDELITIES,
    QUANTITIES,
    Agreement,
    Fidelity,
    agreement,
    contact_shift,
    off_switch_samples,
)
from validation.cross_check.compared_motions import (
    BLUNT,
    PARTED,
    integration_tolerances,
    lumped_motion,
    near_periodic,
    repeated,
)
from validation.cross_check.finite_motion import FiniteMotion, finite_motion
from validation.cross_check.first_order import Effects, first_order
from validation.cross_check.judgement import MEANINGS, Judgement, Verdict, verdict_of
from validation.cross_check.metrics import MeshOrders
from validation.cross_check.nature import laws_of_nature, laws_where_teeth_part
from validation.cross_check.parted_motion import parted_orbit
from validation.cross_check.tolerances import raw_tolerance, tolerance
from validation.cross_check.twin import unlike_twin

__all__ = [
    "FIDELITIES",
    "MEANINGS",
    "QUANTITIES",
    "Agreement",
    "CrossCheck",
    "Fidelity",
    "OrderComparison",
    "Verdict",
    "crosscheck",
    "off_switch_samples",
]

#: Cycles at the end of a run over which the exact model is compared where it has no periodic motion.
COMPARED_CYCLES = 4
_ORDERS = 10
#: Samples in a swing of the fastest mode, at least. Half of them tell the error of a quadrature: at six in a
#: swing Hermite's rule errs by (2 pi/6)^4/720, 0.2 %, and by a 16th of that at twelve.
_PER_SWING = 12
#: Samples of the motion that tells its size.
_COARSE = 64
#: Cycles of the unlike twin where its exact motion repeats, else as many more; and samples in each.
_TWIN_CYCLES, _TWIN_SAMPLES = (2, 6), 64


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
    periodic : whether "exact" is the periodic motion of that model, repeated over the times, and not a run
    cycles, compared_cycles : numbers of mesh cycles simulated, and of those at the end compared for "exact"
    rtol : relative tolerance of the integration of "lumped", "linear" and "exact"
    contact_shift : mean shift of the contact by finite motions, over the base pitch
    finite_motion : what finite motions must change, predicted from the lumped model; None without "exact"
    effects : what each finite-motion effect can change and changes; None without "exact"
    unsettled : fidelity -> change of the multibody transmission error over the last two cycles, over its peak
        to peak: what is left of the transient; of a periodic motion, its relative mismatch after a cycle
    nature : laws of nature, checked on both models; empty unless both fidelities ran
    powers : model -> power of ``ledger.POWERS`` and "driving" -> mean over the mesh cycle [W]; likewise
    orbit : the lumped motion with loss of contact that is compared; None where teeth push all the time, or
        where no stable one of one mesh cycle is found
    twin : the same of a variation of the pair in which nothing is symmetric; None where it was not asked for
    """

    pair: GearPair
    agreements: tuple[Agreement, ...]
    orders: tuple[OrderComparison, ...]
    lumped: xr.Dataset
    multibody: Mapping[Fidelity, xr.Dataset]
    periodic: bool
    cycles: int
    compared_cycles: int
    rtol: Mapping[str, float]
    contact_shift: float
    finite_motion: FiniteMotion | None
    effects: Effects | None
    unsettled: Mapping[Fidelity, float]
    nature: tuple[Judgement, ...]
    powers: Mapping[str, Mapping[str, float]]
    orbit: GearOrbit | None = None
    twin: CrossCheck | None = None

    @property
    def judgements(self) -> tuple[Judgement, ...]:
        """Everything that must hold."""
        found = [*(j for a in self.agreements for j in a.judgements), *self.nature]
        found += [
            Judgement(f"{fidelity}: compared", 1.0, 0.0, "a verdict needs both fidelities")
            for fidelity in FIDELITIES
            if not self.of(fidelity)
        ]
        if self.twin is not None:
            found += [replace(j, check=f"twin: {j.check}") for j in self.twin.judgements]
        return tuple(found)

    @property
    def failures(self) -> tuple[Judgement, ...]:
        """What does not hold; with any of them the verdict is "not confirmed"."""
        return tuple(j for j in self.judgements if not j.within)

    @property
    def verdict(self) -> Verdict:
        """Overall verdict, see ``MEANINGS``."""
        return verdict_of(self.judgements, [j for a in self.agreements for j in a.raw])

    @property
    def worst_of_each(self) -> tuple[Judgement, ...]:
        """Of each kind of check (linear, remainder, nature ...) the one that uses most of its limit."""
        kinds: dict[str, list[Judgement]] = {}
        for judgement in self.judgements:
            kinds.setdefault(judgement.check.split(":")[0], []).append(judgement)
        return tuple(max(found, key=lambda j: j.value / j.limit) for found in kinds.values())

    def of(self, fidelity: Fidelity) -> tuple[Agreement, ...]:
        """Agreements at one fidelity."""
        return tuple(a for a in self.agreements if a.fidelity == fidelity)

    def worst(self, fidelity: Fidelity) -> Agreement:
        """Agreement that uses most of its tolerance."""
        return max(self.of(fidelity), key=lambda a: a.judged / a.tolerance.limit)


def crosscheck(
    pair: AnyPair,
    *,
    cycles: int = 40,
    samples_per_cycle: int = 256,
    fidelities: Sequence[Fidelity] = FIDELITIES,
    quantities: Sequence[str] = QUANTITIES,
    twin: bool = True,
    progress: Progress | None = None,
) -> CrossCheck:
    """Compare the lumped model with the multibody model of the same pair in periodic motion.

    At fidelity "linear" the equations are the same: both models start from the lumped periodic solution and
    the whole history is compared; the lumped one repeats after a few cycles, if it is stable. At "exact" the
    model's own periodic motion is compared, with the brake torque that balances its own losses: under the
    lumped one it would drift, and the phase with it. Where the lumped motion is unstable, or the exact model
    has no periodic motion near it, the end of a run from the lumped motion is compared. Samples on a switch
    time are left out: they belong to either side. Where the linear motion needs teeth that pull, the lumped
    motion is the one with teeth that push only (``floquet.periodic_orbit``), and so are the equations of
    "linear".

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles to simulate, 6 to 100000
    samples_per_cycle : output times per mesh cycle, at least 32; more are compared where the fastest mode
        swings so fast that these would not show it
    fidelities : of the multibody model, out of ``FIDELITIES``
    quantities : out of ``QUANTITIES``
    twin : whether to check a variation of the pair in which nothing is symmetric too, with few cycles
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
    return _compared(load_gear_pair(pair), cycles, samples_per_cycle, fidelities, quantities, twin, progress)


def _compared(
    pair: GearPair,
    cycles: int,
    samples_per_cycle: int,
    fidelities: Sequence[Fidelity] = FIDELITIES,
    quantities: Sequence[str] = QUANTITIES,
    twin: bool = False,
    progress: Progress | None = None,
) -> CrossCheck:
    """What ``crosscheck`` returns; where both motions repeat themselves, two cycles tell as much as many."""
    other = unlike_twin(pair) if twin and len(fidelities) == len(FIDELITIES) else None
    runs = 1 + len(fidelities) + (other is not None)
    # So many times as many samples as asked for, that the vibration is seen.
    every = -int(-_PER_SWING * machine(pair).vibrations_per_cycle // samples_per_cycle)
    samples = every * samples_per_cycle

    def part(done: int) -> Progress:
        def tell(fraction: float, stage: str = "", /) -> None:
            if progress is not None:
                progress((done + fraction) / runs)

        return tell

    orbit = parted_orbit(pair)
    if orbit is None:
        motion = periodic_cycle(pair, _COARSE)
        stable = motion.spectral_radius <= UNSTABLE
        rtol = integration_tolerances(motion.values)
        reference = lumped_motion(pair, cycles, samples, rtol["lumped"], stable, part(0))
    else:
        stable = True
        one_cycle = orbit.sampled(samples)
        rtol = integration_tolerances({name: one_cycle[name].to_numpy() for name in QUANTITIES})
        reference = repeated(one_cycle, cycles)
    shift = contact_shift(pair, reference)
    last = reference.isel(time=slice(-samples - 1, -1))
    results: dict[Fidelity, xr.Dataset] = {}
    predicted: FiniteMotion | None = None
    effects: Effects | None = None
    one: xr.Dataset | None = None
    for done, fidelity in enumerate(fidelities, 1):
        if fidelity == "exact":
            predicted = finite_motion(pair, last, orbit=orbit)
            if stable:
                one = near_periodic(pair, fidelity, samples, rtol[fidelity], predicted.settled, orbit)
            if one is not None and one.attrs["friction_velocity"] == BLUNT:  # a choice of the numerics
                predicted = finite_motion(pair, last, friction_velocity=BLUNT, orbit=orbit)
            effects = first_order(predicted)
        found = one
        if fidelity == "linear" and orbit is not None:
            found = near_periodic(pair, fidelity, samples, rtol[fidelity], True, orbit)
        if found is not None:
            results[fidelity] = repeated(found, cycles)
            part(done)(1.0)
            continue
        results[fidelity] = multibody.simulate(
            pair,
            cycles=cycles,
            samples_per_cycle=samples,
            initial="periodic" if orbit is None else orbit.states[0],
            effects=None if orbit is None else PARTED[fidelity],
            fidelity=fidelity,
            rtol=rtol[fidelity],
            progress=part(done),
        )
    compared = min(COMPARED_CYCLES, cycles // 2) if one is None else 1
    agreements: list[Agreement] = []
    orders: list[OrderComparison] = []
    for fidelity, result in results.items():
        first = 0 if fidelity == "linear" else (cycles - compared) * samples
        shifts = predicted.shifts if fidelity == "exact" and predicted is not None else None
        beyond = 0.0 if shifts is None else shifts.beyond / pair.geometry.base_pitch
        keep = off_switch_samples(pair, reference["time"].to_numpy(), beyond)
        keep[:first] = False
        if fidelity == "exact" and predicted is not None:
            keep &= predicted.clear(reference["time"].to_numpy())
        for quantity in quantities:
            if predicted is None or effects is None or fidelity == "linear":
                limit = tolerance(quantity, fidelity, shift)
                agreements.append(agreement(quantity, fidelity, result, reference, keep, limit, 0.0))
            else:
                largest = effects.largest(quantity)
                agreements.append(
                    agreement(
                        quantity,
                        fidelity,
                        result,
                        reference,
                        keep,
                        tolerance(quantity, fidelity, shift, largest, effects.unpredicted(quantity)),
                        predicted.over(quantity, keep.size),
                        raw_tolerance(largest, shift),
                        {effect: changes[quantity] for effect, changes in effects.alone.items()},
                    )
                )
            orders.append(_orders(quantity, fidelity, result, reference, compared, samples))
    checks: tuple[Judgement, ...] = ()
    powers: Mapping[str, Mapping[str, float]] = {}
    if effects is not None and len(fidelities) == len(FIDELITIES):
        push = np.zeros(6) if predicted is None else predicted.push
        if orbit is None:
            checks, powers = laws_of_nature(pair, last, one, results, effects.powers, shift, push)
        else:
            checks, powers = laws_where_teeth_part(pair, last, one, results, shift, push)
    unsettled = {f: _unsettled(r, samples) for f, r in results.items()}
    if one is not None:
        unsettled["exact"] = float(one.attrs["closure"])
    return CrossCheck(
        pair=pair,
        agreements=tuple(agreements),
        orders=tuple(orders),
        lumped=reference.isel(time=slice(None, None, every)),
        multibody={f: run.isel(time=slice(None, None, every)) for f, run in results.items()},
        periodic=one is not None,
        cycles=cycles,
        compared_cycles=compared,
        rtol=rtol,
        contact_shift=shift,
        finite_motion=predicted,
        effects=effects,
        unsettled=unsettled,
        nature=checks,
        powers=powers,
        orbit=orbit,
        twin=None if other is None else _check_twin(other, part(runs - 1)),
    )


def _check_twin(pair: GearPair, progress: Progress) -> CrossCheck | None:
    """Cross-check of the twin; None where a model refuses it or cannot compute it."""
    try:
        for cycles in _TWIN_CYCLES:
            found = _compared(pair, cycles, _TWIN_SAMPLES, progress=progress)
            if found.periodic:
                break
    except SpurcheckError:
        return None
    return found


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
    whole_number("cycles", cycles, 6, 100_000)
    whole_number("samples_per_cycle", samples, 32, 65536)
    for field, given, known in (
        ("fidelities", fidelities, FIDELITIES),
        ("quantities", quantities, QUANTITIES),
    ):
        chosen = some_of(field, given, known)
        if not chosen or len(set(chosen)) != len(chosen):
            raise refuse(field, ", ".join(chosen), "at least one, each once", "Correct the list.")
