"""Changes that make the mistakes of the second, held-back set, where ``mistakes`` does not have them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line, Wheel, working_angle
from benchmarks.foreign_models.laws import constant, iso_single_stiffness, sampled
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.recipe import Curves

Shape = Callable[[np.ndarray, np.ndarray], np.ndarray]
OfModel = Callable[[Model], Model]
OfDrawing = Callable[[Drawing], Drawing]
OfCurves = Callable[[Curves, Model], Curves]


# --- stiffness and error of the profile ------------------------------------------------------------------


def rule_of_thumb(model: Model) -> Model:
    """Stiffness that corresponds to c' = 14 N/(mm um)."""
    law, factor = model.stiffness, 14.0 / iso_single_stiffness(model.drawing)
    return model.but(stiffness=lambda xi: factor * law(xi))


def exchanged_levels(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
    """Factor that exchanges the high and the low stiffness of the whole mesh."""
    return (total.max() + total.min() - total) / total


def scaled_variation(share: float) -> Shape:
    """Factor that leaves a share of the variation of the stiffness of the whole mesh."""
    return lambda phase, total: (total.mean() + share * (total - total.mean())) / total


def averaged_stiffness(share: float) -> Shape:
    """Factor that averages the stiffness of the whole mesh over a share of the cycle."""

    def factor(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
        half = round(0.5 * share * total.size)
        window = np.zeros(total.size)
        window[np.arange(-half, half + 1)] = 1.0 / (2 * half + 1)
        smooth = np.fft.irfft(np.fft.rfft(total) * np.fft.rfft(window), total.size)
        return smooth / total

    return factor


def harmonic_error(amount: float) -> OfModel:
    """A cosine at the mesh frequency, with this amplitude [m], is the error of all tooth pairs."""

    def change(model: Model) -> Model:
        line = model.line
        return model.but(error=lambda xi: amount * np.cos(2.0 * np.pi * (xi - line.start) / line.base_pitch))

    return change


def slope_error(amount: float) -> OfModel:
    """The error of a tooth pair grows from 0 to this amount [m] along the path of contact."""

    def change(model: Model) -> Model:
        line = model.line
        return model.but(error=lambda xi: amount * (xi - line.start) / (line.end - line.start))

    return change


def relief_of_pinion(amount: float, share: float) -> OfModel:
    """The pinion's tip is relieved by an amount [m] over a share of the path of contact."""

    def change(model: Model) -> Model:
        line = model.line
        begin = line.end - share * (line.end - line.start)
        return model.but(error=sampled(np.array([begin, line.end]), np.array([0.0, amount])))

    return change


# --- damping, masses -------------------------------------------------------------------------------------


def damper_of_mesh_frequency(model: Model) -> Model:
    """Damper 2 zeta k / omega with the mesh frequency in the place of the natural frequency."""
    omega = 2.0 * math.pi / model.period
    return model.but(damping=lambda other, xi: 2.0 * other.drawing.mesh_damping * other.stiffness(xi) / omega)


def moved_masses(factor: float) -> OfModel:
    """Masses in translation times a factor; inertias and dampers keep their values."""
    return lambda model: model.but(mass_p=factor * model.mass_p, mass_g=factor * model.mass_g)


def exchanged_masses(model: Model) -> Model:
    """Mass and inertia of the pinion on the gear and the other way round; dampers keep their values."""
    return model.but(
        mass_p=model.mass_g,
        mass_g=model.mass_p,
        inertia_p=model.inertia_g,
        inertia_g=model.inertia_p,
        damping=lambda other, xi: model.damping(model, xi),
    )


def density(value: float) -> OfDrawing:
    """Both gears have this density [kg/m^3]."""
    return lambda drawing: replace(
        drawing, pinion=replace(drawing.pinion, density=value), gear=replace(drawing.gear, density=value)
    )


# --- friction --------------------------------------------------------------------------------------------


def viscosity(pascal_seconds: float) -> OfDrawing:
    return lambda drawing: replace(drawing, viscosity=pascal_seconds)


def roughness(factor: float) -> OfDrawing:
    """Roughness of both gears times a factor."""

    def change(drawing: Drawing) -> Drawing:
        def rough(wheel: Wheel) -> Wheel:
            return replace(wheel, roughness=factor * wheel.roughness)

        return replace(drawing, pinion=rough(drawing.pinion), gear=rough(drawing.gear))

    return change


def without_friction(model: Model) -> Model:
    return model.but(friction=constant(0.0))


def coefficient_without_law(value: float) -> OfModel:
    """A constant coefficient that changes its sign at the pitch point."""

    def change(model: Model) -> Model:
        pitch_point = model.line.pitch_point
        return model.but(friction=lambda xi: value * np.sign(xi - pitch_point))

    return change


def pitch_point_of_rack(degrees: float) -> Callable[[Line], Line]:
    """The pitch point lies at r_b tan(alpha) with the pressure angle of the rack."""
    tangent = math.tan(math.radians(degrees))
    return lambda line: replace(line, pitch_point=line.base_radius_p * tangent)


# --- geometry --------------------------------------------------------------------------------------------


def teeth_of_gear(teeth: int) -> OfDrawing:
    """Another number of teeth on the gear; tips and centre distance keep their values."""
    return lambda drawing: replace(drawing, gear=replace(drawing.gear, teeth=teeth))


def centre_distance(metres: float) -> OfDrawing:
    return lambda drawing: replace(drawing, centre_distance=metres)


def reversed_shifts(drawing: Drawing) -> Drawing:
    """Both profile shifts with the other sign; tips and the centre distance without backlash follow."""

    def other(wheel: Wheel) -> Wheel:
        tip = wheel.tip_radius - 2.0 * wheel.shift * drawing.module
        return replace(wheel, shift=-wheel.shift, tip_radius=tip)

    pinion, gear = other(drawing.pinion), other(drawing.gear)
    teeth, alpha = pinion.teeth + gear.teeth, drawing.pressure_angle
    angle = working_angle(alpha, teeth, pinion.shift + gear.shift)
    distance = 0.5 * drawing.module * teeth * math.cos(alpha) / math.cos(angle)
    return replace(drawing, pinion=pinion, gear=gear, centre_distance=distance)


def chamfered(metres: float) -> OfDrawing:
    """Both tip radii are this much smaller."""

    def change(drawing: Drawing) -> Drawing:
        def short(wheel: Wheel) -> Wheel:
            return replace(wheel, tip_radius=wheel.tip_radius - metres)

        return replace(drawing, pinion=short(drawing.pinion), gear=short(drawing.gear))

    return change


# --- what the user writes --------------------------------------------------------------------------------


def turned_axes(degrees: float) -> OfCurves:
    """Bearing forces in axes that are turned by an angle from the line of action."""
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

    def change(curves: Curves, model: Model) -> Curves:
        result = dict(curves)
        for end in ("p", "g"):
            x, y = curves[f"bearing_force_x_{end}"], curves[f"bearing_force_y_{end}"]
            result[f"bearing_force_x_{end}"] = cosine * x - sine * y
            result[f"bearing_force_y_{end}"] = sine * x + cosine * y
        return result

    return change


def springs_alone(curves: Curves, model: Model) -> Curves:
    """Bearing forces without the dampers."""
    forces = {
        f"bearing_force_{along}_{end}": -model.bearing_stiffness[f"{along}{end}"] * curves[f"{along}_{end}"]
        for along in "xy"
        for end in "pg"
    }
    return curves | forces


def pitch_radii(curves: Curves, model: Model) -> Curves:
    """Transmission error with the radii of the reference circles in the place of the base circles."""
    moved = curves["x_p"] - curves["x_g"]
    turned = (curves["dte"] - moved) / math.cos(model.drawing.pressure_angle)
    return curves | {"dte": turned + moved}


def equal_shares(curves: Curves, model: Model) -> Curves:
    """The mesh force in equal parts on the pairs in contact."""
    loaded = curves["normal_load"] != 0.0
    shares = np.where(loaded, curves["mesh_force"] / np.maximum(loaded.sum(axis=0), 1), 0.0)
    return curves | {"normal_load": shares}


def delayed(share: float, *names: str) -> OfCurves:
    """Channels that come late by a share of the mesh cycle."""

    def change(curves: Curves, model: Model) -> Curves:
        times = curves["time"]
        earlier = times - share * model.period
        earlier = np.where(earlier < times[0], earlier + model.period, earlier)
        return curves | {name: np.interp(earlier, times, curves[name]) for name in names}

    return change


def each_channel(function: Callable[[np.ndarray, int], np.ndarray], *names: str) -> OfCurves:
    """A function of values and samples of a mesh cycle, on channels of one dimension; no names: on all."""

    def change(curves: Curves, model: Model) -> Curves:
        cycle = round(model.period / (curves["time"][1] - curves["time"][0]))
        chosen = names or tuple(name for name in curves if name != "time" and curves[name].ndim == 1)
        return curves | {name: function(curves[name], cycle) for name in chosen}

    return change


def hann_window(values: np.ndarray, cycle: int) -> np.ndarray:
    return values * np.hanning(values.size)


def moving_average(share: float) -> Callable[[np.ndarray, int], np.ndarray]:
    """Average over a share of the mesh cycle; the first and last value go on beyond the record."""

    def function(values: np.ndarray, cycle: int) -> np.ndarray:
        half = max(1, round(0.5 * share * cycle))
        longer = np.pad(values, half, mode="edge")
        return np.convolve(longer, np.full(2 * half + 1, 1.0 / (2 * half + 1)), mode="valid")

    return function


def clipped(share: float) -> Callable[[np.ndarray, int], np.ndarray]:
    """Cut off at a share of the largest distances from the mean."""

    def function(values: np.ndarray, cycle: int) -> np.ndarray:
        mean = values.mean()
        return mean + np.clip(values - mean, share * (values.min() - mean), share * (values.max() - mean))

    return function


def rounded(step: float) -> Callable[[np.ndarray, int], np.ndarray]:
    return lambda values, cycle: np.round(values / step) * step


def magnitude(values: np.ndarray, cycle: int) -> np.ndarray:
    return np.abs(values)
