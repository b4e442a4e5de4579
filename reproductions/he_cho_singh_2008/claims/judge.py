"""The claims table: each statement of the paper as a number with a verdict and its sensitivity."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import xarray as xr

from lumped.schema.files import AnyPair
from lumped.typing import Progress
from reproductions.he_cho_singh_2008.claims import numbers as claim_numbers
from reproductions.he_cho_singh_2008.claims.rules import RULES, ClaimRule, Numbers
from reproductions.he_cho_singh_2008.claims.sensitivity import (
    ASSUMPTIONS,
    SEED,
    Sensitivity,
    sample_assumptions,
)
from reproductions.he_cho_singh_2008.operating_points import papers_pair
from reproductions.he_cho_singh_2008.records import Claim, ClaimsTable, ClaimVerdict, Number, Statement

ACCURACY = "3 % error"

_TEXT = (
    "Each statement of the paper's results and conclusions is turned into one number with a stated "
    "definition and a criterion. As the paper assumes, flanks are without relief, in contact from A to D. "
    "The criteria put numbers on words that the paper leaves open. The value "
    "holds at the stated assumptions; the share says in how many samples of a Latin hypercube over "
    "everything the paper does not give the criterion is met. Samples whose motion is unstable or loses "
    "contact are left out of a claim on that motion. A verdict with a share between 10 and 90 % depends on "
    "the assumptions."
)


def claims(
    pair: AnyPair,
    *,
    samples: int = 100,
    runs: xr.Dataset | None = None,
    progress: Progress | None = None,
) -> ClaimsTable:
    """Judge every claim of the paper.

    Parameters
    ----------
    pair : the gear pair with its stated assumptions
    samples : of the Latin hypercube over the assumptions; 0 leaves the sensitivity out
    runs : laws I to IV in both models (``law_runs``), to state the claims' numbers for the multibody twin too
    progress : called with the finished fraction of the hypercube

    Returns
    -------
    ClaimsTable

    Raises
    ------
    NumericalError : the pair has no periodic motion at an operating point of the paper
    """
    pair = papers_pair(pair)
    stated = claim_numbers.measure(pair)
    varied = sample_assumptions(pair, samples, progress=progress) if samples else None
    twin = {} if runs is None else twin_numbers(runs)
    return ClaimsTable(
        text=_TEXT,
        ranges={a.name: str(a) for a in ASSUMPTIONS} if varied else {},
        samples=samples,
        failed=0 if varied is None else varied.failed,
        seed=SEED,
        claims=tuple(judged(rule, stated, varied, twin) for rule in RULES),
    )


def judged(
    rule: ClaimRule, stated: Numbers, varied: Sensitivity | None, twin: dict[str, dict[str, Number]]
) -> Claim:
    """One claim with its verdict.

    Parameters
    ----------
    rule : the statement
    stated : claim numbers at the stated assumptions
    varied : claim numbers over the hypercube
    twin : claim name -> numbers of the multibody twin
    """
    value = rule.value(stated)
    # What was not published cannot be judged, and a motion that no pair would follow proves nothing.
    reason = " ".join(filter(None, (rule.unpublished, rule.unusable(stated))))
    verdict: ClaimVerdict = (
        "cannot be judged" if reason else "reproduced" if rule.holds(stated) else "not reproduced"
    )
    if not reason:
        reason = rule.remark if verdict == "reproduced" else rule.otherwise
    share = low = high = None
    usable = 0
    if varied is not None:
        rows = [row for row in varied.numbers if not rule.unusable(row)]
        usable = len(rows)
        if rows:
            values = np.array([rule.value(row) for row in rows])
            low, high = (float(p) for p in np.percentile(values, (5, 95)))
            # The one claim on an accuracy is met where the number stays within it.
            met = np.abs(values / value - 1.0) <= 0.03 if rule.name == ACCURACY else map(rule.holds, rows)
            share = float(np.mean(list(met)))
    return Claim(
        **{field.name: getattr(rule, field.name) for field in fields(Statement)},
        value=value,
        verdict=verdict,
        reason=reason,
        details=rule.further(stated) | twin.get(rule.name, {}),
        share=share,
        usable=usable,
        low=low,
        high=high,
    )


def twin_numbers(runs: xr.Dataset) -> dict[str, dict[str, Number]]:
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
            "multibody twin, largest": Number(100 * spread, "% of the mean load"),
            "multibody twin, rms": Number(100 * rms, "% of the mean load"),
        },
        "LOA motion and DTE": {
            "multibody twin, x_p": Number(100 * motions["x_p"][0], span),
            "multibody twin, DTE": Number(100 * motions["dte"][0], span),
        },
        "OLOA motion": {"multibody twin": Number(100 * motions["y_p"][0], span)},
        "second harmonic": {
            "multibody twin, y_p": Number(claim_numbers.largest_order(one, "y_p"), "mesh order")
        },
        "8 % discrepancy": {"multibody twin": Number(50 * (motions["x_p"][1] + motions["y_p"][1]), span)},
    }
