"""Periodic motion at the operating point, and over speed."""

from __future__ import annotations

import math

import numpy as np

from lumped import bodies
from lumped.model.periodic_cycle import UNSTABLE
from lumped.model.results import VARIABLES
from validation import plots
from validation.reporting.blocks import (
    Badge,
    Block,
    Cell,
    Chapter,
    Fact,
    Facts,
    Picture,
    Quantity,
    Rows,
    Table,
    Text,
)
from validation.reporting.results import Results
from validation.validity.flags import LOAD_NOISE


def steady_state(results: Results) -> Chapter:
    """Write the chapter."""
    pair, g, motion = results.pair, results.geometry, results.motion
    load = motion["normal_load"].to_numpy()
    touching = motion["contact"].to_numpy() > 0
    largest = float(load[touching].max())
    friction = float(motion["friction_power"].sum("pair").mean())
    facts = Facts(
        "key_results",
        (
            Fact(
                "stability",
                "this periodic motion is",
                Badge(results.multipliers.verdict),
                f"largest multiplier {results.multipliers.spectral_radius:.4g}",
            ),
            Fact(
                "dte_peak_to_peak",
                "transmission error, peak to peak",
                Quantity(float(np.ptp(motion["dte"].to_numpy())), "m"),
            ),
            Fact("dte_mean", "transmission error, mean", Quantity(float(motion["dte"].mean()), "m")),
            Fact("largest_load", "largest load of a tooth pair", Quantity(largest, "N")),
            Fact("dynamic_factor", "that load over the static load", largest / results.static_load),
            Fact(
                "mesh_efficiency",
                "mesh efficiency",
                float(motion.attrs["mesh_efficiency"]),
                "friction losses only",
            ),
            Fact(
                "brake_torque",
                "brake torque that holds the speed",
                Quantity(motion.attrs["brake_torque"], "N m"),
            ),
            Fact("friction_power", "mean friction power", Quantity(friction, "W"), "negative: it is lost"),
            Fact(
                "error_estimate",
                "estimated relative error of the motion",
                float(motion.attrs["error_estimate"]),
            ),
        ),
    )
    names = ("dte", "x_p", "x_g", "y_p", "y_g")
    rows: Rows = []
    for order in range(1, 7):
        row: list[Cell] = [order]
        row += [Quantity(float(results.orders[name].amplitude[order]), "m") for name in names]
        rows.append(tuple(row))
    orders = Table(
        "mesh_orders",
        "Amplitudes by mesh order.",
        {"order": "order", **{name: VARIABLES[name][2] for name in names}},
        tuple(rows),
    )
    blocks: list[Block] = [
        *unstable_warning(results),
        facts,
        Picture(
            "transmission_error",
            "Dynamic transmission error over one mesh cycle (dotted: its mean) and its amplitudes by mesh "
            "order.",
            lambda: plots.transmission_error_figure(pair, g, motion, results.orders["dte"]),
        ),
        Picture(
            "tooth_forces",
            "Normal load and friction force of each tooth pair over one mesh cycle. Friction changes its "
            "sign at the pitch point P.",
            lambda: plots.tooth_forces_figure(pair, g, motion),
        ),
        Picture(
            "motions",
            "Motion of the gear centres along (left) and off (right) the line of action.",
            lambda: plots.motions_figure(g, motion),
        ),
        Picture(
            "motions_by_order",
            "The same motions by mesh order.",
            lambda: plots.orders_figure({name: results.orders[name] for name in names[1:]}),
        ),
        orders,
        *_over_speed(results),
    ]
    return Chapter("steady_state", "Periodic motion", tuple(blocks))


def _over_speed(results: Results) -> list[Block]:
    sweep = results.sweep
    off = off_line_modes(results)
    places = [mode.resonant_speed for k, mode in enumerate(results.modes) if k not in off]
    speed = sweep["speed"].to_numpy()
    unstable = sweep["spectral_radius"].to_numpy() > UNSTABLE  # False where there is no periodic motion
    reached = np.where(unstable, np.nan, sweep["dte_peak_to_peak"].to_numpy())
    lost = speed[~sweep["periodic"].to_numpy().astype(bool)]
    blocks: list[Block] = [
        Picture(
            "speed_sweep",
            "Periodic motion over pinion speed. Dotted: speeds at which the mesh frequency meets a natural "
            "frequency of the averaged pair. Where the smallest load is negative the teeth would separate "
            "and the lumped model is not valid."
            + (" Crosses: unstable motions, which a pair leaves." if unstable.any() else ""),
            lambda: plots.sweep_figure(sweep, results.operating_rpm, results.static_load, places),
        ),
        Facts(
            "over_speed",
            (
                Fact("speed_low", "lowest speed", Quantity(float(speed[0]), "rpm")),
                Fact("speed_high", "highest speed", Quantity(float(speed[-1]), "rpm")),
                Fact("speeds", "speeds computed", int(speed.size)),
                Fact(
                    "share_separating", "share of the speeds with negative loads", separating_share(results)
                ),
                Fact("share_unstable", "share of the speeds with an unstable motion", float(unstable.mean())),
                Fact(
                    "speed_of_largest",
                    "speed of the largest transmission error",
                    Quantity(float(speed[int(np.nanargmax(reached))]), "rpm")
                    if np.isfinite(reached).any()
                    else None,
                    "among stable motions" if unstable.any() else "",
                ),
            ),
        ),
    ]
    if lost.size:
        listed = ", ".join(f"{s:.5g} rpm" for s in lost)
        blocks.append(Text(f"No periodic motion exists at: {listed}."))
    if not results.modes:
        blocks.append(
            Text("A mode of the averaged pair is overdamped, so natural frequencies are not listed.")
        )
        return blocks
    along = [k for k in range(len(results.modes)) if k not in off]
    rows: Rows = [
        (
            None if k in off else f"ω{along.index(k) + 1}",
            Quantity(mode.natural_frequency, "Hz"),
            mode.damping_ratio,
            Quantity(mode.resonant_speed, "rpm"),
            "off the line of action" if k in off else "along the line of action",
        )
        for k, mode in enumerate(results.modes)
    ]
    blocks.append(
        Table(
            "modes",
            "Modes of the time-averaged pair; ω1 to ω3 name the tongues of instability.",
            {
                "label": "name",
                "natural_frequency": "natural frequency",
                "damping_ratio": "damping ratio",
                "resonant_speed": "pinion speed at mesh resonance",
                "motion": "motion",
            },
            tuple(rows),
        )
    )
    return blocks


def separating_share(results: Results) -> float:
    """Share of the computed speeds at which a tooth pair would have to pull."""
    low = results.sweep["normal_load_min"].to_numpy()  # NaN where there is no periodic motion
    return float(np.mean(low < -LOAD_NOISE * results.static_load))


def unstable_warning(results: Results) -> tuple[Text, ...]:
    """What a chapter on the periodic motion says first where that motion is not stable."""
    found = results.multipliers
    if found.verdict == "stable":
        return ()
    return (
        Text(
            f"Warning: the periodic motion at the operating point is {found.verdict} (largest multiplier "
            f"{found.spectral_radius:.4g}). What follows is a solution of the equations that a gear pair "
            "leaves at the smallest disturbance: not a prediction of what it does."
        ),
    )


def off_line_modes(results: Results) -> frozenset[int]:
    """Places in ``results.modes`` of the two modes off the line of action.

    Friction drives y_p and y_g but they do not act back, so two modes are those of the bearings alone: the
    nearest to sqrt(K/m). Shapes cannot tell, since equal gears have a third mode of that very frequency.
    """
    b, bearings = bodies(results.pair), results.pair.bearings
    found: set[int] = set()
    for stiffness, mass in (
        (bearings.pinion.oloa_stiffness, b.mass_pinion),
        (bearings.gear.oloa_stiffness, b.mass_gear),
    ):
        frequency = math.sqrt(stiffness / mass) / (2.0 * math.pi)
        free = [k for k in range(len(results.modes)) if k not in found]
        if free:
            found.add(min(free, key=lambda k: abs(results.modes[k].natural_frequency - frequency)))
    return frozenset(found)
