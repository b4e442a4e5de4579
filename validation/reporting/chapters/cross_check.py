"""Lumped against multibody: overlays, metrics, verdicts."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import numpy as np
import xarray as xr

from lumped.model.results import VARIABLES
from validation.cross_check.comparison import MEANINGS, Agreement, CrossCheck, off_switch_samples
from validation.cross_check.first_order import EFFECT_WORDS, Effects
from validation.cross_check.judgement import Judgement
from validation.cross_check.ledger import POWERS
from validation.cross_check.nature import fed_back
from validation.cross_check.parted_motion import why_teeth_pull
from validation.plots.cross_check import cross_check_figure
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
from validation.reporting.causes import attribution, causes
from validation.reporting.chapter import Chapter
from validation.reporting.cross_check_words import NAMES, finite_motions, same_equations
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


def write(results: Results) -> Content:
    """Write the chapter."""
    check, g = results.check, results.geometry
    keep = off_switch_samples(results.pair, check.lumped["time"].to_numpy())
    models = {str(fidelity): result for fidelity, result in check.multibody.items()}
    blocks: list[Block] = [
        *cautions(results),
        Text(
            f"The verdict is “{check.verdict}”: {MEANINGS[check.verdict]}. "
            f"{_linear_motion(check)} {_exact_motion(check)} "
            f"{same_equations(check)} {finite_motions(check)}"
        ),
        *_judged(check),
        Text(
            "Why these tolerances:",
            _reasons((f"{a.fidelity} {NAMES[a.quantity]}", a.tolerance.reason) for a in check.agreements),
        ),
        *(causes(attribution(results.pair)) if results.effort.full else ()),
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
    blocks += [
        _metrics(check),
        _orders(check),
        Facts(
            "settings",
            (
                Fact(
                    "contact_shift",
                    "shift of the contact by finite motions, over the base pitch",
                    check.contact_shift,
                    "the small parameter of the exact model's differences",
                ),
                Fact(
                    "unsettled",
                    "how far the exact model is from periodic motion",
                    check.unsettled["exact"],
                    "relative mismatch after a mesh cycle"
                    if check.periodic
                    else "change of the transmission error over the last two cycles, over its peak to peak",
                ),
                *(
                    Fact(f"brake_torque_{name}", f"brake torque, {name}", _brake_torque(run))
                    for name, run in (("lumped", check.lumped), ("exact", check.multibody["exact"]))
                ),
                *(
                    Fact(f"rtol_{name}", f"relative tolerance of the integration, {name}", value)
                    for name, value in check.rtol.items()
                ),
            ),
        ),
    ]
    compared = slice(-(check.compared_cycles * (check.lumped.sizes["time"] - 1) // check.cycles) - 1, None)
    runs = [("lumped", check.lumped), *check.multibody.items()]
    data = {f"cross_check_{name}": run.isel(time=compared) for name, run in runs}
    return Content(tuple(blocks), Badge(check.verdict), data)


def _brake_torque(run: xr.Dataset) -> Quantity:
    return Quantity(float(run.attrs["brake_torque"]), "N m")


def _linear_motion(check: CrossCheck) -> str:
    if check.orbit is not None:
        return (
            "Teeth part, so the lumped motion is the one with teeth that push only. The linear model has "
            "such teeth as well, and is compared in its own periodic motion."
        )
    told = (
        "The linear model starts from the lumped periodic motion and is compared over "
        f"{check.cycles} mesh cycles."
    )
    return f"{told} {why_teeth_pull(check.pair)}".rstrip() if check.failures else told


def _exact_motion(check: CrossCheck) -> str:
    if check.periodic:
        return (
            "The exact model is compared in its own periodic motion, with the brake torque that balances its "
            "own losses."
        )
    return (
        "The exact model has no periodic motion near the lumped one that a pair would stay in: it runs for "
        f"as long from the lumped motion, and its last {check.compared_cycles} cycles are compared, settled "
        "or not."
    )


def _judged(check: CrossCheck) -> list[Block]:
    tables: list[Block] = [
        table_of(
            "verdicts_linear",
            "The same equations in both models: largest difference over the peak to peak.",
            check.of("linear"),
            {
                "quantity": ("quantity", lambda a: NAMES[a.quantity]),
                "value": ("largest difference", lambda a: a.judged),
                "tolerance": ("limit", lambda a: a.tolerance.limit),
                "verdict": ("verdict", lambda a: Badge("within" if a.within else "outside")),
            },
        ),
        table_of(
            "verdicts",
            "Exact contact: the whole difference, what finite motions must change, and what they leave; "
            "each a norm over the norm of the lumped history.",
            check.of("exact"),
            {
                "quantity": ("quantity", lambda a: NAMES[a.quantity]),
                "raw": ("difference", lambda a: a.relative_l2),
                "raw_limit": ("its limit", lambda a: a.whole_limit),
                "predicted": ("predicted", lambda a: a.predicted_l2),
                "value": ("left", lambda a: a.remainder_l2),
                "tolerance": ("its limit", lambda a: a.tolerance.limit),
                "verdict": ("verdict", lambda a: Badge(_verdict(a))),
            },
        ),
    ]
    if check.effects is not None:
        tables.append(_effects(check.effects))
    if check.nature:
        tables += [*_nature(check), _powers(check)]
        share = fed_back(check.lumped)
        tables.append(
            Text(
                "Vibration never reverses sliding in the lumped motion."
                if share == 0.0
                else "In the lumped motion vibration reverses sliding near the pitch point. Friction keeps "
                f"the sign of the nominal sliding and feeds {number(100 * share, 2)} % of its power back. "
                "This is a limit of validity, not a wrong sign. The friction of the exact model follows the "
                "actual sliding."
            )
        )
    tables += _twin(check)
    return tables


def _nature(check: CrossCheck) -> list[Block]:
    def name(judgement: Judgement) -> str:
        return judgement.check.removeprefix("nature: ")

    return [
        table_of(
            "nature",
            "Laws of nature, on both models.",
            check.nature,
            {
                "check": ("check", name),
                "value": ("value", lambda j: j.value),
                "limit": ("limit", lambda j: j.limit),
                "verdict": ("verdict", lambda j: Badge("within" if j.within else "outside")),
            },
        ),
        Text(
            "What is measured, and why these limits:",
            _reasons((name(j), j.reason) for j in check.nature),
        ),
    ]


def _powers(check: CrossCheck) -> Table:
    names = {"driving": "driving", **POWERS}
    return table_of(
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
        note="The change of stiffness and profile along the path is a source in the equations of the lumped "
        "model: moving a loaded contact along its flank costs nothing there, and the books close only with "
        "it. With loaded contact the exact contact has an energy; its brake pays for what the lumped "
        "equations get for nothing.",
    )


def _twin(check: CrossCheck) -> list[Block]:
    twin = check.twin
    if twin is None:
        return [Text("No unlike twin of this pair was found that is stable and keeps its teeth in contact.")]
    return [
        Text(
            f"Unlike twin: the same checks, with fewer cycles, on a variation in which nothing is symmetric "
            f"({twin.pair.pinion.teeth}/{twin.pair.gear.teeth} teeth, four unlike bearings, unlike densities "
            f"and roughnesses): {twin.verdict}. It shows what symmetry can hide, such as swapped bearings."
        ),
        table_of(
            "twin",
            "Unlike twin: of each kind the check that uses most of its limit.",
            twin.worst_of_each,
            {
                "check": ("check", lambda j: j.check),
                "value": ("value", lambda j: j.value),
                "limit": ("limit", lambda j: j.limit),
                "verdict": ("verdict", lambda j: Badge("within" if j.within else "outside")),
            },
        ),
    ]


def _verdict(agreement: Agreement) -> str:
    if not all(j.within for j in agreement.judgements):
        return "outside"
    return "within" if all(j.within for j in agreement.raw) else "explained"


def _effects(effects: Effects) -> Table:
    return table_of(
        "effects",
        "Finite-motion effects by the lumped model: what each changes alone, and the most that it can change "
        "to first order. The limit of a whole difference is the sum of these and the shift of the contact.",
        [(name, quantity) for name in effects.most for quantity in _SHOWN],
        {
            "effect": ("effect", lambda at: EFFECT_WORDS[at[0]]),
            "quantity": ("quantity", lambda at: NAMES[at[1]]),
            "size": ("displacement / base pitch", lambda at: effects.size.get(at[0])),
            "alone": ("change alone", lambda at: effects.alone.get(at[0], {}).get(at[1])),
            "most": ("most", lambda at: effects.most[at[0]][at[1]]),
        },
        note="Of the turned line of action the displacement is its angle [rad]. An empty cell: no motion was "
        "found with this effect, so friction may hold the teeth, and its most is allowed in what is left. "
        "Where teeth part an effect has no displacement of its own and counts by what it changes beside all "
        "others, late entry by the whole change.",
    )


def _reasons(told: Iterable[tuple[str, str]]) -> tuple[str, ...]:
    """Every reason once, after the names of what it is for."""
    names: dict[str, list[str]] = {}
    for name, reason in told:
        names.setdefault(reason, []).append(name)
    return tuple(f"{'; '.join(of)}: {reason}." for reason, of in names.items())


def _metrics(check: CrossCheck) -> Table:
    return table_of(
        "metrics",
        "All metrics of multibody against lumped.",
        check.agreements,
        {
            "quantity": ("quantity", lambda a: NAMES[a.quantity]),
            "fidelity": ("multibody", lambda a: a.fidelity),
            "relative_l2": ("relative L2", lambda a: a.relative_l2),
            "remainder_l2": ("L2 left", lambda a: a.remainder_l2),
            "maximum_over_span": ("largest", lambda a: a.maximum_over_span),
            "rms_over_span": ("rms", lambda a: a.rms_over_span),
            "mean_shift": ("mean shift", lambda a: a.mean_shift),
            "peak_to_peak_ratio": ("span ratio", lambda a: a.peak_to_peak_ratio),
            "sprague_geers_magnitude": ("S-G M", lambda a: _sprague_geers(a, "magnitude")),
            "sprague_geers_phase": ("S-G P", lambda a: _sprague_geers(a, "phase")),
            "sprague_geers_comprehensive": ("S-G C", lambda a: _sprague_geers(a, "comprehensive")),
        },
        note="Relative L2: norm of the difference over the norm of the lumped history; L2 left: the same "
        "after what finite motions must change, predicted from the lumped model alone, is added to the "
        "lumped history. Largest, rms and mean shift are over the peak to peak of the lumped "
        "history. Sprague and Geers (2003, 2004): "
        "M = √(I_cc/I_rr) − 1, P = arccos(I_cr/√(I_cc I_rr))/π of the oscillation about the mean, "
        "I_xy = ∫ x y dt; C = √(M² + P²); M > 0 where multibody is larger. Span ratio: peak to peak over "
        "peak to peak. Samples on a switch are left out: they belong to either side of the jump.",
    )


def _sprague_geers(agreement: Agreement, part: str) -> float | None:
    found = agreement.sprague_geers
    return None if found is None else float(getattr(found, part))


def _orders(check: CrossCheck) -> Table:
    rows: Rows = []
    for comparison in check.orders:
        if comparison.fidelity != "exact":
            continue
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
    """Whether the multibody model confirms the lumped model."""
    return Answer("Does the independent model agree?", Badge(results.check.verdict), agreement(results))


CHAPTER = Chapter(
    "cross_check",
    "Cross-check against the multibody model",
    write,
    answer,
    ("verdicts", "cross_check_dte"),
    seconds=10,
)
