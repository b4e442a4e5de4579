"""Figures: one small module each, functions from a result to a matplotlib Figure, without global state."""

from validation.plots.cross_check import cross_check_figure
from validation.plots.forces import tooth_forces_figure
from validation.plots.history import history_figure
from validation.plots.motions import motions_figure, orders_figure
from validation.plots.multipliers import multipliers_figure
from validation.plots.path_of_contact import friction_laws_figure, path_figure
from validation.plots.stability import stability_figure
from validation.plots.stiffness import stiffness_figure
from validation.plots.style import save
from validation.plots.sweep import sweep_figure
from validation.plots.transmission_error import transmission_error_figure

__all__ = [
    "cross_check_figure",
    "friction_laws_figure",
    "history_figure",
    "motions_figure",
    "multipliers_figure",
    "orders_figure",
    "path_figure",
    "save",
    "stability_figure",
    "stiffness_figure",
    "sweep_figure",
    "tooth_forces_figure",
    "transmission_error_figure",
]
