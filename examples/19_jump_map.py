"""
At which torques can my pair jump?
==================================

Tip relief is cut for one torque, here some 70 N m. Far below it contact is lost in the gap that relief
leaves, far above it where the stiffness changes. There two motions exist at one speed, and the pair jumps
where one of them ends. Between is a band of torques without contact loss and without jumps.
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet
import lumped
from validation.plots.contact_loss import jump_map_figure

#: Closer where the folds move fast [N m].
TORQUES = (25.0, 33.0, 41.0, 70.0, 100.0, 116.0, 120.0, 126.0, 136.0, 150.0)


def compute(torques: Sequence[float] = TORQUES) -> xr.Dataset:
    """Stable motions and jumps of the 28/28 pair, which has 23 um of relief, below its main resonance."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(mesh__contact="prescribed", friction__law="none")
    axes = {"speed_rpm": np.linspace(9300.0, 15500.0, 160), "torque": torques}
    return floquet.jump_map(pair, axes, periods=[1])


def draw(result: xr.Dataset) -> Figure:
    """Contact and number of motions on the left, the largest motion on the right."""
    return jump_map_figure(result)


if __name__ == "__main__":
    draw(compute()).savefig("jump_map.png", dpi=150)
