"""Changes of the user's drawing, model, settings or curves that make the mistakes of the third set."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.signal import butter, sosfilt, sosfilt_zi

from benchmarks.foreign_models import mistakes as m
from benchmarks.foreign_models.drawing import Drawing, Line, Wheel, drawing_of
from benchmarks.foreign_models.laws import Law
from benchmarks.foreign_models.model import Model, table_of
from benchmarks.foreign_models.recipe import Curves

FORCES = ("bearing_force_x_p", "bearing_force_y_p", "bearing_force_x_g", "bearing_force_y_g")
NEWTONS_PER_POUND = 4.4482216

# --- inputs ----------------------------------------------------------------------------------------------


def entered(**changes: Any) -> Callable[[Drawing], Drawing]:
    """Other values of the parameter file, from which the user's program computes the rest.

    A value is named by its path, with two underscores for a point. A function computes it from the old one.
    """

    def change(drawing: Drawing) -> Drawing:
        parameters = copy.deepcopy(dict(drawing.parameters))
        for path, value in changes.items():
            *sections, last = path.split("__")
            section = parameters
            for name in sections:
                section = section[name]
            section[last] = value(section[last]) if callable(value) else value
        return drawing_of(parameters)

    return change


def times(factor: float) -> Callable[[float], float]:
    return lambda value: factor * value


def without_centre_distance(drawing: Drawing) -> Drawing:
    """The user computes the centre distance without backlash; the drawing has a larger one."""
    return drawing_of({key: value for key, value in drawing.parameters.items() if key != "centre_distance"})


# --- geometry --------------------------------------------------------------------------------------------


def exchanged_tips(line: Line) -> Line:
    """The tip of the pinion bounds the approach, the tip of the gear the recess."""
    return replace(line, start=line.length - line.end, end=line.length - line.start)


def overlap_by_circular_pitch(degrees: float) -> Callable[[Line], Line]:
    """Contact ratio as path over circular pitch: each pair leaves too early."""
    share = math.cos(math.radians(degrees))
    return lambda line: replace(line, end=line.start + share * (line.end - line.start))


def line_at_rack_angle(degrees: float) -> Callable[[Line], Line]:
    """Line of action with the pressure angle of the rack; tips and base circles as drawn."""
    tangent = math.tan(math.radians(degrees))

    def change(line: Line) -> Line:
        length = (line.base_radius_p + line.base_radius_g) * tangent
        start = line.start + length - line.length
        return replace(line, length=length, start=start, pitch_point=line.base_radius_p * tangent)

    return change


def arms_from_start(model: Model) -> Model:
    """Moment arms of friction from A instead of the tangent point on the pinion."""
    return model.but(
        arm_p=lambda model, xi: xi - model.line.start,
        arm_g=lambda model, xi: model.line.length - (xi - model.line.start),
    )


# --- stiffness -------------------------------------------------------------------------------------------


def mean_mesh_stiffness_each(model: Model) -> Law:
    """c_gamma = c' (0.75 contact ratio + 0.25) for each pair."""
    law, factor = model.stiffness, 0.75 * model.line.contact_ratio + 0.25
    return lambda xi: factor * law(xi)


def peak_at_pitch_point(model: Model) -> Law:
    """Parabola with the right peak and the right fall over half a path, its peak at the pitch point."""
    line, law = model.line, model.stiffness
    middle, half = 0.5 * (line.start + line.end), 0.5 * (line.end - line.start)
    peak, end = (float(one) for one in law(np.array([middle, line.end])))
    return lambda xi: peak - (peak - end) * ((xi - line.pitch_point) / half) ** 2


def hertz_in_series(model: Model) -> Law:
    """Stiffness of Hertz, pi E b/(4 (1 - nu^2)), in series with a stiffness that contains it."""
    pinion, law = model.drawing.pinion, model.stiffness
    hertz = math.pi * pinion.modulus * model.drawing.width / (4.0 * (1.0 - pinion.poisson**2))
    return lambda xi: 1.0 / (1.0 / law(xi) + 1.0 / hertz)


def ramped(share: float) -> Callable[[Model], Law]:
    """Stiffness rises from a tenth to its value over a share of the path, and falls so at its end."""

    def law_of(model: Model) -> Law:
        line, law = model.line, model.stiffness
        length = share * (line.end - line.start)

        def ramp(xi: np.ndarray) -> np.ndarray:
            inside = np.minimum(xi - line.start, line.end - xi)
            return law(xi) * np.clip(inside / length, 0.1, 1.0)

        return ramp

    return law_of


def static_error_as_excitation(model: Model) -> Model:
    """Add three harmonics of the static transmission error as an error of the teeth."""
    total = table_of(model)["stiffness"].sum(axis=0)
    static = model.torque / model.line.base_radius_p / total
    wave = np.fft.rfft(static)
    wave[0], wave[4:] = 0.0, 0.0
    smooth = np.fft.irfft(wave, static.size)
    phase = (np.arange(static.size) + 0.5) / static.size

    def error(xi: np.ndarray) -> np.ndarray:
        return np.interp((xi - model.line.start) / model.line.base_pitch, phase, smooth, period=1.0)

    return model.but(error=error)


# --- damping ---------------------------------------------------------------------------------------------


def mean_stiffness(model: Model) -> float:
    """Mean stiffness of the mesh [N/m]."""
    return float(table_of(model.but(damping=no_damping))["stiffness"].sum(axis=0).mean())


def no_damping(model: Model, xi: np.ndarray) -> np.ndarray:
    return np.zeros_like(xi)


def damping_of_translating_masses(model: Model, xi: np.ndarray) -> np.ndarray:
    """Damping with m_p m_g/(m_p + m_g)."""
    mass = model.mass_p * model.mass_g / (model.mass_p + model.mass_g)
    return 2.0 * model.drawing.mesh_damping * np.sqrt(model.stiffness(xi) * mass)


def damping_by_hertz(model: Model, xi: np.ndarray) -> np.ndarray:
    """Damping (2 zeta/f) k with the natural frequency f in Hz, where rad/s belong."""
    frequency = math.sqrt(mean_stiffness(model) / model.effective_mass) / (2.0 * math.pi)
    return 2.0 * model.drawing.mesh_damping / frequency * model.stiffness(xi)


def damping_of_mesh_each(model: Model, xi: np.ndarray) -> np.ndarray:
    """Damping of the mean stiffness of the mesh, for each pair."""
    size = 2.0 * model.drawing.mesh_damping * math.sqrt(mean_stiffness(model) * model.effective_mass)
    return np.full_like(xi, size)


def damped_by(law: Callable[[Model, np.ndarray], np.ndarray]) -> Callable[[Model], Model]:
    return lambda model: model.but(damping=law)


# --- friction --------------------------------------------------------------------------------------------


def natural_logarithm(maximum: float) -> Callable[[Model], Model]:
    """The natural logarithm for the decimal one; the coefficient is bounded as before."""

    def law_of(model: Model, law: Law) -> Law:
        return lambda xi: np.clip(math.log(10.0) * law(xi), -maximum, maximum)

    return m.other_friction(law_of)


def reversed_in_middle(model: Model, law: Law) -> Law:
    """Friction reverses in the middle of the path."""
    middle = 0.5 * (model.line.start + model.line.end)
    return lambda xi: np.abs(law(xi)) * np.sign(xi - middle)


def never_reversed(model: Model, law: Law) -> Law:
    """Friction keeps the direction that it has in recess."""
    return lambda xi: np.abs(law(xi))


# --- bodies, supports ------------------------------------------------------------------------------------


def flywheel_effect(model: Model) -> Model:
    """GD2 = 4 J for J, on both gears."""
    return model.but(inertia_p=4.0 * model.inertia_p, inertia_g=4.0 * model.inertia_g)


def discs_to_tip(drawing: Drawing) -> Drawing:
    """Mass and inertia of discs that reach to the tip circle."""

    def body(wheel: Wheel) -> Wheel:
        outer, inner = wheel.tip_radius, 0.5 * wheel.bore
        mass = wheel.density * math.pi * (outer**2 - inner**2) * wheel.width
        return replace(wheel, mass=mass, inertia=0.5 * mass * (outer**2 + inner**2))

    return replace(drawing, pinion=body(drawing.pinion), gear=body(drawing.gear))


def motor_on_pinion(inertia: float) -> Callable[[Model], Model]:
    """Inertia of a motor [kg m^2] added to the pinion; dampers as without it."""
    return lambda model: model.but(inertia_p=model.inertia_p + inertia, damping=m.damping_of(model))


def stiffness_of_all_bearings(factor: float) -> Callable[[Drawing], Drawing]:
    return entered(
        bearings__pinion__loa_stiffness=times(factor),
        bearings__pinion__oloa_stiffness=times(factor),
        bearings__gear__loa_stiffness=times(factor),
        bearings__gear__oloa_stiffness=times(factor),
    )


# --- export ----------------------------------------------------------------------------------------------


def recorder_filter(share: float) -> Callable[[Curves, Model], Curves]:
    """Butterworth filter of order 2 on the bearing forces, its corner a multiple of the mesh frequency."""

    def change(curves: Curves, model: Model) -> Curves:
        step = curves["time"][1] - curves["time"][0]
        sections = butter(2, 2.0 * share * step / model.period, output="sos")
        start = sosfilt_zi(sections)
        smooth = {name: sosfilt(sections, curves[name], zi=start * curves[name].mean())[0] for name in FORCES}
        return curves | smooth

    return change


def springs_alone(curves: Curves, model: Model) -> Curves:
    """Bearing forces without the force of the dampers."""
    return curves | {
        f"bearing_force_{axis}": -model.bearing_stiffness[axis.replace("_", "")] * curves[axis]
        for axis in ("x_p", "y_p", "x_g", "y_g")
    }


def rotations_alone(curves: Curves, model: Model) -> Curves:
    """Transmission error of the rotations, without the displacements of the gears."""
    line = model.line
    turned = line.base_radius_p * curves["theta_p"] - line.base_radius_g * curves["theta_g"]
    return curves | {"dte": turned}


def window_left_on(curves: Curves, model: Model) -> Curves:
    """Every channel times a Hann window over the record, after its mean was taken out."""
    window = np.hanning(curves["time"].size)
    return {
        name: values if name == "time" else (values - values.mean(axis=-1, keepdims=True)) * window
        for name, values in curves.items()
    }
