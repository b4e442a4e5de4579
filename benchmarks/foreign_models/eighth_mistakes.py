"""The mistakes of the eighth set, each a change of drawing, line, model or exported curves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.foreign_models.drawing import RPM, Drawing, Line, Wheel, line_of_action
from benchmarks.foreign_models.eighth_runs import Relief, gap_of, reliefs
from benchmarks.foreign_models.laws import mean_roughness, unit_load, velocities
from benchmarks.foreign_models.model import Model, disc, ratio_damping
from benchmarks.foreign_models.recipe import Curves

FORCES = ("mesh_force", *(f"bearing_force_{axis}_{end}" for axis in "xy" for end in "pg"))
PLACES = ("dte", "x_p", "x_g", "y_p", "y_g")


# Inputs and geometry


def tip_radius(drawing: Drawing, wheel: Wheel, shift: float) -> float:
    """Tip radius with the tip alteration of the drawing's centre distance and these shifts."""
    return 0.5 * drawing.module * wheel.teeth + drawing.module * (1.0 + shift)


def without_shifts(drawing: Drawing) -> Drawing:
    pinion = replace(drawing.pinion, shift=0.0, tip_radius=tip_radius(drawing, drawing.pinion, 0.0))
    gear = replace(drawing.gear, shift=0.0, tip_radius=tip_radius(drawing, drawing.gear, 0.0))
    distance = 0.5 * drawing.module * (pinion.teeth + gear.teeth)
    return replace(drawing, pinion=pinion, gear=gear, centre_distance=distance)


def shifts_in_mm(drawing: Drawing) -> Drawing:
    """Shifts times the module are taken for coefficients; the centre distance is that of the drawing."""
    factor = drawing.module * 1e3
    shift_p, shift_g = factor * drawing.pinion.shift, factor * drawing.gear.shift
    reference = 0.5 * drawing.module * (drawing.pinion.teeth + drawing.gear.teeth)
    alteration = drawing.centre_distance - reference - drawing.module * (shift_p + shift_g)
    pinion = replace(
        drawing.pinion, shift=shift_p, tip_radius=tip_radius(drawing, drawing.pinion, shift_p) + alteration
    )
    gear = replace(
        drawing.gear, shift=shift_g, tip_radius=tip_radius(drawing, drawing.gear, shift_g) + alteration
    )
    return replace(drawing, pinion=pinion, gear=gear)


def line_at_rack_angle(drawing: Drawing) -> Callable[[Line], Line]:
    def change(line: Line) -> Line:
        tangent = math.tan(drawing.pressure_angle)
        length = (line.base_radius_p + line.base_radius_g) * tangent
        start = length - math.sqrt(drawing.gear.tip_radius**2 - line.base_radius_g**2)
        return replace(line, length=length, pitch_point=line.base_radius_p * tangent, start=start)

    return change


def half_speed(drawing: Drawing) -> Drawing:
    """The speed in rpm times pi/60."""
    return replace(drawing, speed=drawing.parameters["operating"]["pinion_speed"] * 0.5 * RPM)


def speed_of_gear(drawing: Drawing) -> Drawing:
    return replace(drawing, speed=drawing.speed * drawing.pinion.teeth / drawing.gear.teeth)


def torque_of_gear(drawing: Drawing) -> Drawing:
    return replace(drawing, torque=drawing.torque * drawing.gear.teeth / drawing.pinion.teeth)


def inertias_exchanged(model: Model) -> Model:
    return model.but(inertia_p=model.inertia_g, inertia_g=model.inertia_p)


def inertias_solid(model: Model) -> Model:
    """Moments of inertia without bores; the masses are those weighed."""
    drawing = model.drawing
    solid_p = disc(replace(drawing.pinion, bore=0.0), drawing.module)[1]
    solid_g = disc(replace(drawing.gear, bore=0.0), drawing.module)[1]
    return model.but(inertia_p=solid_p, inertia_g=solid_g)


def inertias_with_shafts(model: Model) -> Model:
    return model.but(inertia_p=2.5 * model.inertia_p, inertia_g=2.5 * model.inertia_g)


def bore_as_radius(model: Model) -> Model:
    """Moments of inertia with the diameter of the bore as its radius; the masses are those weighed."""
    drawing = model.drawing
    inertia_p = disc(replace(drawing.pinion, bore=2.0 * drawing.pinion.bore), drawing.module)[1]
    inertia_g = disc(replace(drawing.gear, bore=2.0 * drawing.gear.bore), drawing.module)[1]
    return model.but(inertia_p=inertia_p, inertia_g=inertia_g)


def without_relief(model: Model) -> Model:
    return model.but(error=gap_of(model.line, None, None))


def relief_from_single_contact(model: Model) -> Model:
    """Both reliefs start where single contact ends."""
    line = model.line
    pinion, gear = reliefs(model.drawing, line)
    assert pinion is not None
    assert gear is not None
    roll_p = (line.start + line.base_pitch) / line.base_radius_p
    roll_g = (line.length - line.end + line.base_pitch) / line.base_radius_g
    return model.but(error=gap_of(line, replace(pinion, start=roll_p), replace(gear, start=roll_g)))


def relief_twice(model: Model) -> Model:
    def twice(one: Relief | None) -> Relief | None:
        return None if one is None else replace(one, amount=2.0 * one.amount)

    pinion, gear = reliefs(model.drawing, model.line)
    return model.but(error=gap_of(model.line, twice(pinion), twice(gear)))


# Physics


def mean_stiffness(model: Model) -> Model:
    return model.but(total=lambda phase, total: total.mean() / total)


def first_harmonic(model: Model) -> Model:
    """The stiffness of the mesh is its mean and its first harmonic; shares of the pairs remain."""

    def factor(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
        wave = np.exp(2j * np.pi * phase)
        first = 2.0 * np.mean(total * wave.conj())
        ratio: np.ndarray = (total.mean() + (first * wave).real) / total
        return ratio

    return model.but(total=factor)


def in_contact(line: Line, xi: np.ndarray) -> np.ndarray:
    return (xi >= line.start) & (xi <= line.end)


def half_each(model: Model) -> Model:
    """Pairs in contact carry equal parts of the load of the mesh, which is as it should be."""
    line = model.line
    reach = math.floor(line.contact_ratio) + 1

    def equal(law: Callable[[np.ndarray], np.ndarray], xi: np.ndarray) -> np.ndarray:
        total, count = np.zeros_like(xi), np.zeros_like(xi)
        for step in range(-reach, reach + 1):
            other = xi + step * line.base_pitch
            on = in_contact(line, other)
            total += np.where(on, law(np.clip(other, line.start, line.end)), 0.0)
            count += on
        return total / np.maximum(count, 1.0)

    sound = model.stiffness
    return model.but(
        stiffness=lambda xi: equal(sound, xi),
        damping=lambda one, xi: equal(lambda place: ratio_damping(model, place), xi),
    )


def friction_from_pitch_point(model: Model) -> Model:
    """The youngest pair is in approach for the whole cycle, the others in recess."""
    line = model.line
    sound = model.friction
    shift = line.pitch_point - line.base_pitch - line.start
    return model.but(friction=lambda xi: sound(xi + shift))


def trapezoid(model: Model) -> Model:
    """A pair takes up and gives off its stiffness over a fifth of the path of contact each."""
    line = model.line
    sound = model.stiffness
    ramp = 0.2 * (line.end - line.start)

    def law(xi: np.ndarray) -> np.ndarray:
        nearest = np.minimum(xi - line.start, line.end - xi)
        return sound(xi) * np.clip(nearest / ramp, 1e-6, 1.0)

    return model.but(stiffness=law)


def contact_ratio_of_1_5(line: Line) -> Line:
    return replace(line, end=line.start + 1.5 * line.base_pitch)


def friction_one_way(model: Model) -> Model:
    sound = model.friction
    return model.but(friction=lambda xi: np.abs(sound(xi)))


def friction_reversed(model: Model) -> Model:
    sound = model.friction
    return model.but(friction=lambda xi: -sound(xi))


def arms_of_pitch_point(model: Model) -> Model:
    line = model.line
    return model.but(
        arm_p=lambda one, xi: np.full_like(xi, line.pitch_point),
        arm_g=lambda one, xi: np.full_like(xi, line.length - line.pitch_point),
    )


def friction_of_static_load(model: Model) -> Model:
    return model.but(others={"static_load": model.torque / model.line.base_radius_p})


def half_entrainment(model: Model) -> Model:
    """Law of Benedict and Kelley with the mean of the rolling velocities in place of their sum."""
    drawing, line = model.drawing, model.line
    factor = 0.0127 * 1.13 / (1.13 - mean_roughness(drawing))
    maximum = drawing.friction["maximum"]
    eta = drawing.viscosity * 1e3

    def law(xi: np.ndarray) -> np.ndarray:
        sliding, total = velocities(drawing, line, xi)
        rolling = 0.5 * total
        with np.errstate(divide="ignore"):
            mu = factor * np.log10(29700.0 * unit_load(drawing, line) / (eta * np.abs(sliding) * rolling**2))
        return np.sign(sliding) * np.clip(mu, 0.0, maximum)

    return model.but(friction=law)


def damping_of_translating_masses(model: Model) -> Model:
    mass = model.mass_p + model.mass_g

    def law(one: Model, xi: np.ndarray) -> np.ndarray:
        damping: np.ndarray = 2.0 * one.drawing.mesh_damping * np.sqrt(one.stiffness(xi) * mass)
        return damping

    return model.but(damping=law)


def coarse_table(model: Model) -> Model:
    return model.but(table=12)


def period_from_gear(model: Model) -> Model:
    """The mesh frequency is the speed of the pinion times the teeth of the gear."""
    return model.but(period_factor=model.drawing.pinion.teeth / model.drawing.gear.teeth)


# Export


def scaled(curves: Curves, names: tuple[str, ...], factor: float) -> Curves:
    return {name: values * factor if name in names else values for name, values in curves.items()}


def smoothed(curves: Curves, model: Model) -> Curves:
    """Moving average over an eighth of a mesh cycle, where the window is whole."""
    times = curves["time"]
    width = round(0.125 * model.period / (times[1] - times[0]))
    window = np.full(width, 1.0 / width)
    half = width // 2
    kept = slice(half, half + times.size - width + 1)
    result: Curves = {"time": times[kept]}
    for name, values in curves.items():
        if values.ndim == 1 and name != "time":
            result[name] = np.convolve(values, window, "valid")
    return result


def turned(curves: Curves, radius_p: float, radius_g: float) -> np.ndarray:
    difference: np.ndarray = radius_p * curves["theta_p"] - radius_g * curves["theta_g"]
    return difference


def dte_at_reference(curves: Curves, model: Model) -> Curves:
    drawing = model.drawing
    radius_p = 0.5 * drawing.module * drawing.pinion.teeth
    radius_g = 0.5 * drawing.module * drawing.gear.teeth
    return curves | {"dte": turned(curves, radius_p, radius_g) + curves["x_p"] - curves["x_g"]}


def dte_of_rotations(curves: Curves, model: Model) -> Curves:
    line = model.line
    return curves | {"dte": turned(curves, line.base_radius_p, line.base_radius_g)}


def dte_at_tip(curves: Curves, model: Model) -> Curves:
    return scaled(curves, ("dte",), model.drawing.pinion.tip_radius / model.line.base_radius_p)


def in_millimetres(curves: Curves, model: Model) -> Curves:
    return scaled(curves, PLACES, 1e3)


def forces_in_kilonewton(curves: Curves, model: Model) -> Curves:
    return scaled(curves, FORCES, 1e-3)


def in_degrees(curves: Curves, model: Model) -> Curves:
    return scaled(curves, ("theta_p", "theta_g"), 180.0 / math.pi)


def on_housing(curves: Curves, model: Model) -> Curves:
    return scaled(curves, FORCES[1:], -1.0)


def other_way_off_line(curves: Curves, model: Model) -> Curves:
    return scaled(curves, ("y_p", "y_g", "bearing_force_y_p", "bearing_force_y_g"), -1.0)


def without_means(curves: Curves, model: Model) -> Curves:
    cycle = round(model.period / (curves["time"][1] - curves["time"][0]))
    whole = curves["time"].size // cycle * cycle
    return {
        name: values if name == "time" else values - values[..., :whole].mean(axis=-1, keepdims=True)
        for name, values in curves.items()
    }


def of_machine(curves: Curves, model: Model) -> Curves:
    """Horizontal under the names x, vertical under y; the gear stands above the pinion."""
    line = line_of_action(model.drawing)
    angle = math.atan2(line.length, line.base_radius_p + line.base_radius_g)
    result = dict(curves)
    for kind in ("", "bearing_force_"):
        for end in ("p", "g"):
            along, across = curves[f"{kind}x_{end}"], curves[f"{kind}y_{end}"]
            result[f"{kind}x_{end}"] = along * math.cos(angle) - across * math.sin(angle)
            result[f"{kind}y_{end}"] = along * math.sin(angle) + across * math.cos(angle)
    return result
