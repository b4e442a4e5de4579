"""One table of the words that users write for a parameter, and of the field that has the parameter.

A refused key of a file, a refused argument in Python and a refused option of the command take their advice
from here. Add a row where a user writes a word that no field has.
"""

from __future__ import annotations

from dataclasses import dataclass

#: Sections of one gear in a file.
GEARS = ("pinion", "gear")


@dataclass(frozen=True)
class Hint:
    """The fields for a word that users write.

    Attributes
    ----------
    words : words that users write
    fields : paths of the fields; a path that begins with "gears." is a field of either gear
    changes : field or short name -> example of its value, as ``pair.with_`` and --set take them
    sentence : what the field is; it follows the paths
    """

    words: tuple[str, ...]
    fields: tuple[str, ...]
    changes: tuple[tuple[str, str], ...]
    sentence: str

    def named(self, section: str = "") -> str:
        """Return the paths of the fields as text. ``section``: the gear that the user has named, or empty."""
        gear = section.partition(".")[0]
        gears = (gear,) if gear in GEARS else GEARS
        names = [
            path.replace("gears.", f"{one}.", 1)
            for path in self.fields
            for one in (gears if path.startswith("gears.") else ("",))
        ]
        return " and ".join(names)

    @property
    def settings(self) -> str:
        """Options of the command that set the fields, with the values of the examples."""
        return " ".join(f"--set {_in_quotes(f'{name}={example}')}" for name, example in self.changes)

    @property
    def arguments(self) -> str:
        """Arguments of ``pair.with_`` that set the fields, with the values of the examples."""
        return ", ".join(f"{name.replace('.', '__')}={_as_python(example)}" for name, example in self.changes)


#: Every word that users write for something that a file has under another name.
HINTS = (
    Hint(
        ("quality", "accuracy", "accuracy_grade", "quality_class", "tolerance_class", "iso_1328"),
        ("gears.deviations.tolerance_class",),
        (("gears.deviations.tolerance_class", "6"),),
        "It is the flank tolerance class of ISO 1328; without it all teeth are alike.",
    ),
    Hint(
        ("oil", "oil_grade", "grade", "vg", "iso_vg"),
        ("lubricant.viscosity_law",),
        (("oil", "vg220"), ("temperature", "70")),
        "For example viscosity_law = { iso_vg = 220, temperature = 70 }, with the grade and the temperature "
        "(degC) of your oil.",
    ),
    Hint(
        ("power", "input_power", "pinion_power", "motor_power"),
        ("operating.pinion_power",),
        (("power", "5 kW"),),
        "It stands in place of pinion_torque: the torque is the power over the speed.",
    ),
    Hint(
        ("module", "normal_module", "m_n", "mn"),
        ("basic_rack.module",),
        (("module", "2.5"),),
        "Both gears have one rack.",
    ),
    Hint(
        ("pressure_angle", "alpha_n"),
        ("basic_rack.pressure_angle",),
        (("pressure_angle", "20"),),
        "Both gears have one rack.",
    ),
    Hint(
        ("dp", "diametral_pitch"),
        ("basic_rack.module",),
        (("module", "0.2 inch"),),
        "The module is 1 inch over the diametral pitch: 0.2 inch, 5.08 mm, for 5 teeth an inch.",
    ),
    Hint(
        ("material", "steel"),
        ("gears.youngs_modulus", "gears.poisson_ratio", "gears.density"),
        (("gears.youngs_modulus", "206 GPa"), ("gears.poisson_ratio", "0.3"), ("gears.density", "7850")),
        "Give all three; without them it is steel.",
    ),
    Hint(
        ("eccentricity", "runout", "run_out"),
        ("gears.mounting.eccentricity",),
        (("gears.mounting.eccentricity", "10 um"),),
        "It is the distance from the axis of the gear to the axis of rotation.",
    ),
    Hint(
        ("mu", "friction_coefficient", "friction_coeff", "cof"),
        ("friction.law", "friction.coefficient"),
        (("law", "coulomb"), ("friction.coefficient", "0.05")),
        "For a constant mu write law = 'coulomb' and coefficient in friction.",
    ),
    Hint(
        ("rpm", "speed_rpm", "pinion_rpm", "n1", "omega"),
        ("operating.pinion_speed",),
        (("speed", "1450"),),
        "A number is in rpm; a text has its unit: '24 Hz'.",
    ),
    Hint(
        ("load", "moment", "input_torque", "t1"),
        ("operating.pinion_torque",),
        (("torque", "80"),),
        "A number is in N m; a text has its unit: '700 lbf*in'.",
    ),
    Hint(
        ("ratio", "gear_ratio", "transmission_ratio", "z", "z1", "z2"),
        ("gears.teeth",),
        (("teeth", "19/41"),),
        "The ratio follows from the numbers of teeth of pinion and gear.",
    ),
    Hint(
        ("oil_temperature", "temp", "oil_temp"),
        ("lubricant.viscosity_law.temperature",),
        (("oil", "vg220"), ("temperature", "70")),
        "It is in degC and belongs to an oil with a grade, iso_vg.",
    ),
    Hint(
        ("width", "facewidth"),
        ("gears.face_width",),
        (("face_width", "20"),),
        "The common width of both gears carries the load.",
    ),
    Hint(
        ("zeta", "damping_factor", "mesh_damping"),
        ("mesh.damping_ratio",),
        (("damping", "0.05"),),
        "It is the damping ratio of the mesh.",
    ),
    Hint(
        ("friction_law",),
        ("friction.law",),
        (("law", "coulomb"),),
        "Laws are I to V, none, or a name such as coulomb.",
    ),
)
_BY_WORD = {word: hint for hint in HINTS for word in hint.words}


def hint_of(word: str) -> Hint | None:
    """Return the row for a word that a user wrote; None: there is no row.

    >>> hint_of("quality").named("gear")
    'gear.deviations.tolerance_class'
    """
    return _BY_WORD.get(word.lower().replace("-", "_"))


def _in_quotes(text: str) -> str:
    return f"'{text}'" if any(c in text for c in " *") else text


def _as_python(example: str) -> str:
    return example if example.replace(".", "", 1).isdigit() else repr(example)
