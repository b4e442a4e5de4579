"""How a REXS stage runs: which gear drives, speed, torque, centre distance, backlash, lubricant."""

from __future__ import annotations

from lumped.fields.units import to_stated
from lumped.gear_geometry.geometry import theoretical_backlash
from lumped.schema.pair import GearPair
from validation.exchange.rexs.draft import DOUBTFUL, Draft, Reading
from validation.exchange.rexs.gears import gear_data_of
from validation.exchange.rexs.model import Component

#: Field of the viscosity law -> attribute of the oil.
_VISCOSITY_LAW = {
    "kinematic_viscosity_40": "viscosity_at_40_degree_celsius",
    "kinematic_viscosity_100": "viscosity_at_100_degree_celsius",
    "density": "density_at_15_degree_celsius",
}


def driving_first(draft: Draft, stage: Component, gears: list[Component]) -> tuple[Component, Component]:
    """Return the driving and the driven gear; where the file does not say, gear_1 drives."""
    flags = [
        [(draft.text(d, "is_driving_gear") or "").lower() for d in gear_data_of(draft, stage, g)]
        for g in gears
    ]
    first, second = ("true" if {"true", "1"} & set(f) else "false" if f and f[0] else "" for f in flags)
    if second == "true" and first != "true":
        return gears[1], gears[0]
    if first != "true" and second != "false":
        draft.note(f"the file does not say which gear drives: gear_1, {gears[0].label}, is taken (assumed)")
    return gears[0], gears[1]


def read_backlash(draft: Draft, stage: Component, pair: GearPair) -> None:
    """Take from the normal backlash what the centre distance does not give already.

    Parameters
    ----------
    pair : with the centre distance of the file, and teeth of full thickness
    """
    low, high = (draft.number(stage, f"{end}_normal_backlash") for end in ("minimum", "maximum"))
    if low is None or high is None:
        return
    where = f"{low.where} and maximum, their mean"
    if DOUBTFUL in draft.sources.get("centre_distance", ""):
        text = f"{where}, was computed with a centre distance that stands for no pair of gears"
        draft.warn(["mesh.backlash"], f"{text}; {1e3 * pair.mesh.backlash:g} mm stands in")
        return
    share = theoretical_backlash(*pair.wheels, pair.geometry.operating_pressure_angle)
    thinning = 0.5 * (low.si + high.si) - share
    remark = "" if "centre_distance" not in draft.values else ", without the share of the centre distance"
    # A difference of lengths of about 100 mm, in fifteen digits.
    draft.put("mesh.backlash", max(round(to_stated(thinning, "mm"), 12), 0.0), where + remark)


def read_lubricant(draft: Draft, stage: Component) -> None:
    """Read the oil of the stage, of the casing, or the only one of the file."""
    model = draft.model
    places = [stage, *model.of_type("gear_casing")]
    oils = [oil for place in places for oil in model.referenced(place, "lubricant")]
    oils = oils or (only if len(only := model.of_type("lubricant")) == 1 else [])
    if not oils:
        return
    v40, v100, density = (draft.number(oils[0], attribute) for attribute in _VISCOSITY_LAW.values())
    viscosity = draft.first(places, "operating_viscosity")
    if v40 is not None and v100 is not None:
        law = "lubricant.viscosity_law"
        draft.take_all(law, oils[0], _VISCOSITY_LAW)
        draft.take(f"{law}.temperature", draft.first(places, "temperature_lubricant"))
    elif viscosity is not None and density is not None:
        where = f"{viscosity.where} times the density at 15 degC"
        draft.take("lubricant.viscosity", Reading(viscosity.si * density.si, where))


def read_operating_point(draft: Draft, stage: Component, pinion: Component, gear: Component) -> None:
    """Read speed and torque of the driving gear.

    A load case of the load spectrum stands in where the components themselves have no value; of several load
    cases the first.
    """
    shafts = {g.id: draft.model.neighbours(g, "shaft") for g in (pinion, gear)}
    speed = draft.first((pinion, *shafts[pinion.id]), "rotational_speed")
    if speed is None:
        other = draft.first((gear, *shafts[gear.id]), "rotational_speed")
        teeth = [draft.values.get(f"{which}.teeth", 0) for which in ("pinion", "gear")]
        if other is not None and teeth[0] > 0:
            speed = Reading(other.si * teeth[1] / teeth[0], f"{other.where}, times the gear ratio")
    torque = _torque(draft, stage, pinion, shafts[pinion.id], speed)
    for path, reading in (("operating.pinion_speed", speed), ("operating.pinion_torque", torque)):
        if reading is not None:
            draft.take(path, Reading(abs(reading.si), reading.where))
    if (cases := len(draft.model.load_cases)) > 1:
        draft.note(f"the file has {cases} load cases; where they matter the first is used")


def _torque(
    draft: Draft, stage: Component, pinion: Component, shafts: list[Component], speed: Reading | None
) -> Reading | None:
    model = draft.model
    torque = draft.first(gear_data_of(draft, stage, pinion), "torque")
    on_shaft = {g.id for s in shafts for g in model.neighbours(s, "cylindrical_gear")}
    if torque is not None or len(on_shaft) != 1:  # a shaft with further gears passes torque on
        return torque
    loads = [load for s in shafts for load in model.neighbours(s, "external_load")]

    def acting(attribute: str) -> list[Reading]:
        return [r for load in loads if (r := draft.first([load], attribute)) is not None and r.si]

    torques, powers = acting("torque_around_u_axis"), acting("power")
    if len(torques) == 1:
        return torques[0]
    if not torques and len(powers) == 1 and speed is not None and speed.si:
        return Reading(powers[0].si / speed.si, f"{powers[0].where} over the speed")
    return None
