"""The prediction beside the second program, and the conservation laws of both."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from lumped.labelling import labelled_dataset
from lumped.outcomes import Absent
from validation.cross_check.agreement import Agreement
from validation.cross_check.comparison import CrossCheck
from validation.cross_check.conservation import worst_of_each
from validation.cross_check.losses import LossAgreement
from validation.cross_check.stiffness import StiffnessAgreement
from validation.cross_check.verdict import Judgement
from validation.cross_check.words import MEASURES, percent
from validation.plots.prediction import overlay_figure
from validation.prediction.motion import PLACES
from validation.reporting.blocks import Badge, Block, Column, Content, Picture, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.second_program_words import second_program_words

_FIDELITY = {"linear": "same equations", "exact": "exact contact, finite motions"}
_ONE_SOURCE = (
    "A formula that is coded a second time checks the code and not the formula. What speaks for the formulas "
    "themselves is on the page about the stiffness of the teeth."
)


def write(results: Results) -> Content:
    """Write the chapter."""
    check = results.check
    second = results.second
    if isinstance(check, Absent):
        return Content("The second program does not run here.", (Text(check.detail),))
    blocks: list[Block] = []
    if not isinstance(second, Absent):
        blocks.append(
            Picture(
                "overlay",
                "The prediction and the second program over one mesh cycle; below, their difference.",
                overlay(results),
                overlay_figure,
            )
        )
    blocks.append(_agreement_table(check, results.in_place_of_shafts))
    if check.loss is not None:
        blocks.append(_losses_table(check.loss, results.in_place_of_shafts))
    blocks.append(_conservation_table(check, results.in_place_of_shafts))
    blocks += [_elasticity_table(check.stiffness), Text(_ONE_SOURCE)]
    if isinstance(second, Absent):
        blocks.append(Text(str(second)))
    return Content(second_program_words(results), tuple(blocks))


def _agreement_table(check: CrossCheck, springs: str) -> Table:
    """Differences of all quantities. ``springs``: words of the caption where the shafts are left out."""
    return table_of(
        "agreement",
        f"Largest difference of the second program, as a share{springs}.",
        check.agreements,
        (
            Column[Agreement]("quantity", "quantity", lambda agreement: agreement.long_name),
            Column[Agreement]("fidelity", "second program", lambda agreement: _FIDELITY[agreement.fidelity]),
            Column[Agreement]("difference", "difference", lambda agreement: agreement.difference),
            Column[Agreement]("limit", "limit", lambda agreement: agreement.limit),
            Column[Agreement]("state", "", lambda agreement: Badge("ok" if agreement.within else "differs")),
        ),
        MEASURES,
    )


def _conservation_table(check: CrossCheck, springs: str) -> Table:
    """For each conservation law the check that uses most of its limit."""
    return table_of(
        "conservation",
        f"Conservation laws, checked on both programs{springs}: of each the check that uses most of its "
        "limit.",
        worst_of_each(check.conservation),
        (
            Column[Judgement]("check", "check", lambda law: law.check),
            Column[Judgement]("value", "residual", lambda law: law.value),
            Column[Judgement]("limit", "limit", lambda law: law.limit),
            Column[Judgement]("state", "", lambda law: Badge("ok" if law.within else "failed")),
        ),
    )


def _elasticity_table(agreements: Sequence[StiffnessAgreement]) -> Table:
    """Stiffness, its change with the load and the coupling of neighbours beside their second values."""
    return table_of(
        "elasticity",
        "Stiffness of the teeth, which both programs read from one place, against second values over the "
        "mesh cycle.",
        agreements,
        (
            Column[StiffnessAgreement]("quantity", "quantity", lambda agreement: agreement.long_name),
            Column[StiffnessAgreement]("source", "second value", lambda agreement: agreement.source),
            Column[StiffnessAgreement]("difference", "difference", lambda agreement: agreement.difference),
            Column[StiffnessAgreement]("limit", "limit", lambda agreement: agreement.limit),
            Column[StiffnessAgreement]("state", "", _badge),
        ),
    )


def _badge(agreement: StiffnessAgreement) -> Badge:
    """Verdict on one elastic quantity. A check that would not see the quantity left out says so."""
    if not agreement.within:
        return Badge("failed")
    telling = agreement.telling or agreement.size == 0.0
    return Badge("ok") if telling else Badge("ok", "ok, smaller than the limit")


class _Loss(NamedTuple):
    """A row of the table of losses: the place and the mean loss there in both programs [W]."""

    place: str
    lumped: float
    multibody: float


def _losses_table(loss: LossAgreement, springs: str) -> Table:
    """Mean losses of both programs by place. ``springs``: words of the caption where shafts are left out."""
    losses = [
        _Loss(PLACES[place], lumped, loss.multibody.get(place, 0.0)) for place, lumped in loss.lumped.items()
    ]
    losses.append(_Loss("all places", loss.total, loss.total_multibody))
    return table_of(
        "losses_of_both",
        f"Power lost in both programs{springs}. Their sums differ by {percent(loss.difference)}, limit "
        f"{percent(loss.limit)}: {'they agree' if loss.within else 'they do not agree'}.",
        losses,
        (
            Column[_Loss]("place", "place", lambda row: row.place),
            Column[_Loss]("lumped", "lumped model", lambda row: row.lumped, "W"),
            Column[_Loss]("second", "second program", lambda row: row.multibody, "W"),
        ),
    )


def overlay(results: Results) -> xr.Dataset:
    """Transmission error of the prediction and of the second program over one mesh cycle."""
    second = results.second
    assert not isinstance(second, Absent)
    period = results.pair.geometry.mesh_period
    phase = np.arange(257) / 256.0
    curves = {}
    for name, motion in (("prediction", results.like), ("second", second)):
        time = motion.cycle["time"].to_numpy() / period
        curves[name] = np.interp(
            phase, np.mod(time, 1.0) if motion is second else time, motion.cycle["dte"].to_numpy(), period=1.0
        )
    return labelled_dataset(
        {
            "prediction": ("cycle", curves["prediction"], "m", "prediction"),
            "second": ("cycle", curves["second"], "m", "second program"),
            "difference": (
                "cycle",
                curves["second"] - curves["prediction"],
                "m",
                "second program less prediction",
            ),
        },
        {"cycle": (phase, "mesh cycles", "time")},
    )


CHAPTER = Chapter("second_program", "Second program", write, seconds=4.0)
