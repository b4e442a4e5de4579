"""Checks of both models on a pair: numbers with their limits; and that of the pair on its shafts.

Sources: docs/theory/shafts.md, "Checks".
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import lumped
import multibody
from lumped import GearPair
from lumped.errors import ParameterError
from lumped.shafts.pair import highest_frequency


@dataclass(frozen=True)
class Check:
    """A computed number and what it must be.

    Attributes
    ----------
    key : stable name for programs
    subject : what is checked
    exact : what it must equal, and where that comes from
    value : error, relative where not said otherwise
    limit : largest error that passes
    reason : why the limit is what it is
    """

    key: str
    subject: str
    exact: str
    value: float
    limit: float
    reason: str

    @property
    def passes(self) -> bool:
        """Whether the number is one and within its limit."""
        return math.isfinite(self.value) and abs(self.value) <= self.limit


_SAMPLES, _SHARE = 64, 0.01
#: What is compared: of these the largest difference over the largest value of each.
_COMPARED = ("dte", "x_p", "y_p", "x_g", "y_g", "normal_load", "bearing_force")


def on_shafts(pair: GearPair) -> Iterator[Check]:
    """Periodic motion with the linear mesh, in the lumped model's modes and by exudyn, both with these modes.

    Nothing where the pair has no shafts, or more modes than the lumped model takes, which it says itself.
    """
    if pair.shafts is None:
        return
    same = pair.with_({"shafts.max_frequency": highest_frequency(pair) / (2.0 * math.pi)})
    try:
        modal = lumped.steady_state(same, supports="shafts", samples_per_cycle=_SAMPLES)
    except ParameterError:
        return
    machine = multibody.simulate(
        same, 1, fidelity="linear", initial="periodic", supports="shafts", samples_per_cycle=_SAMPLES
    )
    machine = machine.isel(time=slice(None, _SAMPLES))
    size = {name: float(np.abs(modal[name]).max()) for name in _COMPARED}
    worst = 0.0
    for name in _COMPARED:
        # Friction of two pairs may cancel, and with it y: then a hundredth of x counts.
        least = _SHARE * size[f"x{name[1:]}"] if name.startswith("y") else 0.0
        away = float(np.abs(machine[name].to_numpy() - modal[name].to_numpy()).max())
        worst = max(worst, away / max(size[name], least))
    yield Check(
        "on_shafts",
        "the pair on its shafts in exudyn, linear mesh: beams and reduction of its own",
        "the lumped model with the modes of the shafts; motions, loads, bearings, over their largest",
        worst,
        1e-4,
        "within 1.1e-5 on 280 random pairs of shafts with the same modes; half a stiffness, density or shear "
        "coefficient, a wrong sign or place is 0.1 and more",
    )
