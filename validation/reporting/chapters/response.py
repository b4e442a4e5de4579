"""The motion over time and by mesh order, and the orders over speed."""

from __future__ import annotations

from functools import partial

import numpy as np

from lumped.labelling import labelled_dataset
from lumped.model.dynamic_factor import iso_dynamic_factor
from validation.files.formatting import quantity
from validation.plots.axes import cycle_figure
from validation.plots.maps import orders_map_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Table, Text, quantities
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
    classes = [
        gear.deviations.tolerance_class
        for gear in (results.given.pinion, results.given.gear)
        if gear.deviations is not None and gear.deviations.tolerance_class is not None
    ]
    iso = iso_dynamic_factor(pair, max(classes)) if classes else iso_dynamic_factor(pair)
    of_class = f"tolerances of class {iso.tolerance_class}{'' if classes else ' assumed'}"
    # K_v has the stiffness of the standard, which no factor on the model's stiffness changes.
    if pair.mesh.stiffness_factor != 1.0:
        of_class += ", without mesh.stiffness_factor"
    numbers = quantities(
        "motion",
        "The motion at the operating point.",
        ("transmission error, peak to peak", prediction.peak_to_peak, "m"),
        ("transmission error, mean", float(cycle["dte"].mean()), "m"),
        ("dynamic factor", prediction.dynamic_factor, "1", "largest mesh force over the static one"),
        (
            "K_v of ISO 6336-1, method B",
            iso.factor,
            "1",
            f"{iso.zone}, N = {iso.resonance_ratio:.2f}, {of_class}",
        ),
        ("mesh frequency", pair.geometry.mesh_frequency, "Hz"),
    )
    orders = Table(
        "orders",
        "Amplitudes by mesh order.",
        {
            "order": "order",
            "frequency": "frequency",
            "dte": "transmission error",
            "bearing": "pinion bearings",
        },
        tuple(
            (
                order,
                Quantity(order * pair.geometry.mesh_frequency, "Hz"),
                Quantity(float(size), "m"),
                Quantity(float(prediction.bearing_orders[order - 1]), "N"),
            )
            for order, size in enumerate(prediction.orders_of("dte"), 1)
        ),
    )
    blocks: list[Block] = [
        numbers,
        Picture(
            "transmission_error",
            "Dynamic transmission error over time.",
            time,
            partial(cycle_figure, names=["dte"]),
        ),
        orders,
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
        blocks.append(
            Table(
                "modes",
                f"Natural frequencies of the time-averaged pair{springs}.",
                {
                    "frequency": "frequency",
                    "damping": "damping ratio",
                    "speed": "speed at which order 1 meets it",
                },
                tuple(
                    (Quantity(m.natural_frequency, "Hz"), m.damping_ratio, Quantity(m.resonant_speed, "rpm"))
                    for m in results.modes
                ),
            )
        )
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


CHAPTER = Chapter("response", "Response", write, seconds=1.5)
