"""How a REXS stage runs: which gear drives, speed, torque, centre distance, backlash, lubricant."""

from __future__ import annotations

import math
from dataclasses import replace

from lumped.fields.units import to_si
from lumped.gear_geometry.tooth_profile import involute
from validation.exchange.rexs.gears import flanks_of, gear_data_of
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.said import Reading, Said
from validation.exchange.rexs.vocabulary import derived_number

#: Field of the viscosity law -> attribute of the oil.
_VISCOSITY_LAW = {
    "kinematic_viscosity_40": "viscosity_at_40_degree_celsius",
    "kinematic_viscosity_100": "viscosity_at_100_degree_celsius",
    "density": "density_at_15_degree_celsius",
}
_PRESSURE_ANGLE = to_si(20.0, "deg")


def driving_first(said: Said, stage: Component, gears: list[Component]) -> tuple[Component, Component]:
    """Return the driving and the driven gear; where the file does not say, gear_1 drives.

    Parameters
    ----------
    said : collects notes
    stage, gears : the stage, and its gear_1 and gear_2
    """
    drives = [
        next(
            (f for d in gear_data_of(said, stage, g) if (f := said.flag(d, "is_driving_gear")) is not None),
            None,
        )
        for g in gears
    ]
    if drives[1] and not drives[0]:
        return gears[1], gears[0]
    if not drives[0] and drives[1] is not False:
        said.note(f"the file does not say which gear drives: gear_1, {gears[0].label}, is taken (assumed)")
    return gears[0], gears[1]


def read_stage(said: Said, stage: Component, pinion: Component, gear: Component) -> None:
    """Read centre distance, backlash and lubricant."""
    centre = said.number(stage, "center_distance")
    said.take("centre_distance", centre)
    _read_backlash(said, stage, pinion, gear, centre)
    _read_lubricant(said, stage)


def _read_backlash(
    said: Said, stage: Component, pinion: Component, gear: Component, centre: Reading | None
) -> None:
    """Take from the normal backlash j_bn what the centre distance does not give already.

    At the centre distance a_w teeth of full thickness have, along the line of action,
    j = m cos(alpha) [(z_1 + z_2) (inv alpha_w - inv alpha) - 2 (x_1 + x_2) tan(alpha)].
    """
    low = said.number(stage, "minimum_normal_backlash")
    high = said.number(stage, "maximum_normal_backlash")
    if low is None or high is None:
        return
    mean = Reading(0.5 * (low.si + high.si), f"{low.where} and maximum, their mean")
    thinning = mean.si - _theoretical_backlash(said, pinion, gear, centre)
    where = mean.where + ("" if centre is None else ", without the share of the centre distance")
    said.put("mesh.backlash", derived_number(max(thinning, 0.0), "mm"), where)


def _theoretical_backlash(said: Said, pinion: Component, gear: Component, centre: Reading | None) -> float:
    module = said.number(pinion, "normal_module")
    teeth = [said.number(g, "number_of_teeth") for g in (pinion, gear)]
    if centre is None or centre.si <= 0.0 or module is None or teeth[0] is None or teeth[1] is None:
        return 0.0  # without a centre distance the pair is mounted free of backlash
    angle, shifts = _PRESSURE_ANGLE, 0.0
    for component in (pinion, gear):
        for _, flank in flanks_of(said, component)[:1]:
            given = said.number(flank, "normal_pressure_angle")
            shift = said.number(flank, "addendum_modification_coefficient")
            angle = angle if given is None else given.si
            shifts += 0.0 if shift is None else shift.si
    z = teeth[0].si + teeth[1].si
    cosine = 0.5 * module.si * z * math.cos(angle) / centre.si
    if not 0.0 < cosine <= 1.0:
        return 0.0  # the pair cannot exist, which its validation says better
    rise = z * (involute(math.acos(cosine)) - involute(angle)) - 2.0 * shifts * math.tan(angle)
    return module.si * math.cos(angle) * rise


def _read_lubricant(said: Said, stage: Component) -> None:
    model = said.model
    casings = model.of_type("gear_casing")
    oils = [
        oil
        for origin in (stage, *casings)
        for oil in model.related(origin, "reference", "origin", "referenced", "lubricant")
    ]
    oils = oils or (only if len(only := model.of_type("lubricant")) == 1 else [])
    if not oils:
        return
    oil = oils[0]
    v40, v100, density = (said.number(oil, attribute) for attribute in _VISCOSITY_LAW.values())
    if v40 is not None and v100 is not None:
        law = "lubricant.viscosity_law"
        for key, reading in zip(_VISCOSITY_LAW, (v40, v100, density), strict=True):
            said.take(f"{law}.{key}", reading)
        said.take(f"{law}.temperature", _first(said, (stage, *casings), "temperature_lubricant"))
        return
    viscosity = _first(said, (stage, *casings), "operating_viscosity")
    if viscosity is not None and density is not None:
        dynamic = Reading(viscosity.si * density.si, f"{viscosity.where} times the density at 15 degC")
        said.take("lubricant.viscosity", dynamic)


def read_operating_point(said: Said, stage: Component, pinion: Component, gear: Component) -> None:
    """Read speed and torque of the driving gear.

    A load case of the load spectrum stands in where the components themselves have no value; of several load
    cases the first.
    """
    shafts = {g.id: said.model.together(g, "shaft") for g in (pinion, gear)}
    speed = _first(said, (pinion, *shafts[pinion.id]), "rotational_speed")
    if speed is None:
        other = _first(said, (gear, *shafts[gear.id]), "rotational_speed")
        teeth = [said.number(g, "number_of_teeth") for g in (pinion, gear)]
        if other is not None and teeth[0] is not None and teeth[1] is not None and teeth[0].si > 0:
            speed = Reading(other.si * teeth[1].si / teeth[0].si, f"{other.where}, times the gear ratio")
    if speed is not None:
        speed = Reading(abs(speed.si), speed.where)
        said.take("operating.pinion_speed", speed)
    torque = _torque(said, stage, pinion, shafts[pinion.id], speed)
    if torque is not None:
        said.take("operating.pinion_torque", Reading(abs(torque.si), torque.where))
    if len(said.model.load_cases) > 1:
        said.note(
            f"the file has {len(said.model.load_cases)} load cases; where they matter the first is used"
        )


def _torque(
    said: Said, stage: Component, pinion: Component, shafts: list[Component], speed: Reading | None
) -> Reading | None:
    torque = _first(said, gear_data_of(said, stage, pinion), "torque")
    if torque is not None:
        return torque
    on_shaft = {g.id for s in shafts for g in said.model.together(s, "cylindrical_gear")}
    if len(on_shaft) != 1:
        return None  # a shaft with further gears passes torque on
    loads = [load for s in shafts for load in said.model.together(s, "external_load")]
    acting = [
        r for load in loads if (r := _first(said, (load,), "torque_around_u_axis")) is not None and r.si
    ]
    if len(acting) == 1:
        return acting[0]
    powers = [r for load in loads if (r := _first(said, (load,), "power")) is not None and r.si]
    if not acting and len(powers) == 1 and speed is not None and speed.si > 0.0:
        return Reading(powers[0].si / speed.si, f"{powers[0].where} over the speed")
    return None


def _first(said: Said, places: tuple[Component, ...] | list[Component], attribute: str) -> Reading | None:
    """Return the first value of an attribute in some components, then in the first load case."""
    for component in places:
        if (found := said.number(component, attribute)) is not None:
            return found
    for case in said.model.load_cases[:1]:
        for component in places:
            for own in case.components:
                if own.id != component.id:
                    continue
                typed = replace(own, type=component.type)  # the JSON form leaves types out of load cases
                if (found := said.number(typed, attribute, case.id)) is not None:
                    return found
    return None
