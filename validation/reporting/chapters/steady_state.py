"""Periodic motion at the operating point, and over speed."""

from __future__ import annotations

import math

import numpy as np

from lumped import GearPair, bodies
from lumped.model.averaged import Mode
from lumped.model.results import VARIABLES
from lumped.model.steady import UNSTABLE
from validation.cross_check.metrics import mesh_orders
from validation.plots.motion import (
    motions_figure,
    sweep_figure,
    tooth_forces_figure,
    transmission_error_figure,
)
from validation.reporting import words
from validation.reporting.blocks import (
    Answer,
    Badge,
    Block,
    Content,
    Picture,
    Quantity,
    Table,
    Text,
    facts,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.words import cautions, largest_load, lawful, objections, unlawful

_ORDERS = 10


#: Sentences of a caption, where the figure has what they explain.
_DOTTED = " Dotted: speeds at which the mesh frequency meets a natural frequency of the averaged pair."
_NEGATIVE = " Where the smallest load is negative contact is lost and the lumped model is not valid."


def write(results: Results) -> Content:
    """Write the chapter."""
    pair, g, motion, multipliers = results.pair, results.geometry, results.motion, results.multipliers
    dte, attrs, largest = motion["dte"], motion.attrs, largest_load(results)[0]
    friction = float(motion["friction_power"].sum("pair").mean())
    radius = f"largest multiplier {multipliers.spectral_radius:.4g}"
    places = ("power_sliding", "power_tooth_dampers", "power_bearings")
    lost = sum(float(attrs[place]) for place in places) / (attrs["pinion_torque"] * g.omega_pinion)
    residual, brake = "of bearings and tooth dampers, see the form of the contact", "balances sliding alone"
    if pair.mesh.contact == "loaded":
        residual, brake = "the brake torque balances every loss", ""
    key_results = facts(
        "key_results",
        ("stability", "this periodic motion is", Badge(multipliers.verdict), "", radius),
        ("dte_peak_to_peak", "transmission error, peak to peak", attrs["dte_peak_to_peak"], "m"),
        ("dte_mean", "transmission error, mean", float(dte.mean()), "m"),
        ("largest_load", "largest load of a tooth pair", largest, "N"),
        ("dynamic_factor", "that load over the static load", largest / results.static_load),
        (
            "total_efficiency",
            "total efficiency",
            1.0 - lost,
            "",
            "all losses counted" if lawful(results) else f"do not rely on it: {unlawful(results)}",
        ),
        ("power_energy_residual", "energy residual", float(attrs["power_energy_residual"]), "W", residual),
        ("brake_torque", "brake torque that holds the speed", attrs["brake_torque"], "N m", brake),
        ("friction_power", "mean friction power", friction, "W", "negative: it is lost"),
        ("error_estimate", "estimated relative error of the motion", float(attrs["error_estimate"])),
    )
    names = ("dte", "x_p", "x_g", "y_p", "y_g")
    found = {name: mesh_orders(motion[name].to_numpy(), results.effort.samples, _ORDERS) for name in names}
    orders = Table(
        "mesh_orders",
        "Amplitudes by mesh order.",
        {"order": "order", **{name: VARIABLES[name][2] for name in names}},
        tuple(
            (order, *(Quantity(float(found[name].amplitude[order]), "m") for name in names))
            for order in range(1, _ORDERS + 1)
        ),
    )
    blocks: list[Block] = [
        *cautions(results),
        key_results,
        Picture(
            "transmission_error",
            "Dynamic transmission error over one mesh cycle (dotted: its mean) and its amplitudes by mesh "
            "order.",
            lambda: transmission_error_figure(pair, g, motion, found["dte"]),
        ),
        Picture(
            "tooth_forces",
            "Normal load and friction force of each tooth pair over one mesh cycle. Friction changes its "
            "sign at the pitch point P.",
            lambda: tooth_forces_figure(pair, g, motion),
        ),
        Picture(
            "motions",
            "Motion of the gear centres along (left) and off (right) the line of action.",
            lambda: motions_figure(g, motion),
        ),
        orders,
        *_over_speed(results),
    ]
    data = {"periodic_motion": motion, "speed_sweep": results.sweep}
    return Content(tuple(blocks), data=data)


def _over_speed(results: Results) -> list[Block]:
    sweep = results.sweep
    off = off_line_modes(results.pair, results.modes)
    places = [mode.resonant_speed for k, mode in enumerate(results.modes) if k not in off]
    speed = sweep["speed"].to_numpy()
    unstable = sweep["spectral_radius"].to_numpy() > UNSTABLE  # False where there is no periodic motion
    reached = np.where(unstable, np.nan, sweep["dte_peak_to_peak"].to_numpy())
    lost = speed[~sweep["periodic"].to_numpy().astype(bool)]
    blocks: list[Block] = [
        Picture(
            "speed_sweep",
            "Periodic motion over pinion speed."
            + (_DOTTED if any(speed[0] <= place <= speed[-1] for place in places) else "")
            + (_NEGATIVE if results.separating_share else "")
            + (" Crosses: unstable motions, which a pair leaves." if unstable.any() else ""),
            lambda: sweep_figure(sweep, results.operating_rpm, results.static_load, places),
        ),
        facts(
            "over_speed",
            ("speed_low", "lowest speed", float(speed[0]), "rpm"),
            ("speed_high", "highest speed", float(speed[-1]), "rpm"),
            ("speeds", "speeds computed", int(speed.size)),
            ("share_separating", "share of the range with negative loads", results.separating_share),
            (
                "share_unstable",
                "share of the range with an unstable motion",
                results.share_of_range(unstable),
            ),
            (
                "speed_of_largest",
                "speed of the largest transmission error",
                Quantity(float(speed[int(np.nanargmax(reached))]), "rpm")
                if np.isfinite(reached).any()
                else None,
                "",
                "among stable motions" if unstable.any() else "",
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
    blocks.append(
        table_of(
            "modes",
            "Modes of the time-averaged pair; ω1 to ω3 name the tongues of instability.",
            list(enumerate(results.modes)),
            {
                "label": ("name", lambda at: None if at[0] in off else f"ω{along.index(at[0]) + 1}"),
                "natural_frequency": (
                    "natural frequency",
                    lambda at: Quantity(at[1].natural_frequency, "Hz"),
                ),
                "damping_ratio": ("damping ratio", lambda at: at[1].damping_ratio),
                "resonant_speed": (
                    "pinion speed at mesh resonance",
                    lambda at: Quantity(at[1].resonant_speed, "rpm"),
                ),
                "motion": ("motion", lambda at: f"{'off' if at[0] in off else 'along'} the line of action"),
            },
        )
    )
    return blocks


def off_line_modes(pair: GearPair, modes: tuple[Mode, ...]) -> frozenset[int]:
    """Places in ``modes`` of the two modes off the line of action.

    Friction drives y_p and y_g but they do not act back, so two modes are those of the bearings alone: the
    nearest to sqrt(K/m). Shapes cannot tell, since equal gears have a third mode of that very frequency.
    """
    b, bearings = bodies(pair), pair.bearings
    found: set[int] = set()
    for stiffness, mass in (
        (bearings.pinion.oloa_stiffness, b.mass_pinion),
        (bearings.gear.oloa_stiffness, b.mass_gear),
    ):
        frequency = math.sqrt(stiffness / mass) / (2.0 * math.pi)
        free = [k for k in range(len(modes)) if k not in found]
        if free:
            found.add(min(free, key=lambda k: abs(modes[k].natural_frequency - frequency)))
    return frozenset(found)


def answer(results: Results) -> Answer:
    """What the model predicts, or that it is not to be relied on."""
    badge = Badge("violated", "not reliable") if objections(results) else Badge("prediction")
    return Answer("What does the model predict?", badge, words.motion(results))


CHAPTER = Chapter(
    "steady_state", "Periodic motion", write, answer, ("key_results", "speed_sweep", "over_speed"), seconds=3
)
