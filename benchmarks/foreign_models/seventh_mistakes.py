"""Mistakes of the users of the seventh set: changes of a part of a run."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line, Wheel
from benchmarks.foreign_models.model import Model
from benchmarks.foreign_models.recipe import Curves

DISPLACEMENTS = ("x_p", "x_g", "y_p", "y_g")


def both(change: Callable[[Drawing, Wheel], Wheel]) -> Callable[[Drawing], Drawing]:
    """Change both wheels of a drawing."""

    def changed(drawing: Drawing) -> Drawing:
        pinion, gear = change(drawing, drawing.pinion), change(drawing, drawing.gear)
        return replace(drawing, pinion=pinion, gear=gear)

    return changed


# Inputs and geometry


def torque_on_the_output(drawing: Drawing) -> Drawing:
    return replace(drawing, torque=drawing.torque * drawing.pinion.teeth / drawing.gear.teeth)


def speed_of_the_small_wheel(drawing: Drawing) -> Drawing:
    return replace(drawing, speed=drawing.speed * drawing.gear.teeth / drawing.pinion.teeth)


def default_angle(drawing: Drawing) -> Drawing:
    return replace(drawing, pressure_angle=math.radians(20.0))


def standard_gears(drawing: Drawing) -> Drawing:
    """Return gears without shifts at the standard centre distance, with standard tips."""

    def standard(of: Drawing, wheel: Wheel) -> Wheel:
        return replace(wheel, shift=0.0, tip_radius=of.module * (0.5 * wheel.teeth + 1.0))

    teeth = drawing.pinion.teeth + drawing.gear.teeth
    return replace(both(standard)(drawing), centre_distance=0.5 * drawing.module * teeth)


@both
def full_tips(drawing: Drawing, wheel: Wheel) -> Wheel:
    return replace(wheel, tip_radius=drawing.module * (0.5 * wheel.teeth + 1.0 + wheel.shift))


def width_of_the_pinion(drawing: Drawing) -> Drawing:
    return replace(drawing, gear=replace(drawing.gear, width=drawing.pinion.width))


def rings(model: Model) -> Model:
    drawing = model.drawing
    radius_p, radius_g = (0.5 * drawing.module * one.teeth for one in (drawing.pinion, drawing.gear))
    return model.but(inertia_p=model.mass_p * radius_p**2, inertia_g=model.mass_g * radius_g**2)


def with_rotor(inertia: float) -> Callable[[Model], Model]:
    return lambda model: model.but(inertia_p=model.inertia_p + inertia)


def bearings_times(factor: float) -> Callable[[Drawing], Drawing]:
    def times(_: Drawing, wheel: Wheel) -> Wheel:
        stiffness = factor * wheel.loa_stiffness, factor * wheel.oloa_stiffness
        return replace(wheel, loa_stiffness=stiffness[0], oloa_stiffness=stiffness[1])

    return both(times)


@both
def axes_mixed_up(_: Drawing, wheel: Wheel) -> Wheel:
    return replace(
        wheel,
        loa_stiffness=wheel.oloa_stiffness,
        oloa_stiffness=wheel.loa_stiffness,
        loa_damping=wheel.oloa_damping,
        oloa_damping=wheel.loa_damping,
    )


def viscosity(value: float) -> Callable[[Drawing], Drawing]:
    """Viscosity in mPa s."""
    return lambda drawing: replace(drawing, viscosity=1e-3 * value)


@both
def sum_of_roughnesses(drawing: Drawing, wheel: Wheel) -> Wheel:
    return replace(wheel, roughness=drawing.pinion.roughness + drawing.gear.roughness)


def both_of_steel(drawing: Drawing) -> Drawing:
    steel = drawing.pinion
    return replace(drawing, gear=replace(drawing.gear, modulus=steel.modulus, poisson=steel.poisson))


# Physics


def mean_stiffness(model: Model, table: np.ndarray) -> np.ndarray:
    """Mean over the cycle of the whole mesh, stiffness and its damping, shared by the pairs in contact."""
    table = table.copy()
    mean = table["stiffness"].sum(axis=0).mean()
    damping = 2.0 * model.drawing.mesh_damping * math.sqrt(mean * model.effective_mass)
    table["stiffness"], table["damping"] = mean * table["share"], damping * table["share"]
    return table


def whole_mesh_on_each_pair(model: Model) -> Model:
    law, factor = model.stiffness, 0.75 * model.line.contact_ratio + 0.25
    return model.but(stiffness=lambda xi: factor * law(xi))


def recess_all_the_time(model: Model) -> Model:
    law = model.friction
    return model.but(friction=lambda xi: np.abs(law(xi)))


def driving_friction(model: Model) -> Model:
    law = model.friction
    return model.but(friction=lambda xi: -law(xi))


def without_moments(model: Model) -> Model:
    return model.but(signs={"moment_sign_p": 0.0, "moment_sign_g": 0.0})


def with_mass_in_damping(mass: Callable[[Model], float], factor: float = 1.0) -> Callable[[Model], Model]:
    """Damping of a tooth pair with another mass and factor."""

    def changed(model: Model) -> Model:
        size = 2.0 * factor * model.drawing.mesh_damping * math.sqrt(mass(model))
        return model.but(damping=lambda one, xi: size * np.sqrt(one.stiffness(xi)))

    return changed


def masses_in_series(model: Model) -> float:
    return model.mass_p * model.mass_g / (model.mass_p + model.mass_g)


def mass_on_the_line(model: Model) -> float:
    return model.effective_mass


def pulling(model: Model) -> Model:
    return model.but(unilateral=False)


def without_bearing_motion(model: Model) -> Model:
    return model.but(others={"x_in_approach": 0.0})


def rotations_alone(curves: Curves, model: Model) -> Curves:
    """Transmission error of the rotations alone."""
    line = model.line
    turned = line.base_radius_p * curves["theta_p"] - line.base_radius_g * curves["theta_g"]
    return curves | {"dte": turned}


def impact(exponent: float) -> Callable[[Model], Model]:
    """Force K delta^n; K has the linear force at the mean load and the mean stiffness of the mesh."""

    def changed(model: Model) -> Model:
        places = model.line.start + np.linspace(0.0, 1.0, 400) * (model.line.end - model.line.start)
        mean = float(model.stiffness(places).mean()) * model.line.contact_ratio
        deflection = model.torque / model.line.base_radius_p / mean
        return model.but(others={"hardening": exponent - 1.0, "reference_compression": deflection})

    return changed


def imposed_speed(model: Model) -> Model:
    """The driving wheel has so much inertia that its speed is constant; the damping stays."""
    return with_mass_in_damping(lambda _: model.effective_mass)(model).but(inertia_p=1e4 * model.inertia_p)


def half_and_half(line: Line) -> Line:
    return replace(line, end=line.start + 1.5 * line.base_pitch)


# Numerics, conventions and export


def three_harmonics(_: Model, table: np.ndarray) -> np.ndarray:
    """Stiffness of the mesh from its mean and three harmonics, damping in proportion."""
    table = table.copy()
    whole = table["stiffness"].sum(axis=0)
    series = np.fft.rfft(whole)
    series[4:] = 0.0
    ratio = np.fft.irfft(series, whole.size) / whole
    table["stiffness"] *= ratio
    table["damping"] *= np.sqrt(ratio)
    return table


def times(name: str, factor: float) -> Callable[[Curves, Model], Curves]:
    return lambda curves, model: curves | {name: factor * curves[name]}


def with_reference_radii(curves: Curves, model: Model) -> Curves:
    radius_p, radius_g = (
        0.5 * model.drawing.module * one.teeth for one in (model.drawing.pinion, model.drawing.gear)
    )
    turned = radius_p * curves["theta_p"] - radius_g * curves["theta_g"]
    return curves | {"dte": turned + curves["x_p"] - curves["x_g"]}


def tangential_and_radial(curves: Curves, model: Model) -> Curves:
    """Bearing forces across and along the line of centres."""
    angle = math.asin(model.line.length / model.drawing.centre_distance)
    turned = dict(curves)
    for end in ("p", "g"):
        x, y = curves[f"bearing_force_x_{end}"], curves[f"bearing_force_y_{end}"]
        turned[f"bearing_force_x_{end}"] = math.cos(angle) * x - math.sin(angle) * y
        turned[f"bearing_force_y_{end}"] = math.sin(angle) * x + math.cos(angle) * y
    return turned


def of_one_pair(curves: Curves, _: Model) -> Curves:
    return curves | {"mesh_force": curves["normal_load"][0]}


def six_decimals(curves: Curves, _: Model) -> Curves:
    return {name: np.round(values, 6) for name, values in curves.items()}


def on_the_bearing(curves: Curves, _: Model) -> Curves:
    turned = {name: -values for name, values in curves.items() if name.startswith("bearing_force")}
    return curves | turned
