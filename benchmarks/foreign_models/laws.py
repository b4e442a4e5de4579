"""Stiffness of a tooth pair and signed coefficient of friction over the path of contact, coded by the user.

Sources: ISO 6336-1 method B; Benedict and Kelley 1961; Xu and Kahraman 2007; docs/theory/friction.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line

#: A law over the distance from X [m].
Law = Callable[[np.ndarray], np.ndarray]

#: Samples of a mesh cycle in the stiffness that the user exports.
EXPORTED = 2048


def iso_single_stiffness(drawing: Drawing) -> float:
    """c' of ISO 6336-1 method B [N/(mm um)]."""
    small, large = sorted((drawing.pinion, drawing.gear), key=lambda wheel: (wheel.teeth, -wheel.shift))
    flexibility = (
        0.04723
        + 0.15551 / small.teeth
        + 0.25791 / large.teeth
        - 0.00635 * small.shift
        - 0.11654 * small.shift / small.teeth
        - 0.00193 * large.shift
        - 0.24188 * large.shift / large.teeth
        + 0.00529 * small.shift**2
        + 0.00182 * large.shift**2
    )
    rack = (1.0 + 0.5 * (1.2 - drawing.dedendum)) * (
        1.0 - 0.02 * (20.0 - math.degrees(drawing.pressure_angle))
    )
    modulus = 2.0 * small.modulus * large.modulus / (small.modulus + large.modulus)
    return 0.8 * rack * modulus / 206e9 / flexibility


def constant(value: float) -> Law:
    return lambda xi: np.full_like(xi, value)


def parabola(line: Line, peak: float, end_ratio: float) -> Law:
    """Parabola over the path of contact, with its peak in the middle."""
    middle, half = 0.5 * (line.start + line.end), 0.5 * (line.end - line.start)
    return lambda xi: peak * (1.0 - (1.0 - end_ratio) * ((xi - middle) / half) ** 2)


def sampled(places: np.ndarray, values: np.ndarray) -> Law:
    """Straight lines between samples."""
    return lambda xi: np.interp(xi, places, values)


@cache
def _exported(text: str) -> tuple[np.ndarray, np.ndarray]:
    import tomllib  # the parameter file travels as text, because a mapping cannot be a key

    import lumped

    pair = lumped.load_gear_pair(tomllib.loads(text))
    curve = lumped.mesh_stiffness(pair, EXPORTED)
    phase, values = curve["phase"].to_numpy(), curve["pair_stiffness"].transpose("pair", "phase").to_numpy()
    pairs = values.shape[0]
    cycles = np.concatenate([phase + index for index in range(pairs)])
    stiffness = values.reshape(-1)
    order = np.argsort(cycles)
    cycles, stiffness = cycles[order], stiffness[order]
    loaded = stiffness > 0.0
    return cycles[loaded], stiffness[loaded]


def exported_stiffness(drawing: Drawing, line: Line) -> Law:
    """Stiffness of a tooth pair that the user exported with ``lumped.mesh_stiffness`` and interpolates."""
    from benchmarks.foreign_models.pairs import as_toml

    cycles, stiffness = _exported(as_toml(drawing.parameters))
    return sampled(line.start + cycles * line.base_pitch, stiffness)


def stiffness_law(drawing: Drawing, line: Line) -> Law:
    """Stiffness of a tooth pair [N/m] between start and end of contact."""
    table = drawing.stiffness
    size = iso_single_stiffness(drawing) * 1e9 * drawing.width
    if table["model"] == "rectangular":
        law = constant(table.get("pair_stiffness", size))
    elif table["model"] == "parabolic":
        end_ratio = table.get("end_ratio", 0.25 + 0.75 / line.contact_ratio)
        law = parabola(line, table.get("peak", size), end_ratio)
    else:
        return exported_stiffness(drawing, line)
    factor = drawing.stiffness_factor
    return lambda xi: factor * law(xi)


def coulomb(line: Line, size: float) -> Law:
    return lambda xi: size * np.sign(xi - line.pitch_point)


def smoothed_coulomb(line: Line, size: float, sharpness: float) -> Law:
    """Sharpness in 1/m."""

    def law(xi: np.ndarray) -> np.ndarray:
        d = sharpness * (xi - line.pitch_point)
        return 2.0 * size / np.pi * (np.arctan(d) + d / (1.0 + d * d))

    return law


def velocities(drawing: Drawing, line: Line, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sliding velocity, signed, and sum of the rolling velocities [m/s]."""
    of_pinion = drawing.speed * xi
    of_gear = drawing.speed * drawing.pinion.teeth / drawing.gear.teeth * (line.length - xi)
    return of_pinion - of_gear, of_pinion + of_gear


def unit_load(drawing: Drawing, line: Line) -> float:
    """Full static load over face width [N/mm]."""
    return drawing.torque / line.base_radius_p / drawing.width * 1e-3


def mean_roughness(drawing: Drawing) -> float:
    """Mean Ra of both gears [um]."""
    return 0.5e6 * (drawing.pinion.roughness + drawing.gear.roughness)


def benedict_kelley(drawing: Drawing, line: Line, maximum: float) -> Law:
    factor = 0.0127 * 1.13 / (1.13 - mean_roughness(drawing))
    eta = drawing.viscosity * 1e3

    def law(xi: np.ndarray) -> np.ndarray:
        sliding, entraining = velocities(drawing, line, xi)
        with np.errstate(divide="ignore"):
            mu = factor * np.log10(
                29700.0 * unit_load(drawing, line) / (eta * np.abs(sliding) * entraining**2)
            )
        return np.sign(sliding) * np.clip(mu, 0.0, maximum)

    return law


def xu_kahraman(drawing: Drawing, line: Line) -> Law:
    eta = drawing.viscosity * 1e3
    p, g = drawing.pinion, drawing.gear
    modulus = 2.0 / ((1.0 - p.poisson**2) / p.modulus + (1.0 - g.poisson**2) / g.modulus)
    load = unit_load(drawing, line) * 1e3

    def law(xi: np.ndarray) -> np.ndarray:
        sliding, entraining = velocities(drawing, line, xi)
        radius = xi * (line.length - xi) / line.length
        pressure = np.sqrt(load * modulus / (2.0 * np.pi * radius)) * 1e-9
        ratio = np.maximum(np.abs(2.0 * sliding / entraining), 1e-12)
        group = ratio * pressure * np.log10(eta)
        f = -8.916465 - 0.354068 * group + 2.812084 * np.exp(-group)
        f = f + 0.620305 * np.exp(mean_roughness(drawing))
        mu = np.exp(f) * pressure**1.03303 * ratio**1.036077 * (0.5 * entraining) ** -0.100601
        return np.sign(sliding) * mu * eta**0.752755 * radius**-0.390958

    return law


def iso_14179(drawing: Drawing, line: Line) -> Law:
    at_pitch = np.array([line.pitch_point])
    entraining = velocities(drawing, line, at_pitch)[1][0]
    radius = line.pitch_point * (line.length - line.pitch_point) / line.length * 1e3
    mu = 0.048 * (unit_load(drawing, line) / (entraining * radius)) ** 0.2
    mu *= (drawing.viscosity * 1e3) ** -0.05 * mean_roughness(drawing) ** 0.25
    return coulomb(line, float(mu))


def friction_law(drawing: Drawing, line: Line) -> Law:
    """Coefficient of friction with its sign: negative in approach."""
    table = drawing.friction
    match table["law"]:
        case "none":
            return constant(0.0)
        case "coulomb":
            return coulomb(line, table["coefficient"])
        case "smoothed_coulomb":
            return smoothed_coulomb(line, table["coefficient"], table.get("sharpness", 50.0) * 1e3)
        case "benedict_kelley":
            return benedict_kelley(drawing, line, table.get("maximum", 0.2))
        case "xu_kahraman":
            return xu_kahraman(drawing, line)
        case "iso_14179":
            return iso_14179(drawing, line)
    raise ValueError(f"the user has no friction law {table['law']}")
