"""Which gear pairs the paper is about."""

from __future__ import annotations

from lumped import GearPair, load_gear_pair


def is_papers_pair(pair: GearPair) -> bool:
    """Whether a pair has the gears of the paper: teeth, module and pressure angle."""
    paper = load_gear_pair("nasa_28_28")
    return (pair.pinion.teeth, pair.gear.teeth, pair.basic_rack) == (
        paper.pinion.teeth,
        paper.gear.teeth,
        paper.basic_rack,
    )
