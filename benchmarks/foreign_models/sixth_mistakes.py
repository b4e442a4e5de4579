"""What the users of the sixth set do wrong, as changes of drawing, model, motion or curves."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, drawing_of, line_of_action
from benchmarks.foreign_models.kernels import run_fixed
from benchmarks.foreign_models.model import STATES, Model, numbers_of, table_of
from benchmarks.foreign_models.recipe import Curves, Settings, labelled, started
from benchmarks.foreign_models.sixth_runs import Hook, modelled, recorded

#: Orders of the static transmission error that a user adds to his excitation.
ERROR_ORDERS = 5


def entered(**values: Any) -> Hook:
    """The user typed other numbers; a field is named by its path, with two underscores for a point."""

    def drawing(right: Drawing) -> Drawing:
        pair = copy.deepcopy(dict(right.parameters))
        for path, value in values.items():
            *sections, last = path.split("__")
            inside = pair
            for section in sections:
                inside = inside[section]
            inside[last] = value
        return drawing_of(pair)

    return drawing


def torque_of_gear_shaft(drawing: Drawing) -> Drawing:
    return replace(drawing, torque=drawing.torque * drawing.gear.teeth / drawing.pinion.teeth)


def speed_of_gear_shaft(drawing: Drawing) -> Drawing:
    return replace(drawing, speed=drawing.speed * drawing.pinion.teeth / drawing.gear.teeth)


def tips_without_shift(drawing: Drawing) -> Drawing:
    pinion, gear = (
        replace(wheel, tip_radius=drawing.module * (0.5 * wheel.teeth + 1.0))
        for wheel in (drawing.pinion, drawing.gear)
    )
    return replace(drawing, pinion=pinion, gear=gear)


def half_damping(drawing: Drawing) -> Drawing:
    return replace(drawing, mesh_damping=0.5 * drawing.mesh_damping)


def stiffer(factor: float) -> Hook:
    """Every tooth pair is stiffer by a factor; its damping follows the stiffness."""

    def model(right: Model) -> Model:
        law = right.stiffness
        return right.but(stiffness=lambda xi: factor * law(xi))

    return model


def wider_face(right: Model) -> Model:
    wide = max(right.drawing.pinion.width, right.drawing.gear.width)
    result: Model = stiffer(wide / right.drawing.width)(right)
    return result


def mesh_stiffness_as_single(right: Model) -> Model:
    result: Model = stiffer(0.75 * right.line.contact_ratio + 0.25)(right)
    return result


def double_inertia(right: Model) -> Model:
    return right.but(inertia_p=2.0 * right.inertia_p, inertia_g=2.0 * right.inertia_g)


def two_bearings(right: Model) -> Model:
    """Twice the stiffness; the damping ratio is kept."""
    return right.but(
        bearing_stiffness={where: 2.0 * value for where, value in right.bearing_stiffness.items()},
        bearing_damping={where: math.sqrt(2.0) * value for where, value in right.bearing_damping.items()},
    )


def pitch_radii(model: Model) -> tuple[float, float]:
    module = model.drawing.module
    return 0.5 * module * model.drawing.pinion.teeth, 0.5 * module * model.drawing.gear.teeth


def pitch_radii_in_equations(right: Model) -> Model:
    radius_p, radius_g = pitch_radii(right)
    mass = 1.0 / (radius_p**2 / right.inertia_p + radius_g**2 / right.inertia_g)

    def damping(model: Model, xi: np.ndarray) -> np.ndarray:
        return 2.0 * model.drawing.mesh_damping * np.sqrt(model.stiffness(xi) * mass)

    return right.but(others={"base_p": radius_p, "base_g": radius_g}, damping=damping)


def dte_by_pitch_radii(curves: Curves, model: Model) -> Curves:
    radius_p, radius_g = pitch_radii(model)
    return curves | {"dte": radius_p * curves["theta_p"] - radius_g * curves["theta_g"]}


def one_way_friction(right: Model) -> Model:
    law = right.friction
    return right.but(friction=lambda xi: np.abs(law(xi)))


def reversed_friction(right: Model) -> Model:
    law = right.friction
    return right.but(friction=lambda xi: -law(xi))


def no_friction_moments(right: Model) -> Model:
    return right.but(signs={"moment_sign_p": 0.0, "moment_sign_g": 0.0})


def bearings_apart(right: Model) -> Model:
    return right.but(others={"x_in_approach": 0.0})


def perfect_involutes(right: Model) -> Model:
    pair = dict(right.drawing.parameters)
    return modelled(pair | {"mesh": pair["mesh"] | {"relief": "ignored"}})


def static_error_added(right: Model) -> Model:
    """Add the static transmission error, a series of few orders, to the error of every tooth pair."""
    line = right.line
    phase = (np.arange(2048) + 0.5) / 2048
    places = line.start + (np.arange(-1, 4)[:, None] + phase) * line.base_pitch
    on = (places >= line.start) & (places <= line.end)
    total = np.where(on, right.stiffness(places), 0.0).sum(axis=0)
    curve = right.torque / line.base_radius_p / total
    series = [2.0 * np.mean(curve * np.exp(-2j * np.pi * n * phase)) for n in range(1, ERROR_ORDERS + 1)]

    def error(xi: np.ndarray) -> np.ndarray:
        turn = 2j * np.pi * (xi - line.start) / line.base_pitch
        return np.asarray(sum((c * np.exp(n * turn)).real for n, c in enumerate(series, 1)))

    return right.but(error=error)


def gear_teeth_in_frequency(right: Model) -> Model:
    return right.but(period_factor=right.drawing.pinion.teeth / right.drawing.gear.teeth)


def equal_static_shares(model: Model, settings: Settings) -> Curves:
    """Friction by the static load over the number of pairs in contact."""
    table = table_of(model)
    on = table["stiffness"] > 0.0
    table["share"] = on / on.sum(axis=0)
    static = model.but(others={"static_load": model.torque / model.line.base_radius_p})
    return recorded(static, settings, table)


def mean_stiffness(model: Model, settings: Settings) -> Curves:
    """Stiffness and damping of the mesh are their means; the pairs share the load as before."""
    table = table_of(model)
    for name in ("stiffness", "damping"):
        total = table[name].sum(axis=0)
        table[name] *= total.mean() / total
    return recorded(model, settings, table)


def first_harmonic(model: Model, settings: Settings) -> Curves:
    """The stiffness of the mesh is its mean and its first harmonic; damping follows its root."""
    table = table_of(model)
    total = table["stiffness"].sum(axis=0)
    orders = np.fft.rfft(total)
    orders[2:] = 0.0
    factor = np.fft.irfft(orders, total.size) / total
    table["stiffness"] *= factor
    table["damping"] *= np.sqrt(factor)
    return recorded(model, settings, table)


def coarse_stiffness(points: int) -> Any:
    """The stiffness has so many points in a base pitch, the first and last outside of contact are zero."""

    def runs(model: Model, settings: Settings) -> Curves:
        line, table = model.line, table_of(model)
        step = line.base_pitch / points
        nodes = line.start + np.arange(points * (table.shape[0] + 1)) * step
        on = (nodes > line.start) & (nodes <= line.end)
        values = np.where(on, model.stiffness(nodes), 0.0)
        last = table.shape[0] - 1
        phase = (np.arange(model.table) + 0.5) / model.table
        for index in range(last + 1):
            xi = line.start + (last - index + phase) * line.base_pitch
            row = table[index]
            row["stiffness"] = np.interp(xi, nodes, values)
            mass = model.effective_mass
            row["damping"] = 2.0 * model.drawing.mesh_damping * np.sqrt(row["stiffness"] * mass)
            row["mu"] = model.friction(xi)
        return recorded(model, settings, table)

    return runs


def from_rest(model: Model, settings: Settings) -> Curves:
    """The record starts with the teeth just touching and without load in springs."""
    table = table_of(model)
    ratio = model.line.base_radius_g / model.line.base_radius_p
    numbers = numbers_of(model, model.torque * ratio)
    started(model, numbers, table, int(settings.samples * settings.substeps))
    step = model.period / settings.samples
    times = np.arange(round(settings.cycles * settings.samples)) * step
    states = run_fixed(0, np.zeros(STATES), 0.0, step, settings.substeps, times.size, numbers, table)
    return labelled(times + settings.origin, states, times, numbers, table, model)


def dte_of_rotations(curves: Curves, model: Model) -> Curves:
    line = model.line
    turned = line.base_radius_p * curves["theta_p"] - line.base_radius_g * curves["theta_g"]
    return curves | {"dte": turned}


def along_line_of_centres(curves: Curves, model: Model) -> Curves:
    """x across and y along the line of centres, from pinion to gear."""
    line = line_of_action(model.drawing)
    angle = math.atan2(line.length, line.base_radius_p + line.base_radius_g)
    result = dict(curves)
    for end in ("p", "g"):
        for kind in ("", "bearing_force_"):
            x, y = curves[f"{kind}x_{end}"], curves[f"{kind}y_{end}"]
            result[f"{kind}x_{end}"] = math.cos(angle) * x - math.sin(angle) * y
            result[f"{kind}y_{end}"] = math.sin(angle) * x + math.cos(angle) * y
    return result


def on_the_housing(curves: Curves, model: Model) -> Curves:
    return curves | {name: -values for name, values in curves.items() if name.startswith("bearing_force")}


def in_micrometres(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": 1e6 * curves["dte"]}


def one_sense_of_rotation(curves: Curves, model: Model) -> Curves:
    return curves | {"theta_g": -curves["theta_g"]}


def one_pair(curves: Curves, model: Model) -> Curves:
    """The mesh force is that of the pair that came into contact last."""
    return curves | {"mesh_force": curves["normal_load"][-1]}


def smoothed(curves: Curves, model: Model) -> Curves:
    """Moving mean over a quarter of a mesh cycle, over the ends of a record of whole cycles."""
    times = curves["time"]
    width = round(0.25 * model.period / (times[1] - times[0]))
    window = np.zeros(times.size)
    window[:width] = 1.0 / width
    window = np.roll(window, -(width // 2))
    spectrum = np.fft.rfft(window)
    return {
        name: values
        if name == "time"
        else np.fft.irfft(np.fft.rfft(values, axis=-1) * spectrum, times.size, axis=-1)
        for name, values in curves.items()
    }


def whole_angles(curves: Curves, model: Model) -> Curves:
    turned = model.speed * curves["time"]
    ratio = model.drawing.pinion.teeth / model.drawing.gear.teeth
    return curves | {
        "theta_p": curves["theta_p"] + turned,
        "theta_g": curves["theta_g"] + ratio * turned,
    }
