"""The reference of a check: the motion of the lumped model, and how far the multibody model differs from it.

A difference below the difference of both programs of ours is no difference.

Sources: docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np

import multibody
from lumped.errors import SpurcheckError
from lumped.schema.pair import GearPair
from validation.check.motion_curves import MotionCurves
from validation.prediction.motion import predicted

#: Samples in a mesh cycle of the motions that a search tries, and of the reference. With prescribed contact
#: the force of a tooth damper has narrow peaks where pairs meet: 512 samples gave wrong orders of the mesh
#: force for a small motion at low speed.
_TRIAL_SAMPLES = 512
REFERENCE_SAMPLES = 2048
#: Samples in a mesh cycle of the multibody model: order 12 is right to 1e-4.
_SAMPLES = 256


def lumped_motion(
    pair: GearPair, recurrence: int | None = None, *, samples: int = _TRIAL_SAMPLES
) -> MotionCurves:
    """Return the predicted motion of a pair.

    Parameters
    ----------
    pair : the gear pair
    recurrence : mesh cycles after which the same labelled tooth pair is in contact again; None: the teeth of
        the pinion
    samples : samples in a mesh cycle where all teeth are alike

    Raises
    ------
    NumericalError : no motion was found
    """
    prediction = predicted(pair, samples)
    again = recurrence or pair.pinion.teeth
    return MotionCurves.of(pair, prediction.cycle, prediction.mesh_cycles, again)


def multibody_motion(pair: GearPair, lumped_curves: MotionCurves) -> MotionCurves | None:
    """Return the periodic motion of the multibody model near that of the lumped model.

    None: the multibody model has no periodic motion there, or the teeth differ, or the pair is on shafts.
    """
    if pair.healthy is not pair or pair.shafts is not None or lumped_curves.mesh_cycles > 1:
        return None
    loads = lumped_curves.samples("mesh_force")
    lost = bool(np.min(loads) <= 0.0)
    with suppress(SpurcheckError):
        motion = multibody.steady_state(
            pair,
            fidelity="exact",
            samples_per_cycle=_SAMPLES,
            effects={"clearance": True} if lost else None,
            supports="springs",
        )
        return MotionCurves.of(pair, motion, 1, lumped_curves.recurrence)
    return None
