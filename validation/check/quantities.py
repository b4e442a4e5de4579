"""Quantities of another model's curves: names, SI units, and how each quantity is read from a motion of ours.

A quantity bears the name of the result variable that it measures, such as ``dte`` or ``bearing_force_x_p``.
The ending ``_dot`` is a rate, ``_ddot`` is an acceleration. Signs are those of the results, see
docs/reference/names.md.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple


@dataclass(frozen=True)
class Quantity:
    """A quantity that a channel of another model can hold.

    Attributes
    ----------
    name : name of the quantity
    unit : SI unit
    words : plain name
    variable : result variable from which the quantity is read
    derivative : number of derivatives in time from ``variable`` to the quantity
    of_tooth_pair : whether the quantity belongs to one tooth pair, which the channel must name
    summed : whether the quantity is the sum of ``variable`` over all tooth pairs
    has_mean : whether the mean value is defined: angles have no zero, and the mean of a rate is 0
    """

    name: str
    unit: str
    words: str
    variable: str
    derivative: int = 0
    of_tooth_pair: bool = False
    summed: bool = False
    has_mean: bool = True

    @property
    def is_rotation(self) -> bool:
        """Whether the quantity is an angle, which another model may give with its nominal rotation."""
        return self.unit == "rad"


def _quantities() -> Iterator[Quantity]:
    """All quantities, the transmission error first."""
    motions = [
        Quantity("dte", "m", "transmission error", "dte"),
        *(
            Quantity(f"theta_{end}", "rad", f"{gear} rotation about the nominal one",
                     f"theta_{end}", has_mean=False)
            for end, gear in GEARS
        ),
        *(
            Quantity(f"{axis}_{end}", "m", f"{gear} displacement {line}", f"{axis}_{end}")
            for axis, line in LINES for end, gear in GEARS
        ),
    ]  # fmt: skip
    yield from motions
    for derivative, ending, word in ((1, "_dot", "rate"), (2, "_ddot", "acceleration")):
        for motion in motions:
            yield replace(
                motion,
                name=motion.name + ending,
                unit=f"{motion.unit}/s" + ("^2" if derivative == 2 else ""),
                words=f"{word} of the {motion.words}",
                derivative=derivative,
                has_mean=False,
            )
    yield Quantity("mesh_force", "N", "mesh force, all tooth pairs together", "normal_load", summed=True)
    yield Quantity("friction", "N", "friction force, all tooth pairs together", "friction_force", summed=True)
    yield Quantity("normal_load", "N", "normal load of a tooth pair", "normal_load", of_tooth_pair=True)
    yield Quantity(
        "friction_force", "N", "friction force of a tooth pair", "friction_force", of_tooth_pair=True
    )
    for axis, line in LINES:
        for end, gear in GEARS:
            name = f"bearing_force_{axis}_{end}"
            yield Quantity(name, "N", f"bearing force on the {gear}, {line}", name)
    yield Quantity("mesh_torque_p", "N*m", "torque of the mesh against the pinion", "theta_p", derivative=2)
    yield Quantity("mesh_torque_g", "N*m", "torque of the mesh against the gear", "theta_g", derivative=2)
    yield Quantity("mesh_stiffness", "N/m", "mesh stiffness", "mesh_stiffness")


GEARS = (("p", "pinion"), ("g", "gear"))
LINES = (("x", "along the line of action"), ("y", "off the line of action"))
#: Name -> quantity.
QUANTITIES = {quantity.name: quantity for quantity in _quantities()}
#: Most places of tooth pairs at one time.
PLACES = 4
#: What a transmission error or a force is mistaken for: name -> quantity. No channel bears these names.
MISTAKEN = {
    quantity.name: quantity
    for quantity in (
        Quantity("dte of the rotations", "m", "transmission error without the displacements", "dte"),
        Quantity(
            "dte with reversed displacements",
            "m",
            "transmission error with the displacements reversed",
            "dte",
        ),
        Quantity("dte without the gear's", "m", "transmission error without the gear's displacement", "dte"),
        Quantity(
            "dte without the pinion's", "m", "transmission error without the pinion's displacement", "dte"
        ),
        Quantity("dte with a sum", "m", "transmission error with the sum of the displacements", "dte"),
        Quantity("dte less the static one", "m", "transmission error less the static one", "mesh_stiffness"),
        Quantity(
            "dte on the pitch circles", "m", "transmission error with rotations on pitch circles", "dte"
        ),
        Quantity(
            "mesh force of the springs", "N", "mesh force without that of the dampers", "mesh_stiffness"
        ),
        *(
            Quantity(
                f"resultant bearing force {end}",
                "N",
                f"magnitude of the bearing force on the {gear}",
                f"bearing_force_x_{end}",
            )
            for end, gear in GEARS
        ),
        Quantity("friction without signs", "N", "sum of the sizes of all friction forces", "friction_force"),
        *(
            Quantity(name, "N", words, "normal_load", of_tooth_pair=True)
            for name, words in (
                ("whole load of the mesh", "mesh force, given for a tooth pair"),
                ("share of the static load", "static load times the momentary share of a tooth pair"),
                ("load times its share", "load of a tooth pair times its share of the mesh force"),
            )
        ),
        *(
            Quantity(f"{name} in place {place}", "N", f"{words} in a place of the mesh", name)
            for name, words in (("normal_load", "load"), ("friction_force", "friction force"))
            for place in range(PLACES)
        ),
        Quantity(
            "equal share of the load",
            "N",
            "equal share of the mesh force for each tooth pair in contact",
            "normal_load",
            of_tooth_pair=True,
        ),
    )
}


class Displacements(NamedTuple):
    """Shares of x_p and x_g in a transmission error.

    Attributes
    ----------
    pinion, gear : factors on x_p and x_g; 1 and -1 in the true one
    """

    pinion: float
    gear: float


#: Shares of the displacements that each of these transmission errors has too much.
DISPLACEMENTS_TOO_MUCH = {
    "dte of the rotations": Displacements(-1.0, 1.0),
    "dte with reversed displacements": Displacements(-2.0, 2.0),
    "dte without the gear's": Displacements(0.0, 1.0),
    "dte without the pinion's": Displacements(-1.0, 0.0),
    "dte with a sum": Displacements(0.0, 2.0),
}


def quantity_of(name: str) -> Quantity:
    """Return the quantity of a name, or what it is mistaken for; "|name|" is the magnitude of a quantity."""
    if name.startswith("|"):
        true = quantity_of(name.strip("|"))
        return replace(true, name=name, words=f"magnitude of the {true.words}")
    return MISTAKEN[name] if name in MISTAKEN else QUANTITIES[name]


#: Labels of tooth pairs: B follows A one pitch later.
PAIR_LABELS = "ABCDEFGH"
