"""One spur stage in the form of each REXS version, written by hand after the databases of the versions.

The stages are the transverse sections of public helical samples: of a gear unit in REXS 1.0
("SEW_3-stage_cylindrical_gearbox_1.0" of fva-net/rexs-api-java) and of one in 1.4
("FVA-Industriegetriebe_2stufig_1-4" of BearinxSimulationSuite/REXSapi). In the transverse section the module
is m_n/cos(beta), the profile shift coefficient x_n cos(beta), the addendum coefficient cos(beta) and
tan(alpha_t) = tan(20 deg)/cos(beta).
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Stage:
    """A spur stage: lengths in mm, angles in degrees."""

    teeth: tuple[int, int]
    module: float
    pressure_angle: float
    shifts: tuple[float, float]
    addendum: float  # coefficient of the basic rack
    centre: float
    width: tuple[float, float]
    written_tips: tuple[float, float] | None = None  # diameters of a file; None: they follow

    @property
    def alteration(self):
        """k m that keeps the clearance, DIN 3960: a - a_d - m (x_1 + x_2), at most 0."""
        return min(self.centre - self.module * (0.5 * sum(self.teeth) + sum(self.shifts)), 0.0)

    @property
    def tips(self):
        """Tip diameters: m (z + 2 x + 2 h_aP*) + 2 k m."""
        return self.written_tips or tuple(
            self.module * (z + 2.0 * x + 2.0 * self.addendum) + 2.0 * self.alteration
            for z, x in zip(self.teeth, self.shifts, strict=True)
        )

    def contact_ratio(self, tips):
        """Length of the path of contact over the base pitch (ISO 21771)."""
        alpha = math.radians(self.pressure_angle)
        bases = [self.module * z * math.cos(alpha) for z in self.teeth]
        line = math.sqrt((2.0 * self.centre) ** 2 - sum(bases) ** 2)
        path = sum(math.sqrt(tip**2 - base**2) for tip, base in zip(tips, bases, strict=True)) - line
        return 0.5 * path / (math.pi * self.module * math.cos(alpha))


def twin(teeth, normal_module, helix, shifts, centre, width):
    """Transverse section of a helical stage with the basic rack of 20 degrees."""
    slope = math.cos(math.radians(helix))
    angle = math.degrees(math.atan(math.tan(math.radians(20.0)) / slope))
    x = (shifts[0] * slope, shifts[1] * slope)
    return Stage(teeth, normal_module / slope, angle, x, slope, centre, width)


STAGES = {
    "13/76": twin((13, 76), 1.25, 10.0, (0.521, -0.094), 57.0, (23.0, 15.0)),
    "14/87": twin((14, 87), 1.5, 10.0, (0.536, -0.4815), 77.0, (41.0, 36.0)),
    "23/67": twin((23, 67), 1.0, 30.0, (0.581, 0.5131), 53.0, (16.0, 11.0)),
    "27/51": twin((27, 51), 4.5, 21.0, (0.231415, 0.231415), 190.0, (50.0, 50.0)),
    "23/34": twin((23, 34), 6.5, 10.0, (0.15074, 0.15074), 190.0, (74.0, 74.0)),
}
#: Versions whose databases have a degree sign as the unit of angles.
_SIGN = ("1.0", "1.1", "1.2", "1.3")
#: Versions before the components were split by kind of gear.
_OLD = ("1.0", "1.1", "1.2")


def rexs_text(stage, version, shifts="coefficient", tips="diameter", left_out=(), drives=1):
    """Write a stage in the form of a version.

    Parameters
    ----------
    shifts : "coefficient"; "length" (x m, from 1.2 on); "sum" (x of gear_1 and the sum); "first" (x of gear_1
        alone); "none"
    tips : "diameter"; "limits" (from 1.5 on); "height" (the tooth tip height h_a, 1.2 to 1.7); "coefficient"
        (of the basic rack); "none"
    left_out : attributes that are not written
    drives : number of the driving gear
    """
    degree = "°" if version in _SIGN else "deg"
    transverse = None if version == "1.0" else stage.pressure_angle
    flank, data = ("flank_geometry", "stage_gear_data") if version in _OLD else (
        "cylindrical_gear_flank", "cylindrical_stage_gear_data"
    )  # fmt: skip

    def component(number, kind, **values):
        units = {
            "number_of_teeth": "none", "helix_angle_reference_diameter": degree,
            "normal_pressure_angle": degree,
            "pressure_angle_in_the_transverse_section": degree, "rotational_speed": "1 / min",
            "addendum_modification_coefficient": "none", "sum_of_addendum_modification_coefficients": "none",
            "addendum_coefficient_basic_profile": "none", "is_driving_gear": "none",
            "addendum_coefficient_reference_profile": "none", "tip_radius_factor": "none",
        }  # fmt: skip
        written = "".join(
            f'<attribute id="{key}" unit="{units.get(key, "mm")}">{value}</attribute>'
            for key, value in values.items()
            if value is not None and key not in left_out
        )
        return f'<component id="{number}" type="{kind}">{written}</component>'

    def relation(number, kind, **roles):
        refs = "".join(f'<ref id="{i}" role="{role}"/>' for role, i in roles.items())
        return f'<relation id="{number}" type="{kind}">{refs}</relation>'

    total = sum(stage.shifts) if shifts == "sum" else None
    parts = [component(1, "cylindrical_stage", center_distance=stage.centre,
                       sum_of_addendum_modification_coefficients=total)]  # fmt: skip
    relations = [relation(1, "stage", stage=1, gear_1=10, gear_2=20)]
    for number, (z, x, tip, width) in enumerate(
        zip(stage.teeth, stage.shifts, stage.tips, stage.width, strict=True), 1
    ):
        coefficient = x if shifts == "coefficient" or (number == 1 and shifts in ("sum", "first")) else None
        parts.append(
            component(
                10 * number, "cylindrical_gear", number_of_teeth=z, normal_module=stage.module,
                transverse_module=stage.module if version != "1.0" else None,
                helix_angle_reference_diameter=0.0, face_width=width,
                tip_diameter=tip if tips == "diameter" else None,
                minimum_tip_diameter=tip - 0.03 if tips == "limits" else None,
                maximum_tip_diameter=tip + 0.03 if tips == "limits" else None,
                addendum_basic_profile=0.5 * (tip - stage.module * z) if tips == "height" else None,
            )
        )  # fmt: skip
        for side in (1, 2):
            parts.append(
                component(
                    10 * number + side, flank, normal_pressure_angle=stage.pressure_angle,
                    pressure_angle_in_the_transverse_section=transverse,
                    addendum_modification_coefficient=coefficient,
                    addendum_modification=x * stage.module if shifts == "length" else None,
                    addendum_coefficient_basic_profile=stage.addendum if tips == "coefficient" else None,
                )
            )  # fmt: skip
        cutter = {"addendum_coefficient_reference_profile": 1.3, "tip_radius_factor": 0.25}
        parts.append(component(10 * number + 3, "rack_shaped_tool", normal_module=stage.module, **cutter))
        parts.append(component(10 * number + 4, data, is_driving_gear=str(number == drives).lower()))
        relations += [
            relation(10 * number, "flank", gear=10 * number, left=10 * number + 1, right=10 * number + 2),
            relation(10 * number + 1, "stage_gear_data", stage=1, gear=10 * number,
                     stage_gear_data=10 * number + 4),
        ]  # fmt: skip
        if version in _OLD:
            tool = relation(
                10 * number + 2, "ordered_reference", origin=10 * number, referenced=10 * number + 3
            )
        else:
            tool = relation(10 * number + 2, "manufacturing_step", workpiece=10 * number + 1,
                            tool=10 * number + 3)  # fmt: skip
        relations.append(tool)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<model version="{version}" applicationId="by hand" applicationVersion="1" '
        f'date="2024-01-01T00:00:00+00:00"><relations>{"".join(relations)}</relations>'
        f"<components>{''.join(parts)}</components></model>\n"
    )
