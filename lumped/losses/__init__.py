"""Losses of the mesh: loss factor, mean friction, sliding loss and efficiency.

This package computes the losses of quasi-static meshing, without vibration. The losses of a motion are
computed where the motion is computed. All places use these definitions of a power [W]:

- sliding: sum over the pairs of F v_s, with F = mu N and the sliding velocity
  v_s = (Omega_p + theta_p') xi - (Omega_g + theta_g') (L - xi) - (y_p' - y_g')
- tooth dampers: sum over the pairs of (N - N_el) p', the force of the damper times the rate of the
  compression; in the linear form N - N_el = c p'
- bearings, shafts: z'^T D z', with the matrix D of the dampers of the supports
- efficiency: 1 - (sum of all mean losses) / (T_p Omega_p)

Two powers are no losses: what rolling takes or gives along the path (``energy_residual``, ``rolling``), and
the work of the forces at tip corners.

Places that compute the losses:

- quasi-static: ``losses.efficiency.quasi_static_losses``, sliding alone
- linear motion of like teeth: ``model.results.response`` (sliding),
  ``model.mesh_cycle.PairState.damper_powers``, ``model.supports.Supports.powers``
- linear motion of teeth that differ: ``model.cycle_maps.working_velocities`` (sliding),
  ``mesh.linear.add_damper_power``, ``model.supports.Supports.powers``
- unilateral motion: ``mesh.motion.sliding_power``, ``mesh.damper.damper_power``, ``mesh.motion.add_work``

Mean losses are collected as ``model.powers.MeanPowers`` (linear, like teeth) and
``model.revolution_motion.RevolutionMotion.losses`` (all other motions).
``validation.prediction.motion.losses_of`` reads them for a report. The multibody model has a power balance of
its own, ``multibody.power_balance``.

Sources: docs/theory/contact_energy.md, "First law", "Mean powers".
"""

from lumped.friction.iso_14179 import iso_14179_mean_coefficient
from lumped.losses.efficiency import (
    QuasiStaticLosses,
    iso_14179_mesh_loss,
    iso_14179_of,
    losses_of_laws,
    quasi_static_losses,
)
from lumped.losses.loss_factor import Sharing, loss_factor, ohlendorf, ohlendorf_of

__all__ = [
    "QuasiStaticLosses",
    "Sharing",
    "iso_14179_mean_coefficient",
    "iso_14179_mesh_loss",
    "iso_14179_of",
    "loss_factor",
    "losses_of_laws",
    "ohlendorf",
    "ohlendorf_of",
    "quasi_static_losses",
]
