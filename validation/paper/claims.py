"""The claims table: each statement of the paper as a number with a verdict and its sensitivity."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from lumped import GearPair
from validation.paper import claim_numbers
from validation.paper.claim_rules import RULES, ClaimRule, Numbers
from validation.paper.figures.record import number
from validation.paper.operating_points import conditions
from validation.paper.records import Claim, ClaimsTable, ClaimVerdict
from validation.paper.sensitivity import ASSUMPTIONS, Sensitivity, measure, sample_assumptions

Progress = Callable[[float], None]

_TEXT = (
    "Each statement of the paper's results and conclusions is turned into one number with a stated "
    "definition and a criterion. The criteria put numbers on words that the paper leaves open. The value "
    "holds at the stated assumptions; the share says in how many samples of a Latin hypercube over "
    "everything the paper does not give the criterion is met. A verdict with a share between 10 and 90 % "
    "depends on the assumptions."
)


def claims(
    pair: GearPair,
    *,
    samples: int = 100,
    seed: int = 2008,
    runs: xr.Dataset | None = None,
    progress: Progress | None = None,
) -> ClaimsTable:
    """Judge every claim of the paper.

    Parameters
    ----------
    pair : the gear pair with its stated assumptions
    samples : of the Latin hypercube over the assumptions; 0 leaves the sensitivity out
    seed : of the hypercube
    runs : laws I to IV in both models (``law_runs``), to state the claims' numbers for the multibody twin too
    progress : called with the finished fraction of the hypercube

    Returns
    -------
    ClaimsTable

    Raises
    ------
    NumericalError : the pair has no periodic motion at an operating point of the paper
    """
    stated = measure(pair)
    varied = sample_assumptions(pair, samples, seed=seed, progress=progress) if samples else None
    twin = {} if runs is None else twin_numbers(runs)
    return ClaimsTable(
        title="Claims of the paper",
        text=_TEXT,
        conditions=conditions(pair),
        ranges={a.name: str(a) for a in ASSUMPTIONS} if varied else {},
        samples=samples,
        failed=0 if varied is None else varied.failed,
        seed=seed,
        claims=tuple(judged(rule, stated, varied, twin) for rule in RULES),
    )


def judged(
    rule: ClaimRule, stated: Numbers, varied: Sensitivity | None, twin: dict[str, dict[str, str]]
) -> Claim:
    """One claim with its verdict.

    Parameters
    ----------
    rule : the statement
    stated : claim numbers at the stated assumptions
    varied : claim numbers over the hypercube
    twin : claim name -> numbers of the multibody twin
    """
    value, holds = rule.value(stated), rule.holds(stated)
    verdict: ClaimVerdict = (
        "cannot be judged" if rule.unpublished else "reproduced" if holds else "not reproduced"
    )
    share = low = high = None
    if varied is not None:
        rows = [{k: float(v[j]) for k, v in varied.numbers.items()} for j in range(varied.size)]
        values = np.array([rule.value(row) for row in rows])
        low, high = (float(p) for p in np.percentile(values, (5, 95)))
        if rule.name == "3 % error":
            share = float(np.mean(np.abs(values / value - 1.0) <= 0.03))
        else:
            share = float(np.mean([rule.holds(row) for row in rows]))
    details = {name: number(function(stated), unit) for name, (function, unit) in rule.details.items()}
    if rule.name == "regime change" and varied is not None:
        # Roughness and oil place the change; its form does not depend on them.
        abrupt = [w <= 0.2 and d >= 1.2 for w, d in _pairs(varied, "switch_width", "switch_drop")]
        details["share of samples with an abrupt change, at any speed"] = number(
            100 * float(np.mean(abrupt)), "%"
        )
    details |= twin.get(rule.name, {})
    return Claim(
        name=rule.name,
        statement=rule.statement,
        definition=rule.definition,
        value=value,
        unit=rule.unit,
        criterion=rule.criterion,
        verdict=verdict,
        text=_text(rule, value, verdict, share),
        details=details,
        share=share,
        low=low,
        high=high,
    )


def _pairs(varied: Sensitivity, first: str, second: str) -> list[tuple[float, float]]:
    return list(zip(varied.numbers[first].tolist(), varied.numbers[second].tolist(), strict=True))


#: Claim and verdict -> what explains it.
_REMARKS = {
    ("regime change", "reproduced"): "The speed itself is calibrated: composite roughness and viscosity were "
    "chosen to meet it. What is reproduced is that the change is abrupt.",
    ("regime change", "not reproduced"): "The speed depends on composite roughness and viscosity, which are "
    "calibrated for the 28/28 pair only.",
    ("pitch point", "reproduced"): "Both follow from the laws' form: III goes with |SR|^1.04, II with the "
    "logarithm of 1/v_s up to its bound.",
    (
        "jumps",
        "reproduced",
    ): "Where a tooth pair takes up its stiffness at once, the friction force of every law "
    "also jumps as pairs enter and leave; the claim is about the pitch point.",
    (
        "OLOA motion",
        "not reproduced",
    ): "Off the line of action friction is the only excitation, so the motion follows the coefficient.",
    (
        "second harmonic",
        "not reproduced",
    ): "The spread follows the amplitudes, which are largest at another order.",
}


def _text(rule: ClaimRule, value: float, verdict: ClaimVerdict, share: float | None) -> str:
    parts = [f"{number(value, rule.unit)}; criterion: {rule.criterion}."]
    if rule.unpublished:
        parts.append(rule.unpublished)
    parts.append(_REMARKS.get((rule.name, verdict), ""))
    if share is not None:
        parts.append(f"Met in {100 * share:.0f} % of the samples of the assumptions.")
        if verdict != "cannot be judged" and 0.1 < share < 0.9:
            parts.append("The verdict depends on the assumptions.")
    return " ".join(part for part in parts if part)


def twin_numbers(runs: xr.Dataset) -> dict[str, dict[str, str]]:
    """The claims' numbers on the motions for the multibody twin: claim name -> number -> text.

    Parameters
    ----------
    runs : of ``law_runs``; empty without a multibody twin
    """
    if "multibody" not in runs["model"]:
        return {}
    one = runs.sel(model="multibody")
    spread, rms = claim_numbers.load_spread(one)
    motions = {name: claim_numbers.motion_differences(one, name) for name in ("x_p", "y_p", "dte")}
    span = "% of the peak to peak"
    return {
        # At a jump the largest spread over time only sees that the laws' jumps are not at the same instant.
        "normal load": {
            "multibody twin, largest": number(100 * spread, "% of the mean load"),
            "multibody twin, rms": number(100 * rms, "% of the mean load"),
        },
        "LOA motion and DTE": {
            "multibody twin, x_p": number(100 * motions["x_p"][0], span),
            "multibody twin, DTE": number(100 * motions["dte"][0], span),
        },
        "OLOA motion": {"multibody twin": number(100 * motions["y_p"][0], span)},
        "second harmonic": {
            "multibody twin, y_p": number(claim_numbers.largest_order(one, "y_p"), "mesh order")
        },
        "8 % discrepancy": {"multibody twin": number(50 * (motions["x_p"][1] + motions["y_p"][1]), span)},
    }
