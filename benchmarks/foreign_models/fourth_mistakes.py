"""Changes of the fourth set that make mistakes of the owner: his file, path of contact, laws, curves.

A number that the owner types wrong goes through all that he computes from it, as in `retyped`.
"""

from __future__ import annotations

import copy
import math
import tomllib
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from benchmarks.foreign_models.drawing import Drawing, Line, drawing_of
from benchmarks.foreign_models.laws import Law, sampled
from benchmarks.foreign_models.model import Model, disc
from benchmarks.foreign_models.pairs import as_toml
from benchmarks.foreign_models.recipe import Curves

# --- numbers of the file ---------------------------------------------------------------------------------


def retyped(**changes: Any) -> Callable[[Drawing], Drawing]:
    """The owner types other numbers into his file; two underscores part section and field."""

    def change(drawing: Drawing) -> Drawing:
        parameters: dict[str, Any] = copy.deepcopy(dict(drawing.parameters))
        for path, value in changes.items():
            section, name = path.split("__")
            parameters[section][name] = value
        return drawing_of(parameters)

    return change


def exchanged_shifts(drawing: Drawing) -> Drawing:
    """The pinion has the shift of the gear and the gear that of the pinion."""
    pinion, gear = drawing.pinion.shift, drawing.gear.shift
    return retyped(pinion__profile_shift=gear, gear__profile_shift=pinion)(drawing)


def torque_of_other_wheel(drawing: Drawing) -> Drawing:
    """The pinion has the torque of the gear."""
    return replace(drawing, torque=drawing.torque * drawing.gear.teeth / drawing.pinion.teeth)


def speed_of_other_wheel(drawing: Drawing) -> Drawing:
    """The speed of the file is taken for that of the gear."""
    return replace(drawing, speed=drawing.speed * drawing.gear.teeth / drawing.pinion.teeth)


def wider_contact(drawing: Drawing) -> Drawing:
    """The teeth touch over the width of the wider wheel; the narrower wheel keeps its mass and inertia."""
    width = max(drawing.pinion.width, drawing.gear.width)
    weights = {"pinion": disc(drawing.pinion, drawing.module), "gear": disc(drawing.gear, drawing.module)}
    wide = retyped(pinion__face_width=1e3 * width, gear__face_width=1e3 * width)(drawing)
    return replace(
        wide,
        pinion=replace(wide.pinion, mass=weights["pinion"][0], inertia=weights["pinion"][1]),
        gear=replace(wide.gear, mass=weights["gear"][0], inertia=weights["gear"][1]),
    )


def exchanged_weights(drawing: Drawing) -> Drawing:
    """Each wheel has the mass and inertia of the other wheel."""
    mass_p, inertia_p = disc(drawing.pinion, drawing.module)
    mass_g, inertia_g = disc(drawing.gear, drawing.module)
    return replace(
        drawing,
        pinion=replace(drawing.pinion, mass=mass_g, inertia=inertia_g),
        gear=replace(drawing.gear, mass=mass_p, inertia=inertia_p),
    )


def ring_inertia(drawing: Drawing) -> Drawing:
    """Inertias are m r^2 with the reference radius r."""

    def ring(wheel: Any) -> Any:
        mass, _ = disc(wheel, drawing.module)
        return replace(wheel, mass=mass, inertia=mass * (0.5 * drawing.module * wheel.teeth) ** 2)

    return replace(drawing, pinion=ring(drawing.pinion), gear=ring(drawing.gear))


def weights(mass: float, inertia_p: float, inertia_g: float) -> Callable[[Drawing], Drawing]:
    """Masses times a factor and inertias times factors of pinion and gear; dampers by ratios follow."""

    def change(drawing: Drawing) -> Drawing:
        mass_p, polar_p = disc(drawing.pinion, drawing.module)
        mass_g, polar_g = disc(drawing.gear, drawing.module)
        return replace(
            drawing,
            pinion=replace(drawing.pinion, mass=mass * mass_p, inertia=inertia_p * polar_p),
            gear=replace(drawing.gear, mass=mass * mass_g, inertia=inertia_g * polar_g),
        )

    return change


def bearing_springs(factor: float) -> Callable[[Drawing], Drawing]:
    """All bearing stiffnesses times a factor; the damping ratios of the file remain."""

    def softer(wheel: Any) -> Any:
        along, across = factor * wheel.loa_stiffness, factor * wheel.oloa_stiffness
        return replace(wheel, loa_stiffness=along, oloa_stiffness=across)

    return lambda drawing: replace(drawing, pinion=softer(drawing.pinion), gear=softer(drawing.gear))


def exchanged_springs(drawing: Drawing) -> Drawing:
    """The stiffness along the line of action stands across it, and the reverse."""

    def turned(wheel: Any) -> Any:
        return replace(wheel, loa_stiffness=wheel.oloa_stiffness, oloa_stiffness=wheel.loa_stiffness)

    return replace(drawing, pinion=turned(drawing.pinion), gear=turned(drawing.gear))


# --- path of contact -------------------------------------------------------------------------------------


def at_reference_centre_distance(drawing: Drawing) -> Drawing:
    """Shifted gears stand at the reference centre distance; tips have the shift and no alteration."""
    addendum = drawing.parameters["basic_rack"].get("addendum_coefficient", 1.0)

    def tip(wheel: Any) -> Any:
        radius = drawing.module * (0.5 * wheel.teeth + addendum + wheel.shift)
        return replace(wheel, tip_radius=radius)

    teeth = drawing.pinion.teeth + drawing.gear.teeth
    distance = 0.5 * drawing.module * teeth
    return replace(drawing, centre_distance=distance, pinion=tip(drawing.pinion), gear=tip(drawing.gear))


def tips_without_shift(drawing: Drawing) -> Drawing:
    """Tip radii are those of gears without profile shift; the centre distance is right."""

    def tip(wheel: Any) -> Any:
        return replace(wheel, tip_radius=wheel.tip_radius - drawing.module * wheel.shift)

    return replace(drawing, pinion=tip(drawing.pinion), gear=tip(drawing.gear))


def pitch_radii(model: Model) -> Model:
    """Torques act, and rotations move the teeth, at the working pitch radii; the mesh cycle is right."""
    line = model.line
    factor = math.hypot(line.base_radius_p, line.pitch_point) / line.base_radius_p
    radii = replace(
        line, base_radius_p=factor * line.base_radius_p, base_radius_g=factor * line.base_radius_g
    )
    return model.but(line=radii, period_factor=factor)


def contact_ratio(value: float) -> Callable[[Line], Line]:
    """The path of contact ends after so many base pitches."""
    return lambda line: replace(line, end=line.start + value * line.base_pitch)


def exchanged_zones(line: Line) -> Line:
    """Two pairs carry for 2 - contact ratio of a base pitch, one pair for the rest."""
    return contact_ratio(3.0 - line.contact_ratio)(line)


def exchanged_approach(line: Line) -> Line:
    """The lengths of approach and recess are exchanged."""
    return replace(line, start=2.0 * line.pitch_point - line.end, end=2.0 * line.pitch_point - line.start)


# --- stiffness -------------------------------------------------------------------------------------------


@cache
def _compliances(text: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    from lumped import load_gear_pair
    from lumped.stiffness.energy import pair_compliance

    pair = load_gear_pair(tomllib.loads(text))
    settings = pair.mesh.stiffness
    places = np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, 801)
    parts = pair_compliance(pair, places, hertz=settings.hertz)
    return places, {
        "contact": parts.hertz,
        "pinion": parts.pinion.total,
        "gear": parts.gear.total,
        "bodies": parts.pinion.foundation + parts.gear.foundation,
    }


def energy_stiffness(contact: float, pinion: float, gear: float, bodies: float) -> Callable[[Model], Model]:
    """The owner's energy method, with factors on its parts; ``bodies`` multiplies a part of both teeth."""

    def change(model: Model) -> Model:
        places, parts = _compliances(as_toml(model.drawing.parameters))
        teeth = pinion * parts["pinion"] + gear * parts["gear"] + (bodies - 1.0) * parts["bodies"]
        return model.but(stiffness=sampled(places, 1.0 / (contact * parts["contact"] + teeth)))

    return change


def mean_stiffness_for_each(model: Model) -> Model:
    """c-gamma of ISO 6336-1, which is that of the mesh, is the stiffness of every tooth pair."""
    law, factor = model.stiffness, 0.75 * model.line.contact_ratio + 0.25
    return model.but(stiffness=lambda xi: factor * law(xi))


def scaled_swing(factor: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """The stiffness of the mesh swings about its mean by a factor of the right swing."""

    def shape(phase: np.ndarray, total: np.ndarray) -> np.ndarray:
        return (total.mean() + factor * (total - total.mean())) / total

    return shape


def total_stiffness(model: Model) -> tuple[Law, float]:
    """Stiffness of the mesh while a pair is at a place, and its mean over a mesh cycle."""
    line, law = model.line, model.stiffness
    phase = (np.arange(4096) + 0.5) / 4096
    total = np.zeros_like(phase)
    for index in range(math.floor(line.contact_ratio) + 1):
        xi = line.start + (phase + index) * line.base_pitch
        total += np.where(xi <= line.end, law(xi), 0.0)

    def nearest(xi: np.ndarray) -> np.ndarray:
        cycles = (xi - line.start) / line.base_pitch % 1.0
        return total[np.floor(4096 * cycles).astype(int) % 4096]

    return nearest, float(total.mean())


# --- damping ---------------------------------------------------------------------------------------------


def translation_mass_damping(model: Model, xi: np.ndarray) -> np.ndarray:
    """2 zeta sqrt(k m) with m = m_p m_g/(m_p + m_g), the masses of translation."""
    mass = model.mass_p * model.mass_g / (model.mass_p + model.mass_g)
    return 2.0 * model.drawing.mesh_damping * np.sqrt(model.stiffness(xi) * mass)


def constant_mesh_damping(model: Model, xi: np.ndarray) -> np.ndarray:
    """The mesh has one damper, 2 zeta sqrt(k_mean m_e), shared by the stiffness of the pairs."""
    total, mean = total_stiffness(model)
    damper = 2.0 * model.drawing.mesh_damping * math.sqrt(mean * model.effective_mass)
    return np.asarray(damper * model.stiffness(xi) / np.maximum(total(xi), 1e-3 * mean))


# --- friction --------------------------------------------------------------------------------------------


def friction_without_reversal(model: Model) -> Model:
    """Friction on the pinion points the way of recess at all places."""
    law = model.friction
    return model.but(friction=lambda xi: np.abs(law(xi)))


def one_place_of_friction(model: Model) -> Model:
    """All pairs have the coefficient and the arms of the pair that came into contact last."""
    line, law = model.line, model.friction

    def newest(xi: np.ndarray) -> np.ndarray:
        return line.start + (xi - line.start) % line.base_pitch

    return model.but(
        friction=lambda xi: law(newest(xi)),
        arm_p=lambda other, xi: newest(xi),
        arm_g=lambda other, xi: other.line.length - newest(xi),
    )


def static_friction(model: Model) -> Model:
    """Friction follows the static load T_p/r_bp, shared by stiffness, not the dynamic load."""
    return model.but(others=model.others | {"static_load": model.torque / model.line.base_radius_p})


# --- what the owner writes -------------------------------------------------------------------------------


def centre_frame(curves: Curves, model: Model) -> Curves:
    """Bearing forces across and along the line of centres, under the names of the line of action."""
    angle = math.atan2(model.line.pitch_point, model.line.base_radius_p)
    cosine, sine = math.cos(angle), math.sin(angle)
    result = dict(curves)
    for end in "pg":
        along, across = curves[f"bearing_force_x_{end}"], curves[f"bearing_force_y_{end}"]
        result[f"bearing_force_x_{end}"] = cosine * along - sine * across
        result[f"bearing_force_y_{end}"] = sine * along + cosine * across
    return result


def moving_average(share: float) -> Callable[[Curves, Model], Curves]:
    """Mean over a window of a share of the mesh cycle, centred; samples without a full window fall away."""

    def change(curves: Curves, model: Model) -> Curves:
        times = curves["time"]
        half = max(1, round(0.5 * share * model.period / (times[1] - times[0])))
        kernel = np.full(2 * half + 1, 1.0 / (2 * half + 1))
        result: Curves = {"time": times[half:-half]}
        for name, values in curves.items():
            if name != "time":
                smooth = [np.convolve(row, kernel, mode="valid") for row in np.atleast_2d(values)]
                result[name] = np.array(smooth).reshape(*values.shape[:-1], -1)
        return result

    return change
