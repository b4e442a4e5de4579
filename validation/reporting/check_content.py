"""Chapters of a check: static quantities, channels and orders, explanations, values over speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from validation.check.check import Check, Rung
from validation.check.ladder import Ladder
from validation.check.ladder_data import ladder_data
from validation.check.misfit import ChannelMisfit
from validation.check.over_speed import SpeedMisfit
from validation.check.overlay import figure_data
from validation.check.problem import Problem
from validation.check.quantities import QUANTITIES
from validation.check.samples import peaks_to_peak
from validation.check.static import StaticRow
from validation.check.words import FAR, percent, static_words, subject
from validation.plots.check import ladder_figure, motion_figure, speed_figure
from validation.reporting.blocks import (
    Badge,
    Block,
    Cell,
    Column,
    Content,
    Picture,
    Quantity,
    Table,
    Text,
    table_of,
)

#: Orders of a channel in the table, the largest first.
_MOST_ORDERS = 6
#: Sentence on a search that its budget ended.
_ENDED = " The search was ended by its budget: --budget gives it more seconds."
#: Most things to look at first.
_MOST_FIRST = 4


class CheckPart(NamedTuple):
    """A chapter of a check: anchor, title and content."""

    anchor: str
    title: str
    content: Content


def parts_of(check: Check) -> tuple[CheckPart, ...]:
    """Return the chapters of a check, without those that have nothing to show."""
    parts: list[CheckPart] = []
    if check.static.rows:
        parts.append(CheckPart("static", "Before anything moves", static_content(check)))
    if check.low_speed is not None:
        parts.append(CheckPart("low_speed", "At low speed", _low_speed_content(check)))
    if check.problem is not None:
        parts.append(CheckPart("motion", "The motion", motion_content(check)))
    if check.ladder is not None:
        assert check.problem is not None
        content = ladder_content(check.problem, check.ladder, check.limit)
        parts.append(CheckPart("explanations", "What would explain it", content))
    if check.over_speed is not None:
        parts.append(CheckPart("over_speed", "Over speed", _speed_content(check)))
    return tuple(parts)


def look_first(check: Check) -> tuple[str, ...]:
    """Return what to look at first, the most important first; empty where the check agrees."""
    if check.failed is None:
        return ()
    texts = [f"{static_words(row)}." for row in check.static.wrong[:2]]
    for step in check.explanations:
        texts.append(f"{step.sentence}.")
        if step.alternatives:
            others = "; ".join(other.sentence for other in step.alternatives[:3])
            texts[-1] += f" The curves do not tell this from: {others}."
    return tuple(texts[:_MOST_FIRST]) or _without_explanation(check)


def _without_explanation(check: Check) -> tuple[str, ...]:
    """What to look at where neither a static quantity differs nor an explanation is known."""
    statics = "contact_ratio, base_radius_pinion, static_force and mesh_stiffness"
    if check.failed is Rung.LOW_SPEED:
        return (
            "At low speed the transmission error is the static force over the mesh stiffness. Give "
            f"{statics} of your model beside the curves: they are then compared first.",
        )
    if check.failed is Rung.MOTION and not check.static.rows and check.role == "model":
        return (
            f"Give {statics}, masses, inertias and natural_frequencies of your model beside the curves: they "
            "are then compared first.",
        )
    return ()


def static_content(check: Check) -> Content:
    """Write the chapter of the static quantities."""
    rung = check.static
    words = (
        "Every static quantity agrees."
        if rung.agrees
        else f"{len(rung.wrong)} of {len(rung.rows)} differ, which explains differences of the motion."
    )
    table = table_of(
        "static",
        "Static quantities of both models.",
        rung.rows,
        (
            Column[StaticRow]("quantity", "quantity", lambda row: row.name),
            Column[StaticRow]("theirs", "theirs", lambda row: Quantity(row.theirs, row.unit)),
            Column[StaticRow]("ours", "spurcheck", lambda row: Quantity(row.ours, row.unit)),
            Column[StaticRow](
                "difference", "theirs over ours, less 1 [%]", lambda row: _in_percent(row.difference)
            ),
            Column[StaticRow]("limit", "limit [%]", lambda row: _rounded(100.0 * row.limit)),
            Column[StaticRow](
                "verdict", "", lambda row: Badge("agrees") if row.agrees else Badge("violated", "differs")
            ),
        ),
    )
    return Content(words, (table,))


def _low_speed_content(check: Check) -> Content:
    """Write the chapter of the nearly static motion."""
    problem = check.low_speed
    assert problem is not None
    rpm = problem.pair.operating.pinion_speed * 30.0 / math.pi
    size = percent(problem.misfit.value)
    words = f"At {rpm:.0f} rpm, where the motion is nearly static, the transmission error differs by {size}."
    picture = Picture("low_speed", "Both motions at low speed.", figure_data(problem), motion_figure)
    return Content(words, (picture,))


def motion_content(check: Check) -> Content:
    """Write the chapter of the channels: tables of sizes and orders, and the overlay of both motions."""
    assert check.problem is not None
    rows = check.problem.misfit.channels
    second = "" if math.isnan(check.discrepancy) else (
        f" Both programs of spurcheck differ by {percent(check.discrepancy)} here."
    )  # fmt: skip
    picture = Picture(
        "motion",
        "Both motions over the mesh phase, and their mesh orders. Bands: scatter of the samples.",
        figure_data(check.problem),
        motion_figure,
    )
    blocks: tuple[Block, ...] = (
        picture, _channel_table(check, rows), _orders_table(rows), Text(_shift_words(check.problem))
    )  # fmt: skip
    return Content(f"Misfit {percent(check.misfit)}, limit {percent(check.limit)}.{second}", blocks)


def peaks_words(check: Check) -> str:
    """Sentence on the peaks to peak, and on the orders of the misfit."""
    highest = max((float(row.ours.orders.max(initial=0.0)) for row in check.nearer.channels), default=0.0)
    if check.role == "measurement":
        return f"Peaks to peak and misfit are those of the mesh orders up to {highest:.4g}."
    return (
        f"Peaks to peak are those of the samples. The misfit is that of the mesh orders up to {highest:.4g}."
    )


def _shift_words(problem: Problem) -> str:
    """Sentence on the common shift in time of all channels."""
    shift = round(problem.misfit.shift, 3)
    if problem.coarse_shift is None:
        shift %= problem.motion.mesh_cycles
    return (
        f"All channels are shifted in time together: their first sample lies {shift:.3f} mesh cycles behind "
        "the moment when tooth pair A is at A."
    )


def _channel_table(check: Check, rows: Sequence[ChannelMisfit]) -> Table:
    """Sizes, means and misfit of each channel."""
    second = {} if check.second is None else {row.channel.channel.name: row for row in check.second.channels}

    def against_second(row: ChannelMisfit) -> Cell:
        other = second.get(row.channel.channel.name)
        return None if other is None else _in_percent(other.total)

    nearer = {row.channel.channel.name: row.total for row in check.nearer.channels}

    def verdict_of(row: ChannelMisfit) -> Badge:
        agrees = nearer[row.channel.channel.name] <= check.limit
        return Badge("agrees") if agrees else Badge("violated", "differs")

    def quantity_of(row: ChannelMisfit, value: float) -> Quantity:
        return Quantity(value, row.channel.channel.kind.unit)

    assert check.problem is not None
    peaks = {row.channel.channel.name: peaks_to_peak(check.problem, row) for row in rows}
    return table_of(
        "channels",
        "Channels: peak to peak, mean and misfit.",
        rows,
        (
            Column[ChannelMisfit]("channel", "channel", lambda row: row.channel.channel.name),
            Column[ChannelMisfit]("quantity", "quantity", lambda row: row.channel.channel.kind.words),
            Column[ChannelMisfit](
                "theirs",
                "theirs, peak to peak",
                lambda row: quantity_of(row, peaks[row.channel.channel.name].theirs),
            ),
            Column[ChannelMisfit](
                "ours",
                "spurcheck, peak to peak",
                lambda row: quantity_of(row, peaks[row.channel.channel.name].ours),
            ),
            Column[ChannelMisfit](
                "their_mean",
                "their mean",
                lambda row: quantity_of(row, row.channel.orders.mean) if row.compares_mean else None,
            ),
            Column[ChannelMisfit](
                "our_mean",
                "our mean",
                lambda row: quantity_of(row, row.ours.mean) if row.compares_mean else None,
            ),
            Column[ChannelMisfit]("misfit", "misfit, lumped model [%]", lambda row: _in_percent(row.total)),
            Column[ChannelMisfit]("second", "misfit, multibody model [%]", against_second),
            Column[ChannelMisfit]("verdict", "", verdict_of),
        ),
        note=f"{peaks_words(check)} A mean is compared where the quantity has one and no export removed it. "
        "The nearer of both programs decides.",
    )


class _OrderRow(NamedTuple):
    """A row of the table of orders: place ``j`` of an order in the orders of a channel."""

    row: ChannelMisfit
    j: int


def _orders_table(rows: Sequence[ChannelMisfit]) -> Table:
    """The largest orders of every channel, in both models."""
    items = []
    for row in rows:
        sizes = [
            max(one, other)
            for one, other in zip(row.channel.orders.amplitudes, row.ours.amplitudes, strict=True)
        ]
        largest = sorted(range(len(sizes)), key=lambda j: -sizes[j])[:_MOST_ORDERS]
        items += [_OrderRow(row, j) for j in sorted(largest)]

    def degrees(item: _OrderRow) -> float | None:
        product = item.row.ours.values[item.j] * item.row.channel.orders.values[item.j].conjugate()
        small = 1e-3 * item.row.scale
        if min(item.row.ours.amplitudes[item.j], item.row.channel.orders.amplitudes[item.j]) < small:
            return None
        return round(math.degrees(math.atan2(product.imag, product.real)), 1) + 0.0

    def unit(item: _OrderRow) -> str:
        return item.row.channel.channel.kind.unit

    return table_of(
        "orders",
        f"The {_MOST_ORDERS} largest mesh orders of each channel.",
        items,
        (
            Column[_OrderRow]("channel", "channel", lambda item: item.row.channel.channel.name),
            Column[_OrderRow]("order", "mesh order", lambda item: float(item.row.ours.orders[item.j])),
            Column[_OrderRow](
                "theirs",
                "theirs",
                lambda item: Quantity(float(item.row.channel.orders.amplitudes[item.j]), unit(item)),
            ),
            Column[_OrderRow](
                "ours",
                "spurcheck",
                lambda item: Quantity(float(item.row.ours.amplitudes[item.j]), unit(item)),
            ),
            Column[_OrderRow]("phase", "phase, ours less theirs [degrees]", degrees),
        ),
    )


class _StepRow(NamedTuple):
    """A row of the table of explanations."""

    step: str
    sentence: str
    factor: float | str
    misfit: float


def ladder_content(problem: Problem, ladder: Ladder, limit: float) -> Content:
    """Write the explanations of a misfit: bars that fall, and what the curves do not tell apart."""
    who = subject(problem.curves.role)
    if not ladder.steps:
        words = "No named explanation makes the difference much smaller."
        if not ladder.complete:
            words += _ENDED
        return Content(words, (Text(f"{ladder.runs} motions were computed."),))
    last = ladder.steps[-1].misfit
    count = f"{len(ladder.steps)} {'change brings' if len(ladder.steps) == 1 else 'changes bring'}"
    words = f"{count} the misfit from {percent(ladder.start)} to {percent(last)}."
    if last > FAR * limit:
        words += f" That is far above the limit, {percent(limit)}: none of them explains the difference."
    else:
        proof = "it; it is" if len(ladder.steps) == 1 else "them; they are"
        words += f" {who} is compatible with {proof} not proven."
        if last > limit:
            words += f" The misfit stays above the limit, {percent(limit)}: something else differs too."
    if not ladder.complete:
        words += _ENDED
    items = []
    for number, step in enumerate(ladder.steps, start=1):
        items.append(_StepRow(str(number), step.sentence, step.factor, step.misfit))
        items += [_StepRow("", f"or: {a.sentence}", a.factor, a.misfit) for a in step.alternatives]
    items += [_StepRow("", f"alone: {a.sentence}", a.factor, a.misfit) for a in ladder.others_alone]
    table = table_of(
        "explanations",
        "Steps of the search, what the curves do not tell apart from each step, and the best single "
        "explanations alone, in place of all steps.",
        items,
        (
            Column[_StepRow]("step", "step", lambda item: item.step),
            Column[_StepRow]("explanation", "compatible with", lambda item: item.sentence),
            Column[_StepRow](
                "value",
                "value",
                lambda item: item.factor if isinstance(item.factor, str) else _rounded(item.factor),
            ),
            Column[_StepRow]("misfit", "misfit then [%]", lambda item: _in_percent(item.misfit)),
        ),
    )
    picture = Picture(
        "explanations",
        "The misfit after each step. Dashed: the limit.",
        ladder_data(problem, ladder, limit),
        ladder_figure,
    )
    return Content(words, (picture, table, Text(f"{ladder.runs} motions were computed.")))


def _speed_content(check: Check) -> Content:
    """Write the chapter of the values over speed."""
    assert check.over_speed is not None
    rpm = check.over_speed.worst_speed * 30.0 / math.pi
    words = f"Misfit {percent(check.misfit)}, limit {percent(check.limit)}; most at {rpm:.0f} rpm."
    picture = Picture("over_speed", "Values over speed.", check.over_speed.table, speed_figure)
    return Content(words, (picture, _speed_table(check, check.over_speed)))


class SpeedRow(NamedTuple):
    """A row of the table of values over speed: one column of the other model, by its worst speed."""

    name: str
    unit: str
    misfit: float
    rpm: float
    theirs: float
    ours: float


def speed_rows(misfit: SpeedMisfit) -> tuple[SpeedRow, ...]:
    """Return a row for each column of values over speed."""
    rows = []
    for column, ours, share in zip(misfit.theirs.columns, misfit.ours, misfit.by_column, strict=True):
        place = int(np.nan_to_num(np.abs(column.values - ours)).argmax())
        rows.append(
            SpeedRow(
                name=column.name,
                unit=QUANTITIES[column.quantity].unit,
                misfit=float(share),
                rpm=float(misfit.theirs.speeds[place]) * 30.0 / math.pi,
                theirs=float(column.values[place]),
                ours=float(ours[place]),
            )
        )
    return tuple(rows)


def _speed_table(check: Check, misfit: SpeedMisfit) -> Table:
    """Misfit of each column, and both values at the speed at which they differ most."""
    return table_of(
        "speeds",
        "Columns: misfit, and both values at the speed at which they differ most.",
        speed_rows(misfit),
        (
            Column[SpeedRow]("column", "column", lambda row: row.name),
            Column[SpeedRow]("misfit", "misfit [%]", lambda row: _in_percent(row.misfit)),
            Column[SpeedRow]("speed", "worst speed", lambda row: row.rpm, "rpm"),
            Column[SpeedRow]("theirs", "theirs there", lambda row: Quantity(row.theirs, row.unit)),
            Column[SpeedRow]("ours", "spurcheck there", lambda row: Quantity(row.ours, row.unit)),
            Column[SpeedRow](
                "verdict",
                "",
                lambda row: Badge("agrees") if row.misfit <= check.limit else Badge("violated", "differs"),
            ),
        ),
    )


#: What a failing rung is called in the headline.
RUNG_WORDS = {
    Rung.STATIC: "before anything moves",
    Rung.LOW_SPEED: "at low speed",
    Rung.MOTION: "in its motion",
    Rung.OVER_SPEED: "over speed",
}


def _in_percent(share: float) -> float | None:
    """Share in per cent, rounded to three digits; below 0.01 % it is 0."""
    return 0.0 if abs(share) < 1e-4 else _rounded(100.0 * share)


def _rounded(value: float, digits: int = 3) -> float | None:
    """Value rounded to some digits; None for a value that is not finite."""
    return float(f"{value:.{digits}g}") if math.isfinite(value) else None
