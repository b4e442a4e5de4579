"""Where contact is lost, the motions there, and the speeds at which the pair jumps from one to another."""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from floquet.gear.response import ResponseBranches
from lumped.labelling import labelled_dataset
from lumped.outcomes import Absent, Outcome
from validation.files.formatting import number
from validation.plots.prediction import over_speed_figure
from validation.plots.style import WIDTH
from validation.reporting.blocks import Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import BRANCH_SPEEDS, Results


def write(results: Results) -> Content:
    """Write the chapter."""
    branches = results.branches
    if isinstance(branches, Absent):
        low, high = (number(f * results.operating_rpm, 5) for f in BRANCH_SPEEDS)
        kept = branches.outcome is Outcome.CONTACT_NOT_LOST
        words = (
            f"Contact is never lost from {low} to {high} rpm{results.on_springs}." if kept else str(branches)
        )
        shared = _load_sharing(results)
        return Content(words, (Text(shared),) if shared else ())
    jumps = branches.jumps
    lost = "Contact is lost" if results.contact_lost else "Contact is kept"
    low, high = (number(speed, 5) for speed in branches.speeds_rpm)
    found = f"{_count(len(jumps), 'jump')} found{results.on_springs}"
    result = f"{lost} at the operating point. From {low} to {high} rpm {found}."
    blocks: list[Block] = [
        Picture(
            "motions_over_speed",
            "Peak to peak of every motion that was found over speed, with jumps.",
            motions(results, branches),
            partial(over_speed_figure, operating_rpm=results.operating_rpm, size=(3.4, WIDTH)),
        ),
        table_of(
            "jumps",
            "Jumps: where a motion ends as the speed rises or falls.",
            jumps,
            {
                "speed": ("speed", lambda j: Quantity(j.speed_rpm, "rpm")),
                "way": ("running", lambda j: "up" if j.rising else "down"),
                "before": ("transmission error before, rms", lambda j: Quantity(j.dte_rms, "m")),
                "after": ("after, rms", lambda j: Quantity(j.dte_rms_after, "m")),
                "load": ("largest tooth load after", lambda j: Quantity(j.largest_load_after, "N")),
                "motion": ("motion after", lambda j: str(j.after)),
            },
        ),
    ]
    here = branches.at(results.operating_rpm)
    if len(here) > 1:
        blocks.append(
            table_of(
                "motions_here",
                "All motions that were found at the operating speed.",
                here,
                {
                    "cycles": ("mesh cycles", lambda o: o.n),
                    "stable": ("stable", lambda o: o.stable),
                    "size": (
                        "transmission error, peak to peak",
                        lambda o: Quantity(o.peak_to_peak, "m"),
                    ),
                    "load": ("largest tooth load", lambda o: Quantity(o.largest_load, "N")),
                },
            )
        )
    shares = branches.basins() if any(o.stable for o in here) or branches.attractors else ()
    if len(shares) > 1:
        total = sum(one.starts for one in shares)
        blocks.append(
            table_of(
                "basins",
                f"To which motion {total} random start states lead at the operating speed.",
                shares,
                {
                    "motion": ("motion", lambda one: str(one.kind)),
                    "cycles": ("mesh cycles", lambda one: one.n),
                    "size": (
                        "transmission error, peak to peak",
                        lambda one: Quantity(one.dte_peak_to_peak, "m"),
                    ),
                    "load": ("largest tooth load", lambda one: Quantity(one.largest_load, "N")),
                    "share": ("share of the start states", lambda one: Quantity(one.share, "1")),
                    "low": ("at least (95 %)", lambda one: Quantity(one.share_interval[0], "1")),
                    "high": ("at most (95 %)", lambda one: Quantity(one.share_interval[1], "1")),
                },
            )
        )
    for one in branches.attractors:
        blocks.append(Text(f"{one.text}."))
    for low_rpm, high_rpm in branches.gaps:
        blocks.append(
            Text(f"No motion that repeats is stable from {number(low_rpm, 5)} to {number(high_rpm, 5)} rpm.")
        )
    return Content(result, tuple(blocks))


def _count(count: int, word: str) -> str:
    return f"no {word} was" if count == 0 else f"one {word} was" if count == 1 else f"{count} {word}s were"


def _load_sharing(results: Results) -> str:
    """A note where a pair carries nothing for a time while others do: what relief is for."""
    cycle = results.prediction.cycle
    idle = (cycle["contact"].to_numpy() > 0) & (cycle["normal_load"].to_numpy() <= 0.0)
    if not idle.any():
        return ""
    return "A tooth pair begins to carry late or ends early while others carry: load sharing by relief."


def motions(results: Results, branches: ResponseBranches) -> xr.Dataset:
    """What ``over_speed_figure`` draws: linear motion, range, motions with unilateral contact, jumps."""
    data = linear_over_speed(results)
    period = results.pair.geometry.mesh_period * results.operating_rpm
    orbits = [orbit for branch in branches.branches for orbit in branch.orbits]
    speed = np.array([period / orbit.period for orbit in orbits])
    size = np.array([orbit.run.most - orbit.run.least for orbit in orbits])
    # As in the saved motions: a bifurcation belongs to the stable motions before it.
    stable = branches.dataset["stable"].to_numpy().astype(float)
    jumps = [j for j in branches.jumps if np.isfinite(j.dte_rms_after)]
    at = np.array([j.speed_rpm for j in jumps])
    before, after = (
        np.array([getattr(j, f"dte_peak_to_peak{when}") for j in jumps]) for when in ("", "_after")
    )
    roaming = [point for one in branches.attractors for point in one.points]
    text = "transmission error, peak to peak"
    more = labelled_dataset(
        {
            "motion": ("motion_speed_rpm", size, "m", f"{text}, unilateral contact"),
            "motion_stable": ("motion_speed_rpm", stable, "1", "whether the motion is stable"),
            "jump_from": ("jump_speed_rpm", before, "m", f"{text}, before the jump"),
            "jump_to": ("jump_speed_rpm", after, "m", f"{text}, after the jump"),
            "roaming": (
                "roaming_speed_rpm",
                np.array([point.dte_peak_to_peak for point in roaming]),
                "m",
                f"{text}, beats or chaos",
            ),
        },
        {
            "roaming_speed_rpm": (np.array([point.speed_rpm for point in roaming]), "rpm", "pinion speed"),
            "motion_speed_rpm": (speed, "rpm", "pinion speed"),
            "jump_speed_rpm": (at, "rpm", "pinion speed"),
        },
    )
    return data.merge(more)


def linear_over_speed(results: Results) -> xr.Dataset:
    """Linear peak to peak over speed, and its range where the inputs were varied."""
    sweep, band = results.sweep, results.band
    speeds = sweep["speed"].to_numpy()
    size, pushes = sweep["dte_peak_to_peak"].to_numpy(), sweep["normal_load_min"].to_numpy() > 0.0
    stable = sweep["spectral_radius"].to_numpy() <= 1.0
    text = "transmission error, peak to peak"
    variables = {
        "linear": ("speed_rpm", np.where(stable & pushes, size, np.nan), "m", text),
        "pulling": (
            "speed_rpm",
            np.where(stable & ~pushes, size, np.nan),
            "m",
            f"{text}, a tooth pair pulls",
        ),
    }
    if isinstance(band, xr.Dataset):
        for name in ("low", "high"):
            ends = np.interp(speeds, band["speed_rpm"], band[name])
            variables[name] = ("speed_rpm", ends, "m", str(band[name].attrs["long_name"]))
    return labelled_dataset(variables, {"speed_rpm": (speeds, "rpm", "pinion speed")})


CHAPTER = Chapter("contact_loss", "Contact loss and jumps", write, seconds=2.0)
