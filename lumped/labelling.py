"""Datasets whose variables all carry a unit and a plain name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

#: Dimensions, values, unit ("1" for none), plain name.
Variable = tuple[str | tuple[str, ...], Any, str, str]
#: Values along the dimension of the coordinate's own name, unit, plain name.
Coordinate = tuple[Any, str, str]


def labelled_dataset(
    variables: Mapping[str, Variable],
    coordinates: Mapping[str, Coordinate],
    attributes: Mapping[str, Any] | None = None,
) -> xr.Dataset:
    """Put arrays under their names, units and dimensions, see ``Variable`` and ``Coordinate``."""
    import xarray as xr  # takes a third of a second, which an import of the package should not

    return xr.Dataset(
        {
            name: (dims, values, {"units": unit, "long_name": text})
            for name, (dims, values, unit, text) in variables.items()
        },
        coords={
            name: (name, values, {"units": unit, "long_name": text})
            for name, (values, unit, text) in coordinates.items()
        },
        attrs=dict(attributes or {}),
    )
