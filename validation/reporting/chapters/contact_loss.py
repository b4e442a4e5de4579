"""What the pair does where the linear motion has negative tooth loads."""

from __future__ import annotations

from functools import partial

import numpy as np

from floquet.gear.jump_map import jumps_removed_by
from floquet.gear.response import ResponseBranches
from lumped.model.results import load_range
from validation.plots.contact_loss import jump_map_figure, response_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.formatting import number, quantity
from validation.reporting.results import ContactLoss, Results
from validation.reporting.words import jumps, with_unilateral_contact

#: Most jumps of which it is looked for what removes them: some seconds each.
_FEW = 4
#: What a motion is that does not repeat.
_MOTIONS = {"beats": "beats", "chaos": "chaos", "grows": "grows beyond the backlash"}


def write(results: Results) -> Content | None:
    """Write the chapter; None where the linear model has no negative tooth loads at any speed."""
    found = results.contact_loss
    if found is None:
        about = (
            "Contact holds at the operating speed; at other speeds the linear model has negative tooth loads."
        )
        over_speed = _over_speed(results)
        return Content((Text(about), *over_speed)) if over_speed else None
    if isinstance(found, str):
        return Content((Text(f"No periodic motion with unilateral contact was found: {found}"),))
    orbit, linear, exact = found.orbit, results.motion, found.exact
    loads = linear["normal_load"].where(linear["contact"] > 0)
    rows: dict[str, tuple[float, float, float]] = {
        "linear model, teeth can pull": (
            float(linear.attrs["dte_peak_to_peak"]), float(loads.max()), float(loads.min())
        ),
        "same equations, unilateral contact": (
            orbit.dte_range[1] - orbit.dte_range[0], orbit.largest_load, 0.0
        ),
        "multibody model": (found.exact_peak_to_peak, float(exact["normal_load"].max()), 0.0),
    }  # fmt: skip
    stable = "a disturbance of it fades" if orbit.stable else "it is unstable: a pair leaves it"
    blocks: list[Block] = [
        Text(
            f"Smallest tooth load of the linear model: {quantity(float(loads.min()), 'N', 3)}. "
            f"{with_unilateral_contact(results)} The multipliers of this motion say that {stable} (largest "
            f"{number(orbit.spectral_radius, 3)} per mesh cycle). {_compared(results)}"
        ),
        table_of(
            "contact_loss",
            "The motion at the operating point with and without contact loss.",
            list(rows),
            {
                "model": ("model", str),
                "dte": ("transmission error, peak to peak", lambda name: Quantity(rows[name][0], "m")),
                "largest_load": ("largest load of a pair", lambda name: Quantity(rows[name][1], "N")),
                "smallest_load": ("smallest load of a pair", lambda name: Quantity(rows[name][2], "N")),
            },
        ),
    ]
    return Content((*blocks, *_over_speed(results)))


def _compared(results: Results) -> str:
    """Which motion the cross-check compares, and why."""
    found, linear = results.contact_loss, results.motion
    if isinstance(found, ContactLoss) and found.judged:
        return "The cross-check compares this motion."
    loads = linear["normal_load"].to_numpy(), linear["contact"].to_numpy()
    if load_range(results.pair.mesh.contact, *loads)[1] >= 0.0:
        return "The total mesh force is never negative, so the cross-check compares the linear motion."
    return "The cross-check compares it only where it is stable and no back sides of teeth touch."


def _over_speed(results: Results) -> list[Block]:
    """Branches of motions about the operating speed, and the jumps between them."""
    found = results.branches
    if found is None:
        return []
    if isinstance(found, str):
        return [Text(f"The motions over speed were not found: {found}")]
    blocks: list[Block] = [
        Picture(
            "response",
            "Motions with unilateral contact over speed, stable (solid) and unstable (dashed); arrows are "
            "jumps. Dotted: the linear model.",
            partial(response_figure, found.dataset, results.sweep),
        ),
        Text(f"{jumps(results)} {_removed(results)}".strip()),
    ]
    if found.jumps:
        blocks.append(
            table_of(
                "jumps",
                "Speeds at which a stable motion ends, and the motion right behind.",
                found.jumps,
                {
                    "speed": ("pinion speed", lambda jump: Quantity(jump.speed_rpm, "rpm")),
                    "way": ("running", lambda jump: "up" if jump.rising else "down"),
                    "before": ("rms before", lambda jump: Quantity(jump.dte_rms, "m")),
                    "load_before": ("largest load before", lambda jump: Quantity(jump.largest_load, "N")),
                    "after": ("rms after", lambda jump: _known(jump.dte_rms_after, "m")),
                    "load_after": ("largest load after", lambda jump: _known(jump.largest_load_after, "N")),
                    "kind": ("motion after", lambda jump: _MOTIONS.get(jump.after, _cycles(jump.n_after))),
                },
            )
        )
    return [*blocks, *_over_torque(results)]


def _over_torque(results: Results) -> list[Block]:
    """The jump map about the operating point; a sentence where nothing happens on it."""
    found = results.jump_map
    if found is None or isinstance(found, str):
        return [Text(f"Where the pair jumps at other torques was not found: {found}")] if found else []
    torques, speeds = found["torque"].to_numpy(), found["speed_rpm"].to_numpy()
    low, high = (quantity(float(value), "N m", 3) for value in torques[[0, -1]])
    where = f"At {torques.size} torques from {low} to {high} and the same speeds"
    if bool(((found["motions"] == 1) & found["contact_kept"]).all()):
        return [Text(f"{where} contact is never lost, and there is one stable motion everywhere.")]
    several = float((found["motions"] > 1).mean())
    largest = found["dte_rms_largest"]
    return [
        Text(
            f"{where} the pair has several stable motions at {number(100 * several, 2)}\u00a0% of the "
            f"points, the largest of {quantity(float(largest.max()), 'm', 3)} root mean square."
        ),
        Picture(
            "jump_map",
            f"Where the pair can jump, over speed and torque ({torques.size} torques, {speeds.size} speeds, "
            "motions of one mesh cycle, without friction, which hardly moves them); right: the largest "
            "stable motion.",
            partial(jump_map_figure, found),
        ),
    ]


def _known(value: float, unit: str) -> Quantity | None:
    return Quantity(value, unit) if np.isfinite(value) else None


def _cycles(n: int) -> str:
    return "repeats each mesh cycle" if n == 1 else f"repeats after {n} mesh cycles"


def _removed(results: Results) -> str:
    """Which torque or damping leaves no jumps."""
    found = results.branches
    if not isinstance(found, ResponseBranches) or not found.jumps:
        return ""
    if len(found.jumps) > _FEW:
        return "Which torque or damping removes them: spurcheck response --map."
    told = []
    for axis, name, unit in (
        ("torque", "a torque", "N m"),
        ("damping_ratio", "a damping ratio of the mesh", ""),
    ):
        for way in jumps_removed_by(found, axis):
            if way.found:
                value = quantity(way.value, unit, 3) if unit else number(way.value, 3)
                told.append(f"{name} {'above' if way.direction == 'larger' else 'below'} {value}")
    if not told:
        return "No torque from a quarter to four times the given one and no such damping removes all folds."
    return f"Stable motions have no folds here, and so do not end at once, with {' or '.join(told)}."


CHAPTER = Chapter(
    "contact_loss", "Contact loss", write, front=("contact_loss", "response", "jumps"), seconds=12
)
