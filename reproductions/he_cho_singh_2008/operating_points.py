"""The paper's operating points and gear pairs."""

from __future__ import annotations

from dataclasses import dataclass

from lumped import GearPair, load_gear_pair
from lumped.friction import LAWS as ALL_LAWS
from lumped.friction import mean_coefficient
from lumped.path_of_contact import friction_path_function
from lumped.schema.files import AnyPair

_COMPARED = ("coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb")
#: Friction laws that the paper compares: name in parameter files -> its number and name there.
LAWS = {name: ALL_LAWS[name].title for name in _COMPARED}
#: The gear pairs of Fig. 2a.
PAIRS_2A = ("nasa_art_25_31", "nasa_28_28")
#: Speed at which law V changes its regime in Fig. 2b [rpm].
SWITCH_SPEED = 2500.0
#: Two calibrations that meet it: viscosity [mPa s] and composite roughness [um].
CALIBRATIONS = ((10.0, 0.144), (30.0, 0.333))


@dataclass(frozen=True)
class OperatingPoint:
    """Torque [N m] and pinion speed [rpm] of a figure."""

    torque: float
    speed: float

    def of(self, pair: GearPair) -> GearPair:
        """The pair at this point."""
        return pair.with_({"operating.pinion_torque": self.torque, "operating.pinion_speed": self.speed})


FIGURE_2A = OperatingPoint(22.6, 1000.0)
FIGURE_4 = OperatingPoint(56.5, 4875.0)
FIGURE_7 = (OperatingPoint(79.1, 800.0), OperatingPoint(79.1, 4000.0))
TORQUE_2B = FIGURE_2A.torque


def papers_pair(pair: AnyPair) -> GearPair:
    """The pair with what the paper assumes: contact from A to D, flanks without relief."""
    return load_gear_pair(pair).with_({"mesh.contact": "prescribed", "mesh.relief": "ignored"})


def second_pair(pair: GearPair) -> GearPair:
    """Return the 25/31 pair with oil and flanks of ``pair``: Fig. 2a compares geometries only.

    If ``pair`` is the 25/31 pair, the 28/28 pair is returned.
    """
    candidates = (papers_pair(name) for name in PAIRS_2A)
    other = next(c for c in candidates if c.pinion.teeth != pair.pinion.teeth)
    return other.with_(
        {
            "lubricant": pair.lubricant,
            "friction": pair.friction,
            "pinion.roughness": pair.pinion.roughness,
            "gear.roughness": pair.gear.roughness,
        }
    )


def mean_of_law(pair: GearPair, law: str) -> float:
    """Mean of |mu| over the path of contact under a friction law [-]."""
    return mean_coefficient(friction_path_function(pair, law=law))
