"""The motion over time and by mesh order, and the orders over speed."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from lumped.labelling import labelled_dataset
from lumped.model.averaged import Mode
from lumped.model.dynamic_factor import iso_dynamic_factor
from lumped.path_of_contact.stiffness import WITHOUT_FACTORS, stiffness_factor
from validation.files.formatting import quantity
from validation.plots.axes import cycle_figure
from validation.plots.maps import orders_map_figure
from validation.reporting.blocks import (
    Block,
    Column,
    Content,
    NamedNumber,
    Picture,
    Table,
    Text,
    named_numbers,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.pair
    prediction = results.prediction
    springs = results.in_place_of_shafts
    cycle = prediction.cycle
    period = pair.geometry.mesh_period
    time = labelled_dataset(
        {"dte": ("cycles", cycle["dte"].to_numpy(), "m", "dynamic transmission error")},
        {"cycles": (cycle["time"].to_numpy() / period, "mesh cycles", "time")},
    )
    blocks: list[Block] = [
        _motion_table(results),
        Picture(
            "transmission_error",
            "Dynamic transmission error over time.",
            time,
            partial(cycle_figure, names=["dte"]),
        ),
        _orders_table(results),
        Picture(
            "orders_over_speed",
            f"Force on the pinion bearings by mesh order over speed, linear motion{springs}. Red: where an "
            "order meets a natural frequency. Dashed: the operating speed.",
            results.orders_over_speed,
            partial(
                orders_map_figure,
                operating_rpm=results.operating_rpm,
                resonances=[mode.resonant_speed for mode in results.modes],
            ),
        ),
    ]
    if results.modes:
        blocks.append(_modes_table(results))
    else:
        blocks.append(
            Text("A mode of the averaged pair is overdamped, so no natural frequencies are listed.")
        )
    loudest = int(np.argmax(prediction.orders_of("dte"))) + 1
    result = (
        f"The prediction is {prediction.motion.text}; its transmission error is "
        f"{quantity(prediction.peak_to_peak, 'm', 3)} peak to peak, most of it at mesh order {loudest}."
    )
    return Content(result, tuple(blocks))


def _motion_table(results: Results) -> Table:
    prediction = results.prediction
    geometry = results.pair.geometry
    classes = [
        gear.deviations.tolerance_class
        for gear in (results.given.pinion, results.given.gear)
        if gear.deviations is not None and gear.deviations.tolerance_class is not None
    ]
    iso = iso_dynamic_factor(results.pair, max(classes)) if classes else iso_dynamic_factor(results.pair)
    tolerances = f"tolerances of class {iso.tolerance_class}{'' if classes else ' assumed'}"
    # K_v has the stiffness of the standard, which no factor on the model's stiffness changes.
    if stiffness_factor(results.pair) != 1.0:
        tolerances += f", {WITHOUT_FACTORS}"
    iso_note = f"{iso.zone}, N = {iso.resonance_ratio:.2f}, {tolerances}"
    mean = float(prediction.cycle["dte"].mean())
    over_mean = "largest mesh force over the mean one"
    return named_numbers(
        "motion",
        "The motion at the operating point.",
        (
            NamedNumber("transmission error, peak to peak", prediction.peak_to_peak, "m"),
            NamedNumber("transmission error, mean", mean, "m"),
            NamedNumber("dynamic factor", prediction.dynamic_factor, "1", over_mean),
            NamedNumber("K_v of ISO 6336-1, method B", iso.factor, "1", iso_note),
            NamedNumber("mesh frequency", geometry.mesh_frequency, "Hz"),
        ),
    )


class _Order(NamedTuple):
    """A row of the table of orders: number of the mesh order, frequency [Hz], amplitudes [m], [N]."""

    number: int
    frequency: float
    transmission_error: float
    bearing_force: float


def _orders_table(results: Results) -> Table:
    prediction = results.prediction
    mesh_frequency = results.pair.geometry.mesh_frequency
    orders = [
        _Order(number, number * mesh_frequency, float(dte), float(prediction.bearing_orders[number - 1]))
        for number, dte in enumerate(prediction.orders_of("dte"), 1)
    ]
    return table_of(
        "orders",
        "Amplitudes by mesh order.",
        orders,
        (
            Column[_Order]("order", "order", lambda order: order.number),
            Column[_Order]("frequency", "frequency", lambda order: order.frequency, "Hz"),
            Column[_Order]("dte", "transmission error", lambda order: order.transmission_error, "m"),
            Column[_Order]("bearing", "pinion bearings", lambda order: order.bearing_force, "N"),
        ),
    )


def _modes_table(results: Results) -> Table:
    return table_of(
        "modes",
        f"Natural frequencies of the time-averaged pair{results.in_place_of_shafts}.",
        results.modes,
        (
            Column[Mode]("frequency", "frequency", lambda mode: mode.natural_frequency, "Hz"),
            Column[Mode]("damping", "damping ratio", lambda mode: mode.damping_ratio),
            Column[Mode]("speed", "speed at which order 1 meets it", lambda mode: mode.resonant_speed, "rpm"),
        ),
    )


CHAPTER = Chapter("response", "Response", write, seconds=1.5)
