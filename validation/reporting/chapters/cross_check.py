"""Lumped against multibody: the verdict, the difference by quantity, conservation, overlays."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np
import xarray as xr

from lumped.model.results import VARIABLES
from multibody.run.effects import CAUSES
from validation.cross_check.agreement import Agreement, off_switch_samples
from validation.cross_check.comparison import CrossCheck
from validation.cross_check.conservation import fed_back
from validation.cross_check.power_balance import POWERS
from validation.cross_check.verdict import Judgement
from validation.plots.models import cross_check_figure
from validation.reporting.blocks import (
    Answer,
    Badge,
    Block,
    Content,
    Fact,
    Facts,
    Picture,
    Quantity,
    Rows,
    Table,
    Text,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.cross_check_words import NAMES, same_equations, whole_difference
from validation.reporting.formatting import number
from validation.reporting.results import Results
from validation.reporting.words import agreement, cautions

_SHOWN = ("dte", "x_p", "y_p", "normal_load", "friction_force")
_CAPTIONS = {
    "dte": "Dynamic transmission error of all models, and the difference of the exact model.",
    "x_p": "Motion of the pinion along the line of action. The gear moves likewise (table).",
    "y_p": "Motion of the pinion off the line of action, which friction alone drives.",
    "normal_load": "Normal load, sum of the pairs in contact. In the exact model teeth enter and leave where "
    "the deflected flanks cross the tip circles, so jumps move a little.",
    "friction_force": "Friction force, sum of the pairs in contact; two pairs in contact largely cancel.",
}
_CAUSES = CAUSES | {"all": "all together"}
_ATTRIBUTED = {"dte": "transmission error", "x_p": "pinion x", "y_p": "pinion y"}


def write(results: Results) -> Content:
    """Write the chapter."""
    check, g = results.check, results.geometry
    keep = off_switch_samples(results.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    blocks: list[Block] = [
        *cautions(results),
        Text(
            f"The verdict is “{check.verdict}”: {check.verdict.text}. {_motions(check)} "
            f"{same_equations(check)} {whole_difference(check)}"
        ),
        *_agreements(check),
        *(causes(results.attribution) if results.effort.full else ()),
    ]
    for name in _SHOWN:
        unit = VARIABLES[name][1]
        blocks.append(
            Picture(
                f"cross_check_{name}",
                _CAPTIONS[name],
                partial(cross_check_figure, g, name, unit, check.lumped, models, keep),
            )
        )
    blocks += [*_conservation(check), *_variant(check), _orders(check), _settings(check)]
    compared = slice(-(check.compared_cycles * (check.lumped.sizes["time"] - 1) // check.cycles) - 1, None)
    runs = [("lumped", check.lumped), *check.multibody.items()]
    data = {f"cross_check_{name}": run.isel(time=compared) for name, run in runs}
    return Content(tuple(blocks), Badge(check.verdict.word), data)


def _motions(check: CrossCheck) -> str:
    """Which motions are compared."""
    if check.orbit is not None:
        linear = (
            "Contact is lost, so the lumped motion is the one with unilateral contact; the linear multibody "
            "model has unilateral contact as well, and is compared in its own periodic motion."
        )
    else:
        linear = (
            "The linear multibody model starts from the lumped periodic motion and is compared over "
            f"{check.cycles} mesh cycles. {check.pulling}"
        ).rstrip()
    if check.periodic:
        return (
            f"{linear} The exact model is compared in its own periodic motion, with the brake torque that "
            "balances its own losses."
        )
    return (
        f"{linear} The exact model has no periodic motion near the lumped one that a pair would stay in: the "
        f"last {check.compared_cycles} cycles of a run from the lumped motion are shown, and not judged."
    )


def _agreements(check: CrossCheck) -> list[Block]:
    shared = {
        "quantity": ("quantity", lambda a: NAMES[a.quantity]),
        "value": ("largest difference", lambda a: a.difference),
        "limit": ("limit", lambda a: a.limit),
    }
    return [
        table_of(
            "verdicts",
            "Exact contact: largest difference over the peak to peak of the lumped motion.",
            check.of("exact"),
            shared
            | {
                "holds": ("", lambda a: Badge("agrees" if a.within else "differs")),
                "rms": ("rms difference", lambda a: a.rms),
                "mean_shift": ("difference of the means", lambda a: a.mean_shift),
                "lumped": ("lumped, peak to peak", lambda a: Quantity(a.peak_to_peak, a.unit)),
                "multibody": ("multibody", lambda a: Quantity(a.peak_to_peak_multibody, a.unit)),
                "sprague_geers_magnitude": ("S-G M", lambda a: _sprague_geers(a, "magnitude")),
                "sprague_geers_phase": ("S-G P", lambda a: _sprague_geers(a, "phase")),
            },
            note="Tooth forces are the sum over the pairs in contact, without the samples within 2 % of a "
            "mesh cycle of a switch, where finite motions move a jump. Sprague and Geers (2003, 2004): "
            "M = √(I_cc/I_rr) − 1, P = arccos(I_cr/√(I_cc I_rr))/π of the oscillation about the mean, "
            "I_xy = ∫ x y dt; M > 0 where multibody is larger.",
        ),
        table_of(
            "verdicts_linear",
            "The same equations in both models: largest difference over the peak to peak.",
            check.of("linear"),
            shared | {"verdict": ("verdict", lambda a: Badge("within" if a.within else "outside"))},
        ),
        Text(
            "Why these limits:",
            _reasons((f"{a.fidelity} {NAMES[a.quantity]}", a.reason) for a in check.agreements),
        ),
    ]


def _sprague_geers(agreement: Agreement, part: str) -> float | None:
    found = agreement.sprague_geers
    return None if found is None else float(getattr(found, part))


def _reasons(told: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Every reason once, after the names of what it is for."""
    names: dict[str, list[str]] = {}
    for name, reason in told:
        names.setdefault(reason, []).append(name)
    return tuple(f"{'; '.join(of)}: {reason}." for reason, of in names.items())


def causes(found: xr.Dataset | None) -> list[Block]:
    """Table of what each finite-motion effect does; nothing without an attribution."""
    if found is None:
        return []
    rows: Rows = []
    parts, loaded = str(found.attrs["parts"]).split(", "), found.attrs["contact"] == "loaded"
    listed = [str(cause) for cause in found["cause"].values]
    for cause in listed:
        text = _CAUSES[cause] + ("" if cause in (*parts, "all") else " (not part of all)")
        at = found.sel(cause=cause)
        values = [
            float(at[kind].sel(quantity=quantity))
            for quantity in _ATTRIBUTED
            for kind in ("alone", "without")
        ]
        if cause == "all":  # "without all of them" is the lumped motion itself
            values[1::2] = [np.nan] * len(_ATTRIBUTED)
        rows.append((text, *(None if np.isnan(value) else value for value in values)))
    largest = _CAUSES[str(found.attrs["largest"])]
    return [
        Text(
            "Why the models differ: the exact model's effects, each alone and all but each, in periodic "
            "motion with the brake torque that balances it. With all of them off it solves the lumped "
            "equations. "
            + ("The exact contact acts in every row; what the others change, they change of it. " * loaded)
            + f"The largest change of the transmission error: {largest}."
        ),
        Table(
            "causes",
            "Largest change of the motion by the exact model's effects, over its peak to peak.",
            {
                "cause": "effect",
                **{
                    f"{quantity}_{kind}": f"{title}, {words}"
                    for quantity, title in _ATTRIBUTED.items()
                    for kind, words in (("alone", "this alone"), ("without", "all but this"))
                },
            },
            tuple(rows),
            frozenset([listed.index(str(found.attrs["largest"]))]),
            note="Effects act together: where neither of two alone does much, both may."
            + (
                " Teeth enter late by half of their deflection if only entry shifts, and by half of the "
                "whole wind-up, bearings included, if the contact moves as well."
            )
            * (not loaded),
        ),
    ]


def _conservation(check: CrossCheck) -> list[Block]:
    def name(judgement: Judgement) -> str:
        return judgement.check.removeprefix("conservation: ")

    share = fed_back(check.lumped)
    names = {"driving": "driving", **POWERS}
    return [
        table_of(
            "conservation",
            "Conservation laws, on both models.",
            check.conservation,
            {
                "check": ("check", name),
                "value": ("value", lambda j: j.value),
                "limit": ("limit", lambda j: j.limit),
                "verdict": ("verdict", lambda j: Badge("within" if j.within else "outside")),
            },
        ),
        Text(
            "What is measured, and why these limits:",
            _reasons((name(j), j.reason) for j in check.conservation),
        ),
        table_of(
            "powers",
            "Mean powers over a mesh cycle, power by power.",
            list(names),
            {
                "power": ("power", lambda name: names[name]),
                **{
                    model: (model, lambda name, model=model: Quantity(check.powers[model][name], "W"))  # type: ignore[misc]
                    for model in check.powers
                },
            },
            note="The change of stiffness and profile along the path is a source in the equations of the "
            "lumped model: moving a loaded contact along its flank costs nothing there, and the power "
            "balance closes only with it. With loaded contact the exact contact has an energy and no such "
            "source.",
        ),
        Text(
            "Vibration never reverses sliding in the lumped motion."
            if share == 0.0
            else "In the lumped motion vibration reverses sliding near the pitch point. Friction keeps "
            f"the sign of the nominal sliding and feeds {number(100 * share, 2)} % of its power back. "
            "This is a limit of validity, not a wrong sign. The friction of the exact model follows the "
            "actual sliding."
        ),
    ]


def _variant(check: CrossCheck) -> list[Block]:
    variant = check.variant
    if variant is None:
        return [Text("No asymmetric variant of this pair was found that is stable and keeps contact.")]
    return [
        Text(
            "Asymmetric variant: the checks of the program, with fewer cycles, on a variation in which "
            f"nothing is symmetric ({variant.pair.pinion.teeth}/{variant.pair.gear.teeth} teeth, four unlike "
            "bearings, unlike densities and roughnesses). It shows what symmetry can hide, such as swapped "
            "bearings."
        ),
        table_of(
            "variant",
            "Asymmetric variant: of each kind the check that uses most of its limit.",
            variant.worst_of_each,
            {
                "check": ("check", lambda j: j.check),
                "value": ("value", lambda j: j.value),
                "limit": ("limit", lambda j: j.limit),
                "verdict": ("verdict", lambda j: Badge("within" if j.within else "outside")),
            },
        ),
    ]


def _settings(check: CrossCheck) -> Facts:
    return Facts(
        "settings",
        (
            Fact(
                "unsettled",
                "how far the exact model is from periodic motion",
                check.unsettled,
                "relative mismatch after a mesh cycle"
                if check.periodic
                else "change of the transmission error over the last two cycles, over its peak to peak",
            ),
            *(
                Fact(
                    f"brake_torque_{name}",
                    f"brake torque, {name}",
                    Quantity(float(run.attrs["brake_torque"]), "N m"),
                )
                for name, run in (("lumped", check.lumped), ("exact", check.multibody["exact"]))
            ),
            *(
                Fact(f"rtol_{name}", f"relative tolerance of the integration, {name}", value)
                for name, value in check.rtol.items()
            ),
        ),
    )


def _orders(check: CrossCheck) -> Table:
    rows: Rows = []
    for comparison in check.orders:
        # An order below a thousandth of the largest has no phase worth comparing.
        floor = 1e-3 * float(comparison.lumped.amplitude[1:].max())
        for order in range(1, 6):
            amplitude = float(comparison.lumped.amplitude[order])
            if amplitude <= floor or amplitude == 0.0:
                continue
            other = float(comparison.multibody.amplitude[order])
            rows.append(
                (
                    NAMES[comparison.quantity],
                    order,
                    Quantity(amplitude, comparison.unit),
                    Quantity(other, comparison.unit),
                    other / amplitude,
                    float(np.degrees(comparison.phase_difference[order])),
                )
            )
    return Table(
        "orders",
        "Exact multibody against lumped by mesh order; tooth forces as the sum of the pairs in contact.",
        {
            "quantity": "quantity",
            "order": "order",
            "lumped": "lumped",
            "multibody": "multibody",
            "ratio": "ratio",
            "phase_difference_deg": "phase difference [°]",
        },
        tuple(rows),
        note="Orders below a thousandth of the largest are left out.",
    )


def answer(results: Results) -> Answer:
    """Whether the multibody model has the motion of the lumped model."""
    return Answer("Does the independent model agree?", Badge(results.check.verdict.word), agreement(results))


CHAPTER = Chapter(
    "cross_check",
    "Cross-check against the multibody model",
    write,
    answer,
    ("verdicts", "cross_check_dte"),
    seconds=10,
)
