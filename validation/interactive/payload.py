"""Content of the interactive page as JSON: numbers rounded to what the page shows, units, plain names."""

from __future__ import annotations

import base64
import json
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from floquet.gear.axes import operating_rpm
from lumped.friction.registry import law_of
from lumped.model.results import LOAD_NOISE
from validation.interactive.results import PageResults, Slices
from validation.plots.stability import pretty
from validation.validity.flags import REVERSAL_LIMITS, STATES

#: Decimals of a largest multiplier, and significant digits of everything else.
DECIMALS = 6
DIGITS = 6


def payload(results: PageResults) -> dict[str, Any]:
    """Return the data that the script of the page reads.

    Numbers are rounded here, so that the page shows the digits of the data file. Arrays of the charts are
    little-endian in base64: float32 for the largest multiplier, int8 for the verdict (2 neutral, 1 stable,
    0 undecided, -1 unstable).
    """
    pair = results.pair
    return {
        "point": {"speed": operating_rpm(pair), "damping": pair.mesh.damping_ratio},
        "stability": [_slices(slices) for slices in results.stability.values()],
        "sweep": _sweep(results),
        "limits": {"load": LOAD_NOISE, "reversal": list(REVERSAL_LIMITS)},
    }


def script_json(data: Any) -> str:
    """Return JSON for use inside a script element: no character can end the element or open another one."""
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("&", r"\u0026").replace("<", r"\u003c").replace(">", r"\u003e")


def _slices(slices: Slices) -> dict[str, Any]:
    chart = slices.chart
    key = slices.key
    radius = np.round(chart["spectral_radius"].to_numpy(), DECIMALS).astype("<f4")
    return {
        "key": key,
        "name": chart[key].attrs["long_name"],
        "values": _numbers(chart[key]),
        "own": slices.index_of_pair,
        "speed": _numbers(chart["speed_rpm"]),
        "damping": _numbers(chart["damping_ratio"]),
        "radius": _base64(radius),
        "verdict": _base64(chart["verdict"].to_numpy().astype(np.int8)),
        "tongues": [
            [
                {
                    "name": pretty(str(region.label)),
                    "speed": _number(region.point["speed_rpm"]),
                    "damping": _number(region.point["damping_ratio"]),
                }
                for region in regions
            ]
            for regions in slices.tongues
        ],
    }


def _sweep(results: PageResults) -> dict[str, Any]:
    sweep = results.sweep
    micrometres = {"dte": "dte_peak_to_peak", "oloa": "y_p_peak_to_peak"}
    laws = []
    for index, law in enumerate(map(str, sweep["law"].to_numpy())):
        one = sweep.isel(law=index)
        laws.append(
            {
                "key": law,
                "name": law_of(results.pair.friction, law).title,
                "note": results.notes[index],
                **{name: _numbers(1e6 * one[variable].to_numpy()) for name, variable in micrometres.items()},
                "load": _numbers(one["lowest_load"]),
                "reversal": _numbers(one["reversal"]),
                "radius": _numbers(one["spectral_radius"]),
                "state": one["validity"].to_numpy().tolist(),
            }
        )
    return {
        "speed": _numbers(sweep["speed"]),
        "laws": laws,
        "own": results.own_law,
        "states": list(STATES),
        "resonances": _numbers(results.resonances),
    }


def _number(value: float) -> float | None:
    """Return a number rounded to ``DIGITS`` significant digits. None: the number is not finite."""
    return float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None


def _numbers(values: ArrayLike) -> list[float | None]:
    return [_number(float(value)) for value in np.asarray(values, dtype=float).ravel()]


def _base64(values: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")
