"""Mistakes of the tenth set, each a change of the drawing, the line of action, the model or the curves."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line, Wheel, drawing_of
from benchmarks.foreign_models.laws import constant, mean_roughness, unit_load, velocities
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.recipe import Curves

#: Viscosity of the axle's oil at 40 degrees [Pa s].
AT_40_DEGREES = 0.030

#: Inertia of the motor's rotor over that of the pinion.
ROTOR = 8.0

#: Harmonics that are kept of the mesh stiffness.
HARMONICS = 2

#: Points of a mesh cycle in the table of the mesh stiffness.
POINTS = 8


def _both(drawing: Drawing, change: Callable[[Wheel], Wheel]) -> Drawing:
    return replace(drawing, pinion=change(drawing.pinion), gear=change(drawing.gear))


def _file(drawing: Drawing, section: str, **values: Any) -> Drawing:
    """The drawing of a file with other numbers in a section."""
    pair = copy.deepcopy(dict(drawing.parameters))
    pair[section] = pair[section] | values
    return drawing_of(pair)


def _stiffer(model: Model, factor: float) -> Model:
    stiffness = model.stiffness
    return model.but(stiffness=lambda xi: factor * stiffness(xi))


def inertias_exchanged(model: Model) -> Model:
    return model.but(inertia_p=model.inertia_g, inertia_g=model.inertia_p)


def angle_of_20(drawing: Drawing) -> Drawing:
    return _file(drawing, "basic_rack", pressure_angle=20.0)


def standard_distance(drawing: Drawing) -> Drawing:
    teeth = drawing.pinion.teeth + drawing.gear.teeth
    return replace(drawing, centre_distance=0.5 * drawing.module * teeth)


def standard_tips(drawing: Drawing) -> Drawing:
    return _both(drawing, lambda one: replace(one, tip_radius=drawing.module * (0.5 * one.teeth + 1.0)))


def speed_of_gear(drawing: Drawing) -> Drawing:
    return replace(drawing, speed=drawing.speed * drawing.pinion.teeth / drawing.gear.teeth)


def wider_width(model: Model) -> Model:
    widths = model.drawing.pinion.width, model.drawing.gear.width
    return _stiffer(model, max(widths) / min(widths))


def solid_discs(drawing: Drawing) -> Drawing:
    return _both(drawing, lambda one: replace(one, bore=0.0))


def with_rotor(model: Model) -> Model:
    return model.but(inertia_p=(1.0 + ROTOR) * model.inertia_p)


def pitch_radii(line: Line) -> Line:
    ratio = line.base_radius_g / line.base_radius_p
    cosine = line.base_radius_p / math.hypot(line.base_radius_p, line.pitch_point)
    return replace(
        line, base_radius_p=line.base_radius_p / cosine, base_radius_g=ratio * line.base_radius_p / cosine
    )


def same_period(model: Model) -> Model:
    """The model at its true mesh frequency, that of the speed and the number of teeth."""
    true = 2.0 * math.pi / (model.speed * model.drawing.pinion.teeth)
    return model.but(period_factor=true / model.period)


def circular_pitch(line: Line) -> Line:
    reference = math.hypot(line.base_radius_p, line.pitch_point)
    return replace(line, base_pitch=line.base_pitch * reference / line.base_radius_p)


def sum_of_roughness(drawing: Drawing) -> Drawing:
    return _both(drawing, lambda one: replace(one, roughness=2.0 * one.roughness))


def cold_oil(drawing: Drawing) -> Drawing:
    return replace(drawing, viscosity=AT_40_DEGREES)


def mesh_for_pair(model: Model) -> Model:
    return _stiffer(model, 0.75 * model.line.contact_ratio + 0.25)


def rectangular(model: Model) -> Model:
    middle = np.array([0.5 * (model.line.start + model.line.end)])
    return model.but(stiffness=constant(float(model.stiffness(middle)[0])))


def without_foundation(model: Model) -> Model:
    """The compliance of the energy method without the term of the gear bodies."""
    import lumped
    from lumped.stiffness.energy import pair_compliance

    stiffness, line = model.stiffness, model.line
    pair = lumped.load_gear_pair(dict(model.drawing.parameters))
    places = np.linspace(line.start, line.end, 400)
    parts = pair_compliance(pair, places)
    bodies = parts.pinion.foundation + parts.gear.foundation
    return model.but(stiffness=lambda xi: 1.0 / (1.0 / stiffness(xi) - np.interp(xi, places, bodies)))


def _active(table: np.ndarray) -> np.ndarray:
    number: np.ndarray = (table["stiffness"] > 0.0).sum(axis=0)
    return number


def equal_halves(table: np.ndarray) -> np.ndarray:
    result = table.copy()
    on = table["stiffness"] > 0.0
    for name in ("stiffness", "damping"):
        result[name] = np.where(on, table[name].sum(axis=0) / _active(table), 0.0)
    result["share"] = np.where(on, 1.0 / _active(table), 0.0)
    return result


def static_friction(model: Model) -> Model:
    return model.but(others={"static_load": model.torque / model.line.base_radius_p})


def friction_one_way(model: Model) -> Model:
    friction = model.friction
    return model.but(friction=lambda xi: np.abs(friction(xi)))


def friction_reversed(model: Model) -> Model:
    friction = model.friction
    return model.but(friction=lambda xi: -friction(xi))


def _xu_kahraman(model: Model, entrainment: float, length: float) -> Model:
    """Law of Xu and Kahraman as the user typed it.

    ``entrainment`` : over the sum of the rolling velocities
    ``length`` : metres in the user's unit of the radius
    """
    drawing, line = model.drawing, model.line
    p, g = drawing.pinion, drawing.gear
    eta = drawing.viscosity * 1e3
    modulus = 2.0 / ((1.0 - p.poisson**2) / p.modulus + (1.0 - g.poisson**2) / g.modulus)
    load = unit_load(drawing, line) * 1e3

    def law(xi: np.ndarray) -> np.ndarray:
        sliding, total = velocities(drawing, line, xi)
        mean = entrainment * total
        ratio = np.maximum(np.abs(sliding / mean), 1e-12)
        radius = xi * (line.length - xi) / line.length
        pressure = np.sqrt(load * modulus / (2.0 * np.pi * radius)) * 1e-9
        group = ratio * pressure * np.log10(eta)
        f = -8.916465 - 0.354068 * group + 2.812084 * np.exp(-group)
        f = f + 0.620305 * np.exp(mean_roughness(drawing))
        size = np.exp(f) * pressure**1.03303 * ratio**1.036077 * mean**-0.100601 * eta**0.752755
        return np.sign(sliding) * size * (radius / length) ** -0.390958

    return model.but(friction=law)


def sum_of_velocities(model: Model) -> Model:
    return _xu_kahraman(model, entrainment=1.0, length=1.0)


def radius_in_mm(model: Model) -> Model:
    return _xu_kahraman(model, entrainment=0.5, length=1e-3)


def damping_of_one_pair(table: np.ndarray) -> np.ndarray:
    result = table.copy()
    on = table["stiffness"] > 0.0
    result["damping"] = np.where(on, table["damping"].max(axis=0) / _active(table), 0.0)
    return result


def without_factor_two(model: Model) -> Model:
    damping = model.damping
    return model.but(damping=lambda model, xi: 0.5 * damping(model, xi))


def mesh_without_bearings(model: Model) -> Model:
    return model.but(others={"x_in_approach": 0.0})


def relief_twice(model: Model) -> Model:
    gap = model.error
    return model.but(error=lambda xi: 2.0 * gap(xi))


def few_harmonics(model: Model) -> Model:
    def factor(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
        series = np.fft.rfft(total)
        series[HARMONICS + 1 :] = 0.0
        result: np.ndarray = np.fft.irfft(series, total.size) / total
        return result

    return model.but(total=factor)


def coarse_table(model: Model) -> Model:
    def factor(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
        points = np.arange(POINTS + 1) / POINTS
        values = total[(points[:-1] * total.size).astype(int)]
        result: np.ndarray = np.interp(phase, points, np.r_[values, values[0]]) / total
        return result

    return model.but(total=factor)


def dte_in_radians(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] / model.line.base_radius_g}


def dte_reversed(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": -curves["dte"]}


def dte_without_mean(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] - curves["dte"].mean()}


def dte_of_rotations(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] - curves["x_p"] + curves["x_g"]}


def in_degrees(curves: Curves, model: Model) -> Curves:
    return curves | {name: np.degrees(curves[name]) for name in ("theta_p", "theta_g")}


def on_housing(curves: Curves, model: Model) -> Curves:
    return curves | {name: -values for name, values in curves.items() if name.startswith("bearing_force")}


def of_springs(curves: Curves, model: Model) -> Curves:
    stiffness = model.bearing_stiffness
    return curves | {
        f"bearing_force_{where[0]}_{where[1]}": -value * curves[f"{where[0]}_{where[1]}"]
        for where, value in stiffness.items()
    }


def over_angle(curves: Curves, model: Model) -> Curves:
    return curves | {"time": model.speed * curves["time"]}


def gear_in_sense_of_pinion(curves: Curves, model: Model) -> Curves:
    return curves | {"theta_g": -curves["theta_g"]}


def period_of_gear(model: Model) -> Model:
    return model.but(period_factor=model.drawing.gear.teeth / model.drawing.pinion.teeth)
