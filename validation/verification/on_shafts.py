"""The machine on its shafts, worked out by both models: beams, reduction, modes, dampers and motion.

Sources: docs/theory/shafts.md, "Checks".
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

import lumped
import multibody
from lumped import GearPair
from lumped.errors import ParameterError
from lumped.shafts.pair import highest_frequency
from validation.verification.checks import Check, check

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
    yield check("on_shafts", worst)
