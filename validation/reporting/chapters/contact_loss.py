"""Where contact is lost, the motions there, and the speeds at which the pair jumps from one to another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr

from floquet.gear.motions import Basin
from lumped.labelling import labelled_dataset
from validation.files.formatting import number
from validation.plots.prediction import over_speed_figure
from validation.plots.style import WIDTH
from validation.reporting.blocks import Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.facts import facts
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    search = results.jump_search
    left = facts(results).get("jumps_left_open")
    unsearched = () if left is None else (Text(f"{left.claim[0].upper()}{left.claim[1:]}."),)
    if not search.branches:
        words = f"Contact is never lost {_over(results)}{results.on_springs}."
        if search.windows:
            words = f"Contact can be lost {_over(results)}{results.on_springs}."
        shared = _load_sharing(results)
        return Content(words, (*((Text(shared),) if shared else ()), *unsearched))
    jumps = search.jumps
    lost = "Contact is lost" if results.contact_lost else "Contact is kept"
    windows = " and ".join(f"{number(low, 5)} to {number(high, 5)}" for low, high in search.windows)
    found = f"{_count(len(jumps), 'jump')} found{results.on_springs}"
    result = (
        f"{lost} at the operating point. {_over(results).capitalize()} contact can be lost at {windows} rpm; "
        f"there {found}."
    )
    blocks: list[Block] = [
        Picture(
            "motions_over_speed",
            "Peak to peak of every motion that was found over speed, with jumps.",
            motions(results),
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
    here = search.at(results.operating_rpm)
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
    shares = _basins(results)
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
    for one in search.attractors:
        blocks.append(Text(f"{one.text}."))
    for low_rpm, high_rpm in sorted(gap for branches in search.branches for gap in branches.gaps):
        blocks.append(
            Text(f"No motion that repeats is stable from {number(low_rpm, 5)} to {number(high_rpm, 5)} rpm.")
        )
    return Content(result, (*blocks, *unsearched))


def _over(results: Results) -> str:
    """The speeds of the search in words."""
    low, high = results.speeds
    return f"from {number(low, 5)} to {number(high, 5)} rpm"


def _basins(results: Results) -> Sequence[Basin]:
    """To which motions start states lead at the operating speed, where its window was searched."""
    own = results.operating_rpm
    for branches in results.jump_search.branches:
        low, high = branches.speeds_rpm
        if low <= own <= high and (any(o.stable for o in branches.at(own)) or branches.attractors):
            return branches.basins()
    return ()


def _count(count: int, word: str) -> str:
    return f"no {word} was" if count == 0 else f"one {word} was" if count == 1 else f"{count} {word}s were"


def _load_sharing(results: Results) -> str:
    """A note where a pair carries nothing for a time while others do: what relief is for."""
    cycle = results.prediction.cycle
    idle = (cycle["contact"].to_numpy() > 0) & (cycle["normal_load"].to_numpy() <= 0.0)
    if not idle.any():
        return ""
    return "A tooth pair begins to carry late or ends early while others carry: load sharing by relief."


def motions(results: Results) -> xr.Dataset:
    """What ``over_speed_figure`` draws: linear motion, range, motions with unilateral contact, jumps."""
    data = linear_over_speed(results)
    search = results.jump_search
    saved = [branches.dataset for branches in search.branches]
    speed, size, stable = (
        np.concatenate([one[name].to_numpy().astype(float) for one in saved])
        for name in ("speed_rpm", "dte_peak_to_peak", "stable")
    )
    jumps = [j for j in search.jumps if np.isfinite(j.dte_rms_after)]
    at = np.array([j.speed_rpm for j in jumps])
    before, after = (
        np.array([getattr(j, f"dte_peak_to_peak{when}") for j in jumps]) for when in ("", "_after")
    )
    roaming = [point for one in search.attractors for point in one.points]
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
    sweep = results.sweep
    band = results.band
    speeds = sweep["speed"].to_numpy()
    size = sweep["dte_peak_to_peak"].to_numpy()
    pushes = sweep["normal_load_min"].to_numpy() > 0.0
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
    if isinstance(band, xr.Dataset) and band["low"].notnull().any():
        for name in ("low", "high"):
            ends = np.interp(speeds, band["speed_rpm"], band[name])
            variables[name] = ("speed_rpm", ends, "m", str(band[name].attrs["long_name"]))
    return labelled_dataset(variables, {"speed_rpm": (speeds, "rpm", "pinion speed")})


CHAPTER = Chapter("contact_loss", "Contact loss and jumps", write, seconds=2.0)
