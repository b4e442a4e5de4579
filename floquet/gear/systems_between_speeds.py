"""The feedback block of a gear pair between any two speeds: one fit of the gains, factors and a deviation.

Sources: docs/theory/proven_bounds.md, "The nearest unstable speed".
"""

from __future__ import annotations

import math
import warnings

import numpy as np

from floquet.gear.axes import GEAR_AXES, GearVariation, operating_rpm
from floquet.gear.friction_between_speeds import FrictionBetweenSpeeds, SpeedPatch
from floquet.gear.gains import Intervals, friction_reach
from floquet.gear.multipliers import OffLineOfAction, feedback_system, fitted_block
from floquet.rank_one.boxes import GainDeviation, slow_period
from floquet.rank_one.kernel_input import packed
from floquet.rank_one.kernels.gains import Problem
from floquet.rank_one.period_search import PatchSystem
from floquet.rank_one.system import RankOneSystem
from lumped.errors import LawRangeWarning
from lumped.typing import FloatArray

_RTOL = 1e-12  # of the polynomials of the gains
_WORK_OF_FIT = 4  # patches that take as long as a fit of the gains


class SystemsBetweenSpeeds:
    """`SystemOverPeriod` of a gear pair: one fit of the gains for each reference speed of friction."""

    def __init__(self, variation: GearVariation) -> None:
        self.variation = variation
        self.friction = FrictionBetweenSpeeds(variation)
        self.widest = self.friction.widest
        self._fits: dict[tuple[float, float | None, Intervals | None], tuple[RankOneSystem, Problem]] = {}
        feedback = feedback_system(variation)
        off_line = OffLineOfAction.of(feedback)
        self.separate_fade = bool((off_line.exponents.real + off_line.errors < 0.0).all())
        self.pitch = feedback.system.cycle.geometry.base_pitch
        self.period_times_rpm = feedback.system.period * operating_rpm(variation.pair)
        self.reach = friction_reach(feedback.system, feedback.metric)

    def _fit(self, patch: SpeedPatch) -> tuple[RankOneSystem, Problem]:
        """The feedback block at the reference speed of a patch, once for each reference."""
        key = patch.reference, patch.level, patch.acts
        if key not in self._fits:
            levels = [] if self.friction.none else [0.0]
            levels += [] if patch.level is None else [patch.level]
            with warnings.catch_warnings():
                # A result at the operating speed tells where a law leaves its range.
                warnings.simplefilter("ignore", LawRangeWarning)
                at_reference = GEAR_AXES["speed_rpm"].apply(self.variation, patch.reference)
                system = fitted_block(feedback_system(at_reference), 1.0, _RTOL, levels, patch.acts)
            self._fits[key] = system, packed(system)
        return self._fits[key]

    def __call__(self, shortest: float, longest: float) -> PatchSystem | None:
        """See `SystemOverPeriod`."""
        turns = self.period_times_rpm
        patch = self.friction.patch(turns / longest, turns / shortest)
        return None if patch is None else self.of(patch)

    def of(self, patch: SpeedPatch) -> PatchSystem:
        """The system that holds for all speeds of a patch."""
        turns = self.period_times_rpm
        work = 1 if (patch.reference, patch.level, patch.acts) in self._fits else _WORK_OF_FIT
        system, problem = self._fit(patch)

        def factors(T: FloatArray) -> FloatArray:
            return patch.factors(turns / T)[:, : len(system.varied)]

        return PatchSystem(system, problem, factors, self._deviation(patch), work)

    def _deviation(self, patch: SpeedPatch) -> GainDeviation:
        """Integrals over the phase of what mu deviates by, times the gains by a unit of mu."""
        share = patch.deviation / self.pitch
        return GainDeviation(share * self.reach.w, share * self.reach.wd)

    def slow_period(self, shortest: float, longest: float) -> float:
        """Period [s] from which on all motions of the range are stable; inf: no such period is known."""
        turns = self.period_times_rpm
        patch = self.friction.bounds(turns / longest, turns / shortest)
        if patch is None:
            return math.inf
        system, _ = self._fit(patch)
        factors = patch.factors(np.array([turns / longest, turns / shortest]))[:, : len(system.varied)]
        return slow_period(system, np.ones(2), factors, self._deviation(patch))
