"""Part of the cross-check chapter: why the models differ."""

from __future__ import annotations

import numpy as np
import xarray as xr

import multibody
from lumped import GearPair, NumericalError
from multibody.contact.effects import CAUSES
from validation.reporting.blocks import Block, Rows, Table, Text

_CAUSES = CAUSES | {"all": "all together"}
_QUANTITIES = {"dte": "transmission error", "x_p": "pinion x", "y_p": "pinion y"}


def attribution(pair: GearPair) -> xr.Dataset | None:
    """Effects of the exact model one by one; None where it has no periodic motion nearby."""
    try:
        return multibody.attribution(pair)
    except NumericalError:
        return None


def causes(found: xr.Dataset | None) -> list[Block]:
    """Table of what each finite-motion effect does; nothing without an ``attribution``."""
    if found is None:
        return []
    rows: Rows = []
    parts, loaded = str(found.attrs["parts"]).split(", "), found.attrs["contact"] == "loaded"
    listed = [str(cause) for cause in found["cause"].values]
    for cause in listed:
        text = _CAUSES[cause] + ("" if cause in (*parts, "all") else " (not part of all)")
        at = found.sel(cause=cause)
        values = [
            float(at[kind].sel(quantity=quantity))
            for quantity in _QUANTITIES
            for kind in ("alone", "without")
        ]
        if cause == "all":  # "without all of them" is the lumped motion itself
            values[1::2] = [np.nan] * len(_QUANTITIES)
        rows.append((text, *(None if np.isnan(value) else value for value in values)))
    largest = _CAUSES[str(found.attrs["largest"])]
    return [
        Text(
            "Why the models differ: the exact model's effects, each alone and all but each, in periodic "
            "motion with the brake torque that balances it. With all of them off it solves the lumped "
            "equations. "
            + ("The exact contact acts in every row; what the others change, they change of it. " * loaded)
            + f"The largest change of the transmission error: {largest}."
        ),
        Table(
            "causes",
            "Largest change of the motion by the exact model's effects, over its peak to peak.",
            {
                "cause": "effect",
                **{
                    f"{quantity}_{kind}": f"{title}, {words}"
                    for quantity, title in _QUANTITIES.items()
                    for kind, words in (("alone", "this alone"), ("without", "all but this"))
                },
            },
            tuple(rows),
            frozenset([listed.index(str(found.attrs["largest"]))]),
            note="Effects act together: where neither of two alone does much, both may."
            + (
                " Teeth enter late by half of their deflection if only entry shifts, and by half of the "
                "whole wind-up, bearings included, if the contact moves as well."
            )
            * (not loaded),
        ),
    ]
