"""Chapters of the report, one small module each, in the order of ``CHAPTERS``.

A chapter is a function ``Results -> Chapter | None``, None where it was not asked for; to add one, write it
and name it here.
"""

from collections.abc import Callable

from validation.reporting.blocks import Chapter
from validation.reporting.chapters.code_verification import code_verification
from validation.reporting.chapters.cross_check import cross_check
from validation.reporting.chapters.errata import errata
from validation.reporting.chapters.limitations import limitations
from validation.reporting.chapters.losses import losses
from validation.reporting.chapters.mesh_physics import mesh_physics
from validation.reporting.chapters.paper import paper
from validation.reporting.chapters.parameters import parameters
from validation.reporting.chapters.path_of_contact import path_of_contact
from validation.reporting.chapters.provenance import provenance
from validation.reporting.chapters.scope import scope
from validation.reporting.chapters.solution_verification import solution_verification
from validation.reporting.chapters.stability import stability
from validation.reporting.chapters.stability_margins import stability_margins
from validation.reporting.chapters.steady_state import steady_state
from validation.reporting.chapters.validity import validity
from validation.reporting.chapters.validity_map import validity_map
from validation.reporting.results import Results

CHAPTERS: tuple[Callable[[Results], Chapter | None], ...] = (
    scope,
    parameters,
    path_of_contact,
    mesh_physics,
    steady_state,
    losses,
    code_verification,
    solution_verification,
    cross_check,
    stability,
    stability_margins,
    validity,
    validity_map,
    paper,
    errata,
    limitations,
    provenance,
)

__all__ = ["CHAPTERS"]
