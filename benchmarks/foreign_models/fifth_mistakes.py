"""What the users of the fifth set do wrong: changes of a drawing, line, model, table or of curves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.drawing import MM, Drawing, Line
from benchmarks.foreign_models.laws import (
    Law,
    iso_single_stiffness,
    unit_load,
    velocities,
)
from benchmarks.foreign_models.model import Model

Curves = dict[str, np.ndarray]


# Inputs and geometry ---------------------------------------------------------------------------------------


def width_of_the_pinion(model: Model) -> Model:
    wider = model.drawing.pinion.width / model.drawing.width
    law = model.stiffness
    return model.but(stiffness=lambda xi: wider * law(xi))


def _with_tips(drawing: Drawing, tip: Callable[[Any], float]) -> Drawing:
    pinion, gear = drawing.pinion, drawing.gear
    return replace(
        drawing,
        pinion=replace(pinion, tip_radius=tip(pinion)),
        gear=replace(gear, tip_radius=tip(gear)),
    )


def shifts_exchanged(drawing: Drawing) -> Drawing:
    pinion, gear = drawing.pinion, drawing.gear
    swapped = replace(
        drawing,
        pinion=replace(pinion, shift=gear.shift),
        gear=replace(gear, shift=pinion.shift),
    )
    reference = 0.5 * drawing.module * (pinion.teeth + gear.teeth)
    alteration = drawing.centre_distance - reference - drawing.module * (pinion.shift + gear.shift)
    return _with_tips(
        swapped,
        lambda wheel: drawing.module * (0.5 * wheel.teeth + 1.0 + wheel.shift) + alteration,
    )


def reference_centre_distance(drawing: Drawing) -> Drawing:
    teeth = drawing.pinion.teeth + drawing.gear.teeth
    return replace(drawing, centre_distance=0.5 * drawing.module * teeth)


def tips_without_shift(drawing: Drawing) -> Drawing:
    return _with_tips(drawing, lambda wheel: drawing.module * (0.5 * wheel.teeth + 1.0))


def tips_not_shortened(drawing: Drawing) -> Drawing:
    return _with_tips(drawing, lambda wheel: drawing.module * (0.5 * wheel.teeth + 1.0 + wheel.shift))


def twenty_degrees(drawing: Drawing) -> Drawing:
    return replace(drawing, pressure_angle=math.radians(20.0))


def inertia_as_gd2(model: Model) -> Model:
    return model.but(inertia_g=4.0 * model.inertia_g)


def torque_of_the_gear_shaft(drawing: Drawing) -> Drawing:
    return replace(drawing, torque=drawing.torque * drawing.pinion.teeth / drawing.gear.teeth)


def speed_of_the_gear_shaft(drawing: Drawing) -> Drawing:
    return replace(drawing, speed=drawing.speed * drawing.gear.teeth / drawing.pinion.teeth)


def bearings_doubled(drawing: Drawing) -> Drawing:
    def two(wheel: Any) -> Any:
        return replace(
            wheel, loa_stiffness=2.0 * wheel.loa_stiffness, oloa_stiffness=2.0 * wheel.oloa_stiffness
        )

    return replace(drawing, pinion=two(drawing.pinion), gear=two(drawing.gear))


def wheel_of_steel(drawing: Drawing) -> Drawing:
    return replace(drawing, gear=replace(drawing.gear, modulus=206e9))


def rz_for_ra(drawing: Drawing) -> Drawing:
    pinion, gear = drawing.pinion, drawing.gear
    return replace(
        drawing,
        pinion=replace(pinion, roughness=6.0 * pinion.roughness),
        gear=replace(gear, roughness=6.0 * gear.roughness),
    )


def kinematic_viscosity(drawing: Drawing) -> Drawing:
    return replace(drawing, viscosity=drawing.viscosity / 0.87)


def relief_error(drawing: Drawing, line: Line, gears: tuple[str, ...] = ("pinion", "gear")) -> Law:
    """Material that linear tip relief of these gears removes, over the distance from X [m]."""
    ramps = []
    for name in gears:
        relief = drawing.parameters[name]["tip_relief"]
        roll, amount = math.radians(relief["start_roll_angle"]), relief["amount"] * 1e-3 * MM
        if name == "pinion":
            ramps.append((roll * line.base_radius_p, line.end, amount))
        else:
            ramps.append((line.length - roll * line.base_radius_g, line.start, amount))

    def law(xi: np.ndarray) -> np.ndarray:
        return sum(
            (amount * np.clip((xi - start) / (tip - start), 0.0, None) for start, tip, amount in ramps),
            start=np.zeros_like(xi),
        )

    return law


def relief_of_the_pinion_alone(model: Model) -> Model:
    return model.but(error=relief_error(model.drawing, model.line, ("pinion",)))


# Physics ---------------------------------------------------------------------------------------------------


def mean_mesh_stiffness_for_a_pair(model: Model) -> Model:
    more = 0.75 * model.line.contact_ratio + 0.25
    size = more * iso_single_stiffness(model.drawing) * 1e9 * model.drawing.width
    return model.but(stiffness=lambda xi: np.full_like(xi, size))


def friction_of_half_the_force(table: np.ndarray) -> np.ndarray:
    """Coefficients with which pair loads make the friction of an even share of the mesh force."""
    stiffness = table["stiffness"]
    carrying = np.maximum((stiffness > 0.0).sum(axis=0), 1)
    even = stiffness.sum(axis=0) / carrying / np.where(stiffness > 0.0, stiffness, 1.0)
    table["mu"] *= even
    return table


def two_pairs_at_most(table: np.ndarray) -> np.ndarray:
    """The pair that has been in contact longest is dropped when a third one comes."""
    three = (table["stiffness"] > 0.0).all(axis=0)
    for field in ("stiffness", "damping", "mu", "error", "error_rate"):
        table[field][0, three] = 0.0
    return table


def reversal_in_the_middle(model: Model) -> Model:
    line, law = model.line, model.friction
    middle = 0.5 * (line.start + line.end)
    return model.but(friction=lambda xi: np.abs(law(xi)) * np.sign(xi - middle))


def mass_of_translation(model: Model) -> Model:
    mass = model.mass_p * model.mass_g / (model.mass_p + model.mass_g)

    def damping(one: Model, xi: np.ndarray) -> np.ndarray:
        values: np.ndarray = 2.0 * one.drawing.mesh_damping * np.sqrt(one.stiffness(xi) * mass)
        return values

    return model.but(damping=damping)


def structural_bearing_damping(model: Model) -> Model:
    omega = 2.0 * math.pi / model.period
    wheels = {"p": model.drawing.pinion, "g": model.drawing.gear}
    return model.but(
        bearing_damping={
            where: 2.0
            * (wheels[where[1]].loa_damping if where[0] == "x" else wheels[where[1]].oloa_damping)
            * stiffness
            / omega
            for where, stiffness in model.bearing_stiffness.items()
        }
    )


def no_bearing_deflection_in_the_mesh(model: Model) -> Model:
    return model.but(others={"x_in_approach": 0.0})


def without_bearing_deflection(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] - curves["x_p"] + curves["x_g"]}


def gear_at_constant_speed(model: Model) -> Model:
    return model.but(inertia_g=1e5 * model.inertia_g)


def impact_exponent(model: Model) -> Model:
    line = model.line
    places = np.linspace(line.start, line.end, 4001)
    mean = model.stiffness(places).mean() * line.contact_ratio
    deflection = model.torque / line.base_radius_p / mean
    return model.but(others={"hardening": 0.5, "reference_compression": deflection})


def tanh_of_sliding(model: Model) -> Model:
    drawing, line = model.drawing, model.line
    size = drawing.friction["coefficient"]
    return model.but(friction=lambda xi: size * np.tanh(velocities(drawing, line, xi)[0] / 1.0))


def mean_of_rolling_velocities(model: Model) -> Model:
    drawing, line = model.drawing, model.line
    maximum = drawing.friction["maximum"]
    roughness = 0.5e6 * (drawing.pinion.roughness + drawing.gear.roughness)
    factor = 0.0127 * 1.13 / (1.13 - roughness)

    def law(xi: np.ndarray) -> np.ndarray:
        sliding, rolling = velocities(drawing, line, xi)
        group = drawing.viscosity * 1e3 * np.abs(sliding) * (0.5 * rolling) ** 2
        with np.errstate(divide="ignore"):
            mu = factor * np.log10(29700.0 * unit_load(drawing, line) / group)
        return np.sign(sliding) * np.clip(mu, 0.0, maximum)

    return model.but(friction=law)


def peak_at_the_pitch_point(model: Model) -> Model:
    line = model.line
    moved = model.stiffness
    shift = line.pitch_point - 0.5 * (line.start + line.end)
    return model.but(stiffness=lambda xi: moved(xi - shift))


# Numerics, conventions, export -----------------------------------------------------------------------------


def three_harmonics(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
    """Factor on the stiffness of the pairs: its Fourier series up to the third order over itself."""
    series = np.fft.rfft(total)
    series[4:] = 0.0
    cut: np.ndarray = np.fft.irfft(series, total.size)
    return cut / total


def ten_points(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
    """Factor on the stiffness of the pairs: straight lines between ten points over itself."""
    points = np.arange(11) / 10.0
    values = total[(np.arange(11) * total.size // 10) % total.size]
    return np.interp(phase, points, values) / total


def stiffness_from_the_pitch_point(model: Model) -> Model:
    """The program reads the table that begins at the pitch point as if it began at A."""
    line = model.line
    ahead = ((line.pitch_point - line.start) / line.base_pitch) % 1.0

    def total(phase: np.ndarray, values: np.ndarray) -> np.ndarray:
        return np.roll(values, -round(ahead * values.size)) / values

    return model.but(total=total)


def at_the_pitch_radius(curves: Curves, model: Model) -> Curves:
    line = model.line
    pitch_over_base = model.drawing.centre_distance / (line.base_radius_p + line.base_radius_g)
    return curves | {"dte": pitch_over_base * curves["dte"]}


def on_the_housing(curves: Curves, model: Model) -> Curves:
    return curves | {name: -curves[name] for name in curves if name.startswith("bearing_force")}


def microseconds(curves: Curves, model: Model) -> Curves:
    time = curves["time"]
    step = round((time[1] - time[0]) * 1e6) * 1e-6
    return curves | {"time": step * np.arange(time.size)}


def low_pass(curves: Curves, model: Model) -> Curves:
    """First order with its corner at the mesh frequency; the record has whole cycles and is periodic."""
    time = curves["time"]
    frequency = np.fft.rfftfreq(time.size, time[1] - time[0])
    response = 1.0 / (1.0 + 1j * frequency * model.period)
    filtered = {
        name: np.fft.irfft(np.fft.rfft(values) * response, time.size, axis=-1)
        for name, values in curves.items()
        if name != "time"
    }
    return {"time": time, **filtered}


def frame_of_the_housing(curves: Curves, model: Model) -> Curves:
    """Across the line of centres under the name of x, along it under that of y."""
    angle = math.acos(
        model.line.base_radius_p / (model.line.pitch_point**2 + model.line.base_radius_p**2) ** 0.5
    )
    c, s = math.cos(angle), math.sin(angle)
    turned: Curves = {}
    for end in ("p", "g"):
        x, y = curves[f"x_{end}"], curves[f"y_{end}"]
        turned |= {f"x_{end}": c * x - s * y, f"y_{end}": s * x + c * y}
    return curves | turned


def gear_angle_in_the_sense_of_the_pinion(curves: Curves, model: Model) -> Curves:
    return curves | {"theta_g": -curves["theta_g"]}


def single_precision(curves: Curves, model: Model) -> Curves:
    line = model.line
    time = curves["time"] + 2.0
    ratio = line.base_radius_p / line.base_radius_g
    angle_p = (curves["theta_p"] + model.speed * time).astype(np.float32).astype(float)
    angle_g = (curves["theta_g"] + ratio * model.speed * time).astype(np.float32).astype(float)
    dte = line.base_radius_p * angle_p - line.base_radius_g * angle_g + curves["x_p"] - curves["x_g"]
    return curves | {"dte": dte}
