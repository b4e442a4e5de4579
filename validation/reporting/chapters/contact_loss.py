"""Contact loss: the motions beyond contact loss, and the speeds at which the pair jumps between motions."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr

from floquet.gear.motions import Basin, GearOrbit
from floquet.gear.response import Jump
from lumped.labelling import labelled_dataset
from validation.files.formatting import number
from validation.plots.prediction import over_speed_figure
from validation.plots.style import WIDTH
from validation.reporting.blocks import Block, Column, Content, Picture, Table, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.facts import facts_of
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    search = results.jump_search
    left_open = facts_of(results).get("jumps_left_open")
    unsearched = () if left_open is None else (Text(f"{left_open.claim[0].upper()}{left_open.claim[1:]}."),)
    if not search.branches:
        words = f"Contact is never lost {_over(results)}{results.on_springs}."
        if search.windows:
            words = f"Contact can be lost {_over(results)}{results.on_springs}."
        shared = _load_sharing(results)
        return Content(words, (*((Text(shared),) if shared else ()), *unsearched))
    lost = "Contact is lost" if results.contact_lost else "Contact is kept"
    windows = " and ".join(f"{number(low, 5)} to {number(high, 5)}" for low, high in search.windows)
    jumps = f"{_count(len(search.jumps), 'jump')} found{results.on_springs}"
    result = (
        f"{lost} at the operating point. {_over(results).capitalize()} contact can be lost at {windows} rpm; "
        f"there {jumps}."
    )
    blocks: list[Block] = [
        Picture(
            "motions_over_speed",
            "Peak to peak of every motion that was found over speed, with jumps.",
            motions(results),
            partial(over_speed_figure, operating_rpm=results.operating_rpm, size=(3.4, WIDTH)),
        ),
        _jumps_table(search.jumps),
    ]
    motions_at_speed = search.at(results.operating_rpm)
    if len(motions_at_speed) > 1:
        blocks.append(_motions_table(motions_at_speed))
    basins = _basins(results)
    if len(basins) > 1:
        blocks.append(_basins_table(basins))
    for attractor in search.attractors:
        blocks.append(Text(f"{attractor.text}."))
    for low_rpm, high_rpm in sorted(gap for branches in search.branches for gap in branches.gaps):
        blocks.append(
            Text(f"No motion that repeats is stable from {number(low_rpm, 5)} to {number(high_rpm, 5)} rpm.")
        )
    return Content(result, (*blocks, *unsearched))


def _jumps_table(jumps: Sequence[Jump]) -> Table:
    return table_of(
        "jumps",
        "Jumps: where a motion ends as the speed rises or falls.",
        jumps,
        (
            Column[Jump]("speed", "speed", lambda jump: jump.speed_rpm, "rpm"),
            Column[Jump]("way", "running", lambda jump: "up" if jump.rising else "down"),
            Column[Jump]("before", "transmission error before, rms", lambda jump: jump.dte_rms, "m"),
            Column[Jump]("after", "after, rms", lambda jump: jump.dte_rms_after, "m"),
            Column[Jump]("load", "largest tooth load after", lambda jump: jump.largest_load_after, "N"),
            Column[Jump]("motion", "motion after", lambda jump: str(jump.after)),
        ),
    )


def _motions_table(motions_at_speed: Sequence[GearOrbit]) -> Table:
    return table_of(
        "motions_here",
        "All motions that were found at the operating speed.",
        motions_at_speed,
        (
            Column[GearOrbit]("cycles", "mesh cycles", lambda orbit: orbit.n),
            Column[GearOrbit]("stable", "stable", lambda orbit: orbit.stable),
            Column[GearOrbit](
                "size", "transmission error, peak to peak", lambda orbit: orbit.peak_to_peak, "m"
            ),
            Column[GearOrbit]("load", "largest tooth load", lambda orbit: orbit.largest_load, "N"),
        ),
    )


def _basins_table(basins: Sequence[Basin]) -> Table:
    total = sum(basin.starts for basin in basins)
    return table_of(
        "basins",
        f"To which motion {total} random start states lead at the operating speed.",
        basins,
        (
            Column[Basin]("motion", "motion", lambda basin: str(basin.kind)),
            Column[Basin]("cycles", "mesh cycles", lambda basin: basin.n),
            Column[Basin](
                "size", "transmission error, peak to peak", lambda basin: basin.dte_peak_to_peak, "m"
            ),
            Column[Basin]("load", "largest tooth load", lambda basin: basin.largest_load, "N"),
            Column[Basin]("share", "share of the start states", lambda basin: basin.share, "1"),
            Column[Basin]("low", "at least (95 %)", lambda basin: basin.share_interval[0], "1"),
            Column[Basin]("high", "at most (95 %)", lambda basin: basin.share_interval[1], "1"),
        ),
    )


def _over(results: Results) -> str:
    """The range of speeds of the search in words."""
    low, high = results.speeds
    return f"from {number(low, 5)} to {number(high, 5)} rpm"


def _basins(results: Results) -> Sequence[Basin]:
    """Motions to which random start states lead at the operating speed; empty: no search there."""
    speed = results.operating_rpm
    for branches in results.jump_search.branches:
        low, high = branches.speeds_rpm
        if not low <= speed <= high:
            continue
        if any(orbit.stable for orbit in branches.at(speed)) or branches.attractors:
            return branches.basins()
    return ()


def _count(count: int, word: str) -> str:
    return f"no {word} was" if count == 0 else f"one {word} was" if count == 1 else f"{count} {word}s were"


def _load_sharing(results: Results) -> str:
    """Sentence on a tooth pair that carries no load while other pairs carry; empty: no pair does."""
    cycle = results.prediction.cycle
    idle = (cycle["contact"].to_numpy() > 0) & (cycle["normal_load"].to_numpy() <= 0.0)
    if not idle.any():
        return ""
    return "A tooth pair begins to carry late or ends early while others carry: load sharing by relief."


def motions(results: Results) -> xr.Dataset:
    """Return the dataset of ``over_speed_figure``: linear motion, range, unilateral motions and jumps."""
    data = linear_over_speed(results)
    search = results.jump_search
    datasets = [branches.dataset for branches in search.branches]
    speed, size, stable = (
        np.concatenate([dataset[name].to_numpy().astype(float) for dataset in datasets])
        for name in ("speed_rpm", "dte_peak_to_peak", "stable")
    )
    jumps = [jump for jump in search.jumps if np.isfinite(jump.dte_rms_after)]
    jump_speed = np.array([jump.speed_rpm for jump in jumps])
    before, after = (
        np.array([getattr(jump, f"dte_peak_to_peak{when}") for jump in jumps]) for when in ("", "_after")
    )
    roaming = [point for attractor in search.attractors for point in attractor.points]
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
            "jump_speed_rpm": (jump_speed, "rpm", "pinion speed"),
        },
    )
    return data.merge(more)


def linear_over_speed(results: Results) -> xr.Dataset:
    """Return the linear peak to peak over speed, with the range where the inputs were varied."""
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
