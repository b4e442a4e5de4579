"""One point of the regression grid: two periodic motions, what finite motions change, and what is left."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import numpy as np

import lumped
from lumped import GearPair
from lumped.model.results import load_range
from lumped.typing import FloatArray
from validation.cross_check.agreement import (
    FIDELITIES,
    QUANTITIES,
    agreement,
    contact_shift,
    off_switch_samples,
    relative_size,
)
from validation.cross_check.compared_motions import BLUNT, periodic_motion
from validation.cross_check.finite_motion import finite_motion
from validation.cross_check.metrics import maximum_over_span
from validation.cross_check.parted_motion import parted_orbit
from validation.cross_check.tolerances import tolerance
from validation.validity.flags import LOAD_NOISE

#: What can come of a point.
COMPARED, SEPARATED, STICKING = STATES = ("compared", "teeth separate", "sliding may stick")
#: Names of ``GridPoint.numbers``.
NUMBERS = (
    *("status", "load_min", "seconds", "expected"),
    *(
        f"{table}_{fidelity}_{quantity}"
        for table in ("judged", "limit", "total", "largest")
        for fidelity in FIDELITIES
        for quantity in QUANTITIES
    ),
)
_RTOL = 1e-9


def _missing() -> FloatArray:
    return np.full((len(FIDELITIES), len(QUANTITIES)), np.nan)


@dataclass(frozen=True, eq=False)
class GridPoint:
    """Outcome of one point; arrays are (fidelity, quantity), NaN where nothing was compared.

    Attributes
    ----------
    status : ``COMPARED``, ``SEPARATED`` or ``STICKING``
    load_min : smallest normal load of the linear motion over the static load; negative: its teeth pull
    seconds : processor time
    expected : largest change of the transmission error that finite motions must make, over its peak to peak
    judged, limit : metric that the tolerance limits, and the tolerance
    total : relative L2 of the whole difference, before anything predicted is taken off
    largest : largest difference over the peak to peak of the lumped motion
    """

    status: str
    load_min: float = np.nan
    seconds: float = 0.0
    expected: float = np.nan
    judged: FloatArray = field(default_factory=_missing)
    limit: FloatArray = field(default_factory=_missing)
    total: FloatArray = field(default_factory=_missing)
    largest: FloatArray = field(default_factory=_missing)

    def numbers(self) -> tuple[float, ...]:
        """The numbers that ``NUMBERS`` names; the status is its place in ``STATES``."""
        tables = np.concatenate(
            [table.ravel() for table in (self.judged, self.limit, self.total, self.largest)]
        )
        return (STATES.index(self.status), self.load_min, self.seconds, self.expected, *tables.tolist())


def compare_point(pair: GearPair, samples: int) -> GridPoint:
    """Compare the models in periodic motion.

    Parameters
    ----------
    pair : a validated gear pair
    samples : output times per mesh cycle

    Raises
    ------
    SpurcheckError : a model fails

    Notes
    -----
    Which points are judged is decided by the lumped model alone, before the multibody model is looked at: the
    lumped motion is that with teeth that push only where a lumped load turns negative, and teeth separate
    where no stable one of one mesh cycle is found; sliding may stick where the lumped motion and the friction
    at its own sliding velocity do not settle or do not pass zero (``validation.cross_check.finite_motion``).
    """
    started = time.process_time()

    def spent() -> float:
        return time.process_time() - started

    reference = lumped.steady_state(pair, samples_per_cycle=samples)
    static = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    loads = reference["normal_load"].to_numpy(), reference["contact"].to_numpy()
    load_min = min(load_range(pair.mesh.contact, *loads)[1], 0.0) / static
    orbit = None
    if load_min < -LOAD_NOISE:
        orbit = parted_orbit(pair)
        if orbit is None:
            return GridPoint(SEPARATED, load_min, spent())
        reference = orbit.sampled(samples)
    shift, predicted = contact_shift(pair, reference), finite_motion(pair, reference, orbit=orbit)
    keep = off_switch_samples(pair, reference["time"].to_numpy())
    dte = reference["dte"].to_numpy()[keep]
    expected = maximum_over_span(dte + predicted.over("dte", keep.size)[keep], dte)
    tables = [_missing() for _ in range(4)]
    for i, fidelity in enumerate(FIDELITIES):
        run = periodic_motion(
            pair, fidelity, samples=samples, rtol=_RTOL, passes=predicted.settled, orbit=orbit
        )
        foreseen = predicted
        if fidelity == "exact" and run.attrs["friction_velocity"] == BLUNT:  # a choice of the numerics
            foreseen = finite_motion(pair, reference, friction_velocity=BLUNT, orbit=orbit)
        clear = keep & foreseen.clear(reference["time"].to_numpy()) if fidelity == "exact" else keep
        histories = {quantity: reference[quantity].to_numpy()[..., clear] for quantity in QUANTITIES}
        for j, quantity in enumerate(QUANTITIES):
            change: FloatArray | float = 0.0
            size = 0.0
            if fidelity == "exact":
                change = foreseen.over(quantity, keep.size)
                size = relative_size(change[..., clear], quantity, histories)
            allowed = tolerance(quantity, fidelity, shift, size)
            found = agreement(quantity, fidelity, run, reference, clear, allowed, change)
            values = found.judged, allowed.limit, found.relative_l2, found.maximum_over_span
            for table, value in zip(tables, values, strict=True):
                table[i, j] = value
    return GridPoint(COMPARED if predicted.settled else STICKING, load_min, spent(), expected, *tables)
