"""The prediction beside the second program, and what both must conserve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from lumped.labelling import labelled_dataset
from lumped.outcomes import Absent
from validation.cross_check.conservation import worst_of_each
from validation.cross_check.losses import LossAgreement
from validation.cross_check.stiffness import StiffnessAgreement
from validation.cross_check.words import MEASURES, percent
from validation.plots.prediction import overlay_figure
from validation.prediction.motion import PLACES
from validation.reporting.blocks import Badge, Block, Content, Picture, Quantity, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    check = results.check
    second = results.second
    springs = results.in_place_of_shafts
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
    blocks.append(
        table_of(
            "agreement",
            f"Largest difference of the second program, as a share{springs}.",
            check.agreements,
            {
                "quantity": ("quantity", lambda a: a.long_name),
                "fidelity": ("second program", lambda a: _FIDELITY[a.fidelity]),
                "difference": ("difference", lambda a: a.difference),
                "limit": ("limit", lambda a: a.limit),
                "state": ("", lambda a: Badge("ok" if a.within else "differs")),
            },
            MEASURES,
        )
    )
    if check.loss is not None:
        blocks.append(_losses(check.loss, springs))
    blocks.append(
        table_of(
            "conservation",
            f"Conservation laws, checked on both programs{springs}: of each the check that uses most of its "
            "limit.",
            worst_of_each(check.conservation),
            {
                "check": ("check", lambda j: j.check),
                "value": ("residual", lambda j: j.value),
                "limit": ("limit", lambda j: j.limit),
                "state": ("", lambda j: Badge("ok" if j.within else "failed")),
            },
        )
    )
    blocks += [_elasticity(check.stiffness), Text(_ONE_SOURCE)]
    if isinstance(second, Absent):
        blocks.append(Text(str(second)))
    return Content(results.second_words, tuple(blocks))


def _elasticity(agreements: Sequence[StiffnessAgreement]) -> Table:
    """Stiffness, its change with the load and the coupling of neighbours beside their second values."""
    return table_of(
        "elasticity",
        "Stiffness of the teeth, which both programs read from one place, against second values over the "
        "mesh cycle.",
        agreements,
        {
            "quantity": ("quantity", lambda a: a.long_name),
            "source": ("second value", lambda a: a.source),
            "difference": ("difference", lambda a: a.difference),
            "limit": ("limit", lambda a: a.limit),
            "state": ("", _badge),
        },
    )


def _badge(agreement: StiffnessAgreement) -> Badge:
    """Verdict on one elastic quantity; a check that would not see the quantity left out says so."""
    if not agreement.within:
        return Badge("failed")
    telling = agreement.telling or agreement.size == 0.0
    return Badge("ok") if telling else Badge("ok", "ok, smaller than the limit")


def _losses(loss: LossAgreement, springs: str) -> Table:
    """Mean losses of both programs, place by place; ``springs`` is added where shafts are left out."""
    both = [*((PLACES[p], loss.lumped[p], loss.multibody.get(p, 0.0)) for p in loss.lumped)]
    both.append(("all places", loss.total, loss.total_multibody))
    return table_of(
        "losses_of_both",
        f"Power lost in both programs{springs}. Their sums differ by {percent(loss.difference)}, limit "
        f"{percent(loss.limit)}: {'they agree' if loss.within else 'they do not agree'}.",
        both,
        {
            "place": ("place", lambda row: row[0]),
            "lumped": ("lumped model", lambda row: Quantity(row[1], "W")),
            "second": ("second program", lambda row: Quantity(row[2], "W")),
        },
    )


_ONE_SOURCE = (
    "A formula that is coded a second time checks the code and not the formula. What speaks for the formulas "
    "themselves is on the page about the stiffness of the teeth."
)

_FIDELITY = {"linear": "same equations", "exact": "exact contact, finite motions"}


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
