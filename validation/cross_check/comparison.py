"""Cross-check: the lumped model against the independent multibody model, quantity by quantity.

Sources: docs/theory/multibody.md, "The verdict".
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import xarray as xr

import lumped
import multibody
from floquet.gear.motions import GearOrbit
from lumped import GearPair
from lumped.arguments import real_number, some_of, whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.display.result import DisplayedResult
from lumped.errors import ParameterError, SpurcheckError, refuse
from lumped.model.periodic_system import Supports, on_springs
from lumped.model.steady import UNSTABLE
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import Progress, ProgressRequest
from multibody.contact.machine import machine
from multibody.study.balance import PowerBalance
from validation.cross_check.agreement import FIDELITIES, QUANTITIES, Agreement, Fidelity, agreement
from validation.cross_check.conservation import conservation, lumped_motion
from validation.cross_check.losses import LossAgreement, loss_agreement, sliding_agreement
from validation.cross_check.motions import (
    CONTACT_LOSS,
    integration_tolerances,
    momentary_motion,
    periodic_motion,
    repeated,
    unilateral_orbit,
)
from validation.cross_check.own_teeth import both_motions
from validation.cross_check.stiffness import StiffnessAgreement, stiffness_agreement
from validation.cross_check.variant import asymmetric_variant
from validation.cross_check.verdict import LOAD_LIMIT, Judgement, Verdict, limit_of

#: Cycles at the end of a run that are compared where the exact model has no periodic motion.
_COMPARED_CYCLES = 4
#: Samples in a swing of the fastest mode, at least. Half of them tell the error of a quadrature: at six in a
#: swing Hermite's rule errs by (2 pi/6)^4/720, 0.2 %, and by a 16th of that at twelve.
_PER_SWING = 12
#: Most samples in a mesh cycle.
_MOST_SAMPLES = 65_536
#: Cycles of the asymmetric variant, and samples in each.
_VARIANT_CYCLES = 2
_VARIANT_SAMPLES = 64


@dataclass(frozen=True, eq=False, repr=False)
class CrossCheck(DisplayedResult):
    """Outcome of ``crosscheck``.

    Attributes
    ----------
    pair : the gear pair, without shafts; unlike teeth are counted from the first tooth of the computed cycles
    agreements : one per quantity and fidelity
    lumped : dataset of the lumped model, with which "exact" is compared
    multibody : fidelity -> dataset of the multibody model, at the same times
    periodic : whether "exact" is a periodic motion, repeated over the times, and not a run
    conservation : conservation laws, checked on both models
    stiffness : stiffness of a tooth pair, change of the stiffness with the load and coupling of neighbours,
        against second values, because both models read these quantities from one place
    powers : model -> power of ``power_balance.POWERS`` and "driving" -> mean over the mesh cycle [W]
    orbit : the compared lumped motion with loss of contact; None where teeth push all the time, or
        where no stable motion of one mesh cycle is found
    loss : lost power of both motions at "exact"; None where the multibody motion does not repeat
    pulling : why a motion in which teeth pull is compared; empty where teeth push
    variant : cross-check of a variation of the pair in which nothing is symmetric; None where the caller does
        not want the variant, or where no variation is sound
    """

    shown: ClassVar = (
        "verdict",
        "agrees",
        "periodic",
        "agreements",
        "conservation",
        "stiffness",
        "loss",
        "pulling",
        "failures",
        "variant",
    )

    pair: GearPair
    agreements: tuple[Agreement, ...]
    lumped: xr.Dataset
    multibody: Mapping[Fidelity, xr.Dataset]
    periodic: bool
    conservation: tuple[Judgement, ...]
    stiffness: tuple[StiffnessAgreement, ...]
    powers: Mapping[str, Mapping[str, float]]
    orbit: GearOrbit | None = None
    loss: LossAgreement | None = None
    pulling: str = ""
    variant: CrossCheck | None = None

    @property
    def judgements(self) -> tuple[Judgement, ...]:
        """Everything that must hold if the program is in order."""
        judgements = [a.judgement for a in self.of("linear")]
        judgements += self.conservation
        judgements += [a.judgement for a in self.stiffness]
        if self.variant is not None:
            judgements += [replace(j, check=f"variant: {j.check}") for j in self.variant.judgements]
        return tuple(judgements)

    @property
    def failures(self) -> tuple[Judgement, ...]:
        """Judgements beyond the limit. These are faults of the program, not of the model."""
        return tuple(j for j in self.judgements if not j.within)

    @property
    def verdict(self) -> Verdict:
        """Overall verdict."""
        if self.failures:
            return Verdict.FAILS
        if not (self.periodic and self.of("exact")):
            return Verdict.NOT_CHECKED
        motions = all(a.within for a in self.of("exact"))
        return Verdict.AGREES if motions and (self.loss is None or self.loss.within) else Verdict.DIFFERS

    @property
    def agrees(self) -> bool:
        """Whether the multibody model has the motion of the lumped model, within the limits."""
        return self.verdict is Verdict.AGREES

    def attribution(self, *, progress: ProgressRequest = None) -> xr.Dataset:
        """Return how much each finite-motion effect changes the motion, by ``multibody.attribution``.

        ``progress``: as of ``crosscheck``.
        """
        return multibody.attribution(self.pair, supports="springs", progress=progress)

    def power_balance(self, cycles: int = 20, *, fidelity: Fidelity = "exact") -> PowerBalance:
        """Return the power balance of a run of the multibody model, ``multibody.power_balance``.

        Parameters
        ----------
        cycles : mesh cycles of the run
        fidelity : "exact" or "linear"
        """
        return multibody.power_balance(self.pair, cycles, fidelity=fidelity, supports="springs")

    def of(self, fidelity: Fidelity) -> tuple[Agreement, ...]:
        """Agreements at one fidelity."""
        return tuple(a for a in self.agreements if a.fidelity == fidelity)

    def worst(self, fidelity: Fidelity) -> Agreement:
        """Agreement with the largest difference over the limit."""
        return max(self.of(fidelity), key=lambda a: a.difference / a.limit)


@shows_progress("cross-check")
def crosscheck(
    pair: AnyPair,
    *,
    cycles: int = 40,
    samples_per_cycle: int = 256,
    fidelities: Sequence[Fidelity] = FIDELITIES,
    limit: float = LOAD_LIMIT,
    variant: bool = True,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> CrossCheck:
    """Compare the lumped model with the multibody model of the same pair in periodic motion.

    At fidelity "linear" the equations are the same. Both models start from the lumped periodic solution, and
    the whole history is compared. A difference beyond integration error is a fault of the program.

    At "exact" the periodic motion of the multibody model is compared with the prediction on springs, whose
    contact follows the momentary load. The brake torque balances the losses of the multibody motion. (Under
    the brake torque of the lumped motion the speed would drift, and the phase with the speed.) The results
    are the largest difference over the peak to peak of the lumped motion, and the difference of the lost
    powers. Where one of these is beyond its limit, the lumped model is not accurate enough.

    Where the linear motion is unstable, or the exact model has no periodic motion near the lumped motion, the
    end of a run from the lumped motion is shown and not judged. Where the linear motion needs teeth that
    pull, the equations of "linear" are those with unilateral contact and the tangents of the static load
    (``floquet.periodic_orbit``), and "exact" is compared with this motion if no prediction is near.

    Both models read the stiffness of a tooth pair, the change of the stiffness with the load and the coupling
    of neighbouring pairs from one place. These are compared with second values (``stiffness_agreement``). A
    difference beyond its limit is a fault of the program too.

    Parameters
    ----------
    pair : a validated gear pair. With unlike teeth "exact" compares both models over a revolution of up to 64
        mesh cycles; in longer revolutions over 6 mesh cycles round the tooth with the largest load. Fidelity
        "linear" and the conservation laws then check the twin with like teeth
    cycles : mesh cycles to simulate, 6 to 100000
    samples_per_cycle : output times per mesh cycle, at least 32. Where the fastest mode is too fast for this
        number, more times are compared
    fidelities : of the multibody model, out of ``FIDELITIES``; without "exact" the verdict is "not checked"
    limit : largest difference, over the peak to peak, at which the transmission error, the tooth load and the
        motions along the line of action agree; for quantities driven by friction the limit is 0.2
    variant : whether to check a variation of the pair in which nothing is symmetric too, with few cycles
    supports : "springs", on which alone both models are compared; needed for a pair with shafts
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    CrossCheck

    Raises
    ------
    ParameterError : arguments out of range, or shafts
    NumericalError : a model fails; the text says what to try
    """
    progress = reported_to(progress)
    whole_number("cycles", cycles, 6, 100_000)
    whole_number("samples_per_cycle", samples_per_cycle, 32, _MOST_SAMPLES)
    limit = real_number("limit", limit, 0.0, 1.0, above=True, action="Give a share: 5 % is 0.05.")
    chosen = some_of("fidelities", fidelities, FIDELITIES)
    if not chosen or len(set(chosen)) != len(chosen):
        raise refuse("fidelities", ", ".join(chosen), "at least one, each once", "Correct the list.")
    with_unlike_teeth = on_springs(load_gear_pair(pair), supports, "crosscheck")
    pair = with_unlike_teeth.healthy
    varied = asymmetric_variant(pair) if variant and len(fidelities) == len(FIDELITIES) else None
    share = 0.75 if varied is not None else 1.0

    def part(low: float, high: float) -> Progress:
        def tell(fraction: float, stage: str = "", /) -> None:
            if progress is not None:
                progress(low + (high - low) * fraction)

        return tell

    check = _compared(pair, cycles, samples_per_cycle, fidelities, limit, part(0.0, share))
    if with_unlike_teeth is not pair:
        check = _with_own_teeth(check, with_unlike_teeth, samples_per_cycle, limit)
    if varied is None:
        return check
    try:
        of_variant = _compared(varied, _VARIANT_CYCLES, _VARIANT_SAMPLES, fidelities, limit, part(share, 1.0))
    except SpurcheckError:  # a model refuses the variant or cannot compute it
        return check
    return replace(check, variant=of_variant)


def _with_own_teeth(check: CrossCheck, pair: GearPair, samples: int, limit: float) -> CrossCheck:
    """Replace "exact" in the cross-check of the twin with like teeth by "exact" of the unlike teeth."""
    if "exact" not in check.multibody:
        return replace(check, pair=pair)
    pair, reference, exact = both_motions(pair, samples)
    agreements = [
        agreement(pair, quantity, "exact", exact, reference, limit_of(quantity, "exact", limit))
        for quantity in QUANTITIES
    ]
    return replace(
        check,
        pair=pair,
        agreements=(*check.of("linear"), *agreements),
        lumped=reference,
        multibody={**check.multibody, "exact": exact},
        periodic=True,
        orbit=None,
        loss=sliding_agreement(reference, exact),
        pulling="",
    )


def _too_slow(pair: GearPair, vibrations: float, samples_per_cycle: int) -> ParameterError:
    """Refusal of a speed at which a mesh cycle lasts too many vibrations of the fastest mode."""
    rpm = pair.operating.pinion_speed * 30.0 / math.pi
    most = _MOST_SAMPLES // samples_per_cycle * samples_per_cycle
    least = rpm * _PER_SWING * vibrations / most
    return refuse(
        "operating.pinion_speed",
        f"{rpm:.4g} rpm",
        f">= {1.006 * least:.3g} rpm for a cross-check",
        f"A mesh cycle lasts {vibrations:.0f} vibrations of the fastest mode, and both models follow each of "
        "them. So slow a pair hardly vibrates: check it at a higher speed, or use static_transmission_error.",
    )


def _compared(
    pair: GearPair,
    cycles: int,
    samples_per_cycle: int,
    fidelities: Sequence[Fidelity],
    limit: float,
    progress: Progress,
) -> CrossCheck:
    """The cross-check of one pair with like teeth, without the variant."""
    # A multiple of the requested samples, so that the samples show the fastest vibration.
    numbers = machine(pair)
    every = -int(-_PER_SWING * numbers.vibrations_per_cycle // samples_per_cycle)
    samples = every * samples_per_cycle
    if samples > _MOST_SAMPLES:
        raise _too_slow(pair, numbers.vibrations_per_cycle, samples_per_cycle)
    runs = 1 + len(fidelities)

    def part(done: int) -> Progress:
        return lambda fraction, stage="", /: progress((done + fraction) / runs)

    orbit, pulling = unilateral_orbit(pair)
    weighted = None
    if orbit is None:
        weighted = lumped_motion(pair)
        # Where mu(xi) is steep the periodic solution may err by some 1e-6. The error decays in a run.
        stable = weighted.motion.spectral_radius <= UNSTABLE
        reference = lumped.simulate(
            pair,
            cycles,
            samples_per_cycle=samples,
            initial="periodic",
            supports="springs",
            progress=part(0),
        )
    else:
        stable = True
        reference = repeated(orbit.sampled(samples), cycles)
    cycle = reference.isel(time=slice(-samples - 1, -1))
    rtol = integration_tolerances({name: cycle[name].to_numpy() for name in QUANTITIES})
    results: dict[Fidelity, xr.Dataset] = {}
    exact: xr.Dataset | None = None
    for done, fidelity in enumerate(fidelities, 1):
        periodic = None
        # At "linear" without contact loss a run shows more than the periodic motion: the whole history.
        if stable and (fidelity == "exact" or orbit is not None):
            periodic = periodic_motion(pair, fidelity, samples, rtol[fidelity], orbit)
        if fidelity == "exact":
            exact = periodic
        if periodic is not None:
            results[fidelity] = repeated(periodic, cycles)
            part(done)(1.0)
            continue
        results[fidelity] = multibody.simulate(
            pair,
            cycles=cycles,
            samples_per_cycle=samples,
            initial="periodic" if orbit is None else orbit.states[0],
            effects=None if orbit is None else CONTACT_LOSS[fidelity],
            fidelity=fidelity,
            rtol=rtol[fidelity],
            supports="springs",
            progress=part(done),
        )
    # A periodic motion with exact contact is compared with the prediction, in which no pair pulls.
    momentary = None if exact is None or pulling else momentary_motion(pair, cycle, samples)
    best = reference if momentary is None else repeated(momentary, cycles)
    compared = min(_COMPARED_CYCLES, cycles // 2) if exact is None else 1
    end = slice(-compared * samples - 1, None)
    agreements = []
    for fidelity, result in results.items():
        a, b = (result, reference) if fidelity == "linear" else (d.isel(time=end) for d in (result, best))
        agreements += [
            agreement(pair, quantity, fidelity, a, b, limit_of(quantity, fidelity, limit))
            for quantity in QUANTITIES
        ]
    checks, powers = conservation(pair, numbers, cycle, results, weighted, periodic=exact is not None)
    return CrossCheck(
        pair=pair,
        agreements=tuple(agreements),
        lumped=best.isel(time=slice(None, None, every)),
        multibody={f: run.isel(time=slice(None, None, every)) for f, run in results.items()},
        periodic=exact is not None,
        conservation=checks,
        stiffness=stiffness_agreement(pair),
        powers=powers,
        orbit=orbit,
        loss=None if exact is None else loss_agreement(pair, best, exact),
        pulling=pulling,
    )
