"""Losses of the mesh: loss factor, mean friction, sliding loss and efficiency."""

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
