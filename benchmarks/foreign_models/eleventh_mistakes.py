"""Mistakes of the eleventh set: changes of the drawing, line, model, table or curves.

Signs, units and sources as in model.py; the truths are in eleventh.py.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.signal import butter, sosfiltfilt

from benchmarks.foreign_models.drawing import Drawing, Line, line_of_action
from benchmarks.foreign_models.eighth_runs import gap_of, reliefs
from benchmarks.foreign_models.model import Model, no_error, table_of
from benchmarks.foreign_models.recipe import Curves

#: Sliding velocity from which a multibody program counts friction as full [m/s].
TRANSITION = 1.0
#: Corner of the low-pass filter over the mesh frequency.
CORNER = 3.0
#: Cycles that a filter spoils at either end of a record.
SPOILT = 3.0
FORCES = ("mesh_force", *(f"bearing_force_{along}_{end}" for along in "xy" for end in "pg"))


# Inputs and geometry.


def pitch_radii(line: Line) -> Line:
    """Pitch radii r = z m/2 of gears on the reference centre distance, as arms of the normal load."""
    cosine = 1.0 / math.hypot(1.0, line.length / (line.base_radius_p + line.base_radius_g))
    return replace(line, base_radius_p=line.base_radius_p / cosine, base_radius_g=line.base_radius_g / cosine)


def period_of_drawing(model: Model) -> Model:
    """The model with the right period of the mesh, whatever its arms are."""
    return model.but(period_factor=model.line.base_radius_p / line_of_action(model.drawing).base_radius_p)


def torque_of_gear(drawing: Drawing) -> Drawing:
    return replace(drawing, torque=drawing.torque * drawing.gear.teeth / drawing.pinion.teeth)


def inertia_about_diameter(model: Model) -> Model:
    return model.but(inertia_p=0.5 * model.inertia_p, inertia_g=0.5 * model.inertia_g)


def inertias_exchanged(model: Model) -> Model:
    return model.but(inertia_p=model.inertia_g, inertia_g=model.inertia_p)


def without_shifts(drawing: Drawing) -> Drawing:
    """Gears with x = 0 on the reference centre distance."""
    addendum = drawing.parameters["basic_rack"]["addendum_coefficient"]
    pinion, gear = (
        replace(wheel, shift=0.0, tip_radius=drawing.module * (0.5 * wheel.teeth + addendum))
        for wheel in (drawing.pinion, drawing.gear)
    )
    distance = 0.5 * drawing.module * (pinion.teeth + gear.teeth)
    return replace(drawing, pinion=pinion, gear=gear, centre_distance=distance)


def shifts_exchanged(drawing: Drawing) -> Drawing:
    """Each gear with the shift of the other one; the tips follow, the centre distance is the same."""
    moved = drawing.module * (drawing.gear.shift - drawing.pinion.shift)
    pinion, gear = drawing.pinion, drawing.gear
    return replace(
        drawing,
        pinion=replace(pinion, shift=gear.shift, tip_radius=pinion.tip_radius + moved),
        gear=replace(gear, shift=pinion.shift, tip_radius=gear.tip_radius - moved),
    )


def plane_strain_twice(drawing: Drawing) -> Drawing:
    return replace(drawing, stiffness_factor=1.0 / (1.0 - drawing.pinion.poisson**2))


def mesh_as_pair(drawing: Drawing) -> Drawing:
    """c_gamma = c' (0.75 eps + 0.25) of ISO 6336-1 as the stiffness of one pair."""
    return replace(drawing, stiffness_factor=0.75 * line_of_action(drawing).contact_ratio + 0.25)


def stiffness_of_one_tooth(drawing: Drawing) -> Drawing:
    return replace(drawing, stiffness_factor=2.0)


def contact_ratio_by_rule(drawing: Drawing, line: Line) -> Line:
    """Contact ratio 1.88 - 3.2 (1/z1 + 1/z2), which holds for 20 degrees; the path ends later."""
    ratio = 1.88 - 3.2 * (1.0 / drawing.pinion.teeth + 1.0 / drawing.gear.teeth)
    return replace(line, end=line.start + ratio * line.base_pitch)


def bearings_in_other_unit(model: Model) -> Model:
    """A thousand times the stiffness; the damping follows with the same ratio."""
    stiffness = {where: 1e3 * value for where, value in model.bearing_stiffness.items()}
    damping = {where: math.sqrt(1e3) * value for where, value in model.bearing_damping.items()}
    return model.but(bearing_stiffness=stiffness, bearing_damping=damping)


def without_relief(model: Model) -> Model:
    return model.but(error=no_error)


def relief_by_height(model: Model) -> Model:
    """The height of the relieved part, r_tip - r_start, is taken as its length on the path of contact."""
    line, changed = model.line, []
    for relief, radius in zip(
        reliefs(model.drawing, line), (line.base_radius_p, line.base_radius_g), strict=True
    ):
        assert relief is not None
        height = radius * (math.hypot(1.0, relief.end) - math.hypot(1.0, relief.start))
        changed.append(replace(relief, start=relief.end - height / radius))
    return model.but(error=gap_of(line, *changed))


def with_motor(model: Model) -> Model:
    """The motor has nine times the inertia of the pinion."""
    return model.but(inertia_p=10.0 * model.inertia_p)


# Physics.


def mean_stiffness(table: np.ndarray) -> np.ndarray:
    """Stiffness and damping of the whole mesh are constant, their means."""
    new = table.copy()
    for name in ("stiffness", "damping"):
        total = table[name].sum(axis=0)
        new[name] = table[name] / total * total.mean()
    return new


def equal_shares(table: np.ndarray) -> np.ndarray:
    """The pairs in contact have equal parts of stiffness and damping of the mesh."""
    new = table.copy()
    on = table["stiffness"] > 0.0
    for name in ("stiffness", "damping", "share"):
        new[name] = np.where(on, table[name].sum(axis=0) / on.sum(axis=0), 0.0)
    return new


def one_pair(table: np.ndarray) -> np.ndarray:
    """A pair leaves contact when the next one enters."""
    new = table.copy()
    for name in ("stiffness", "damping", "mu", "share"):
        new[name][:-1] = 0.0
    new["share"][-1] = 1.0
    return new


def friction_one_way(model: Model) -> Model:
    law = model.friction
    return model.but(friction=lambda xi: np.abs(law(xi)))


def without_friction(model: Model) -> Model:
    return model.but(friction=np.zeros_like)


def without_friction_moments(model: Model) -> Model:
    return model.but(arm_p=lambda model, xi: np.zeros_like(xi), arm_g=lambda model, xi: np.zeros_like(xi))


def damping_by_sum_of_masses(model: Model) -> Model:
    factor = math.sqrt((model.mass_p + model.mass_g) / model.effective_mass)
    law = model.damping
    return model.but(damping=lambda model, xi: factor * law(model, xi))


def damping_without_two(model: Model) -> Model:
    law = model.damping
    return model.but(damping=lambda model, xi: 0.5 * law(model, xi))


def without_mesh_damping(model: Model) -> Model:
    return model.but(damping=lambda model, xi: np.zeros_like(xi))


def exponent(model: Model) -> Model:
    """Load by the exponent 1.5 of the approach, with the right load at the mean deflection."""
    mean = float(table_of(model)["stiffness"].sum(axis=0).mean())
    deflection = model.torque / model.line.base_radius_p / mean
    return model.but(others={"hardening": 0.5, "reference_compression": deflection})


def directions_exchanged(model: Model) -> Model:
    def other(values: dict[str, float]) -> dict[str, float]:
        return {f"{'y' if where[0] == 'x' else 'x'}{where[1]}": value for where, value in values.items()}

    return model.but(
        bearing_stiffness=other(model.bearing_stiffness), bearing_damping=other(model.bearing_damping)
    )


def wide_reversal(model: Model) -> Model:
    """Friction grows by the cubic step of a multibody program up to its transition velocity."""
    law, line, drawing = model.friction, model.line, model.drawing
    turning = drawing.speed * (1.0 + drawing.pinion.teeth / drawing.gear.teeth)

    def smooth(xi: np.ndarray) -> np.ndarray:
        share = np.clip(turning * (xi - line.pitch_point) / TRANSITION, -1.0, 1.0)
        values: np.ndarray = np.abs(law(xi)) * 0.5 * share * (3.0 - share**2)
        return values

    return model.but(friction=smooth)


# Numerics, conventions, export.


def frequency_of_gear_teeth(model: Model) -> Model:
    """Mesh frequency from the teeth of the gear and the speed of the pinion."""
    return model.but(period_factor=model.drawing.pinion.teeth / model.drawing.gear.teeth)


def offset_by_backlash(curves: Curves, model: Model) -> Curves:
    """The approach is zero in the middle of the backlash."""
    half = 0.5e-3 * float(model.drawing.parameters["mesh"]["backlash"])
    return curves | {"dte": curves["dte"] + half}


def dte_with_pitch_radii(curves: Curves, model: Model) -> Curves:
    module, drawing = model.drawing.module, model.drawing
    turned = (
        0.5 * module * (drawing.pinion.teeth * curves["theta_p"] - drawing.gear.teeth * curves["theta_g"])
    )
    return curves | {"dte": turned + curves["x_p"] - curves["x_g"]}


def dte_of_rotations(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": curves["dte"] - curves["x_p"] + curves["x_g"]}


def dte_in_micrometres(curves: Curves, model: Model) -> Curves:
    return curves | {"dte": 1e6 * curves["dte"]}


def on_housing(curves: Curves, model: Model) -> Curves:
    return curves | {name: -curves[name] for name in FORCES if name != "mesh_force"}


def axes_of_drawing(curves: Curves, model: Model) -> Curves:
    """x along the centre line, y across it: both turned by the operating pressure angle."""
    line = model.line
    angle = math.atan(line.length / (line.base_radius_p + line.base_radius_g))
    new = dict(curves)
    for name in ("{}_p", "{}_g", "bearing_force_{}_p", "bearing_force_{}_g"):
        loa, oloa = curves[name.format("x")], curves[name.format("y")]
        new[name.format("x")] = loa * math.sin(angle) - oloa * math.cos(angle)
        new[name.format("y")] = loa * math.cos(angle) + oloa * math.sin(angle)
    return new


def low_pass(curves: Curves, model: Model) -> Curves:
    """Butterworth filter of fourth order, forward and backward; its ends are cut off."""
    time = curves["time"]
    rate = 1.0 / (time[1] - time[0])
    filtered = butter(4, CORNER / model.period, fs=rate, output="sos")
    cut = round(SPOILT * model.period * rate)
    new = {name: sosfiltfilt(filtered, values, axis=-1) for name, values in curves.items() if name != "time"}
    return {name: values[..., cut:-cut] for name, values in ({"time": time} | new).items()}


def without_means(curves: Curves, model: Model) -> Curves:
    return {
        name: values if name == "time" else values - values.mean(axis=-1, keepdims=True)
        for name, values in curves.items()
    }


def most_loaded_pair(curves: Curves, model: Model) -> Curves:
    return curves | {"mesh_force": curves["normal_load"].max(axis=0)}


def elastic_mesh_force(curves: Curves, model: Model) -> Curves:
    """Stiffness times approach of the pairs that carry load; the stiffness of a pair is constant."""
    stiffness = float(model.stiffness(np.array([model.line.pitch_point]))[0])
    pairs = (curves["normal_load"] > 0.0).sum(axis=0)
    return curves | {"mesh_force": np.maximum(stiffness * pairs * curves["dte"], 0.0)}


def forces_in_kilonewtons(curves: Curves, model: Model) -> Curves:
    return curves | {name: 1e-3 * curves[name] for name in FORCES}
