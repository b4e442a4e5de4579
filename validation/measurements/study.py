"""Does the identification work? Bias and coverage over many noise seeds, where the truth is known.

Sources: Fuller 1987 for the bias of plain least squares; see ``identification``.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import binom

from lumped.arguments import some_of, whole_number
from lumped.schema.pair import GearPair
from validation.measurements.alignment import align
from validation.measurements.identification import Identification, identify_friction
from validation.measurements.prediction import predict
from validation.measurements.synthetic import synthetic_measurement


@dataclass(frozen=True)
class StudyRow:
    """Bias and coverage of one way of identifying.

    Attributes
    ----------
    case : what was identified, and with which noise
    truth : the true value
    bias : mean error of the estimates over the truth
    bias_standard_error : of that mean, over the truth
    spread : standard deviation of the estimates over the truth
    stated_spread : mean standard error that the identification states, over the truth
    coverage : share of seeds whose interval contains the truth
    coverage_low, coverage_high : where the share of a correct interval falls with probability 0.99
    seeds : number of noise seeds
    """

    case: str
    truth: float
    bias: float
    bias_standard_error: float
    spread: float
    stated_spread: float
    coverage: float
    coverage_low: float
    coverage_high: float
    seeds: int


#: Case -> (law of the truth, noise of the record, how it is identified).
CASES: dict[str, tuple[str, dict[str, Any], dict[str, Any]]] = {
    "constant mu, white noise 2 %": ("coulomb", {}, {}),
    "constant mu, noise 2 % with correlation 0.7": ("coulomb", {"correlation": 0.7}, {}),
    "constant mu, noise 10 %": ("coulomb", {"noise_normal": 0.1, "noise_friction": 0.1}, {}),
    "constant mu, noise 10 %, not stated": (
        "coulomb",
        {"noise_normal": 0.1, "noise_friction": 0.1, "stated_noise": False},
        {},
    ),
    "constant mu, zero error 5 N": ("coulomb", {"zero": 5.0}, {"zero": True}),
    "scale on law III, white noise 2 %": ("xu_kahraman", {}, {"law": "xu_kahraman"}),
}


def identification_study(
    pair: GearPair,
    *,
    seeds: int = 200,
    cases: Collection[str] = tuple(CASES),
    mu: float = 0.05,
    scale: float = 1.3,
    level: float = 0.95,
) -> tuple[StudyRow, ...]:
    """Identify friction from synthetic records with known truth, over many noise seeds.

    Every record starts at an unknown mesh phase and is aligned by its normal loads against a prediction with
    the wrong friction, as a user's would be.

    Parameters
    ----------
    pair : a validated gear pair at the record's operating point
    seeds : noise seeds, 0 to seeds - 1
    cases : names out of ``CASES``. "not stated" shows what noise on N does to plain least squares: a bias of
    about
        minus its variance over the mean square of N
    mu : true constant coefficient
    scale : true scale on the Xu-Kahraman law
    level : of the intervals
    """
    seeds = whole_number("seeds", seeds, 10, 1_000_000, "Use 200.")
    some_of("cases", cases, CASES)
    constant = {"friction.law": "coulomb", "friction.coefficient": mu}
    truths = {
        "coulomb": predict(pair.with_(constant), recurrence=4),
        "xu_kahraman": predict(pair.with_({"friction.law": "xu_kahraman"}), recurrence=4),
    }
    guess = predict(pair.with_(constant | {"friction.coefficient": 0.5 * mu}), recurrence=4)
    rows = []
    for name in cases:
        law, noise, how = CASES[name]
        factor = 1.0 if law == "coulomb" else scale
        found: list[Identification] = []
        for seed in range(seeds):
            start = float(np.random.default_rng([seed, 1]).uniform(0.0, 4.0))
            record = synthetic_measurement(
                truths[law], seed=seed, engagements=4, start=start, scale=factor, **noise
            )
            found.append(identify_friction(record, guess, align(record, guess), level=level, **how))
        rows.append(_row(name, mu if law == "coulomb" else scale, found, level))
    return tuple(rows)


def _row(name: str, truth: float, found: list[Identification], level: float) -> StudyRow:
    values = np.array([f.estimate for f in found]) / truth
    inside = np.array([f.low <= truth <= f.high for f in found])
    n = len(found)
    low, high = binom.interval(0.99, n, level)
    return StudyRow(
        case=name,
        truth=truth,
        bias=float(values.mean() - 1.0),
        bias_standard_error=float(values.std(ddof=1) / np.sqrt(n)),
        spread=float(values.std(ddof=1)),
        stated_spread=float(np.mean([f.standard_error for f in found]) / truth),
        coverage=float(inside.mean()),
        coverage_low=float(low / n),
        coverage_high=float(high / n),
        seeds=n,
    )
