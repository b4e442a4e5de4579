"""Which fields of a pair its numbers depend on: those that the chosen laws and models read.

A parameter file holds the parameters of all friction laws, and dimensions that only some stiffness models
need. Laws and models say what they read (``FrictionLaw.reads``, ``StiffnessModel.reads``); here that is
translated into fields. All other fields are read always.
"""

from __future__ import annotations

from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.registry import NO_FRICTION, law_of
from lumped.friction.table import TABLE
from lumped.schema.assumed import WORDS, within
from lumped.schema.changes import fields_of
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.friction import FRICTION_FIELDS, fields_of_factors
from lumped.schema.pair import GearPair, field_values
from lumped.stiffness.base import TOOTH_FORM

#: The profile of the flanks, beside their involutes.
_PROFILE = ("mesh.relief", "gears.tip_relief", "gears.root_relief")
#: Fields that laws, models or the rest of a pair may leave unread.
_CONDITIONAL = {
    *(field for fields in FRICTION_FIELDS.values() for field in fields),
    *TOOTH_FORM,
    "friction.table",
    "gears.density",
    "basic_rack.addendum_coefficient",
    *_PROFILE,
    "mesh.contact",
    "mesh.backlash",
}


def fields_read(pair: AnyPair, *, contact_lost: bool = False) -> frozenset[str]:
    """Return the fields on which motion, losses and stability of a pair depend.

    Any other field changes no number of page 1 of the report. ``mesh.backlash`` is read only where contact is
    lost: the prediction has no back sides of teeth, but the second model has them, and motions beyond contact
    loss are followed over twice the backlash.

    Parameters
    ----------
    pair : the gear pair
    contact_lost : whether the motion loses contact

    Returns
    -------
    dotted paths of fields that have a value or one that follows from others, without name and description

    Examples
    --------
    >>> pair = load_gear_pair("nasa_28_28")
    >>> "friction.maximum" in fields_read(pair)
    False
    >>> "friction.maximum" in fields_read(pair.with_(law="benedict_kelley"))
    True
    """
    pair = load_gear_pair(pair)
    used = {*_of_friction(pair), *pair.mesh.stiffness.reads, *_of_bodies(pair), *_of_contact(pair)}
    if contact_lost:
        used.add("mesh.backlash")
    unread = [*_both(_CONDITIONAL)]
    read = [*_both(used)]
    return frozenset(
        path
        for path in field_values(pair)
        if path not in WORDS
        and (any(within(path, one) for one in read) or not any(within(path, one) for one in unread))
    )


def _both(fields: set[str]) -> set[str]:
    """The fields, where "gears" is both gears."""
    return {one for field in fields for one in fields_of(field)}


def _of_friction(pair: GearPair) -> set[str]:
    friction = pair.friction
    law = law_of(friction)
    if law is NO_FRICTION:
        return set()
    if friction.law == TABLE:
        return {"friction.table"} | fields_of_factors()
    names = set(FRICTION_FIELDS) if law.reads is None else set(law.reads)
    if "coefficient" in names and friction.coefficient is None:
        names |= BENEDICT_KELLEY.reads or set()
    fields = {field for name in names for field in FRICTION_FIELDS[name]}
    if friction.composite_roughness is not None and "roughness" not in names:
        fields.discard("gears.roughness")  # the film has its own
    return fields | fields_of_factors()


def _of_bodies(pair: GearPair) -> set[str]:
    """Fields of both gears on which geometry, masses and supports depend."""
    fields: set[str] = set()
    gears = {"pinion": pair.pinion, "gear": pair.gear}
    for name, gear in gears.items():
        if gear.mass is None or gear.inertia is None:
            fields |= {f"{name}.density", f"{name}.bore"}
        if gear.addendum is None and gear.tip_diameter is None:
            fields.add("basic_rack.addendum_coefficient")
    if pair.healthy is not pair or pair.shafts is not None:
        # Faults have the strength of the tooth; the second model has the gear on its shaft as a body.
        fields |= TOOTH_FORM
    return fields


def _of_contact(pair: GearPair) -> set[str]:
    """Fields of contact and of the flanks' profile. A stiffness of the whole mesh already includes both."""
    if pair.mesh.stiffness.whole_mesh:
        # Differences of single tips from the relief act, with the start and the shape of the relief.
        of_single_tips = ("gears.tip_relief.start_roll_angle", "gears.tip_relief.shape")
        return set() if pair.healthy is pair else set(of_single_tips)
    gears = (pair.pinion, pair.gear)
    relieved = any(one.tip_relief is not None or one.root_relief is not None for one in gears)
    return {"mesh.contact", *(_PROFILE if relieved else ())}
