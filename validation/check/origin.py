"""Attributes of the datasets of a check: what they were made from."""

from __future__ import annotations

from typing import Any

from lumped.labelling import provenance
from lumped.model.periodic_system import supports_of
from lumped.schema.pair import GearPair


def origin(pair: GearPair) -> dict[str, Any]:
    """Return the provenance of a result about the pair with its teeth as given and on its own supports."""
    teeth = "alike" if pair.healthy is pair else "as given"
    return provenance(pair) | {"teeth": teeth, "supports": supports_of(pair, None)}
