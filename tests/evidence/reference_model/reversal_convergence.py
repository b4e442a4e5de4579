"""How much the velocity over which friction changes its sign matters: the same run with smaller ones.

Sources: docs/theory/multibody.md, "Sticking friction".
"""

import itertools

import numpy as np

import multibody
from lumped.schema.pair import GearPair

#: Halved from 8 mm/s on [m/s]; the default of ``multibody.contact.machine`` is smaller than the last.
VELOCITIES = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4)


def reversal_changes(pair: GearPair, quantity: str, cycles: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Largest changes from one velocity to the next over the peak to peak, and their observed orders."""
    runs = [multibody.simulate(pair, cycles, friction_velocity=v)[quantity].to_numpy() for v in VELOCITIES]
    change = np.array([np.abs(a - b).max() for a, b in itertools.pairwise(runs)]) / np.ptp(runs[-1])
    # The change between velocities of a constant ratio falls as the velocity to the power of the order.
    values = np.array(VELOCITIES)
    return change, np.log(change[:-1] / change[1:]) / np.log(values[:-2] / values[1:-1])
