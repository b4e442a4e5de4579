"""The chapters of the report, one module each, in their order: a module writes ``CHAPTER``.

A chapter imports no other chapter. What several of them compute is in ``validation.reporting.results``, what
several of them say in ``validation.reporting.words``.
"""

from validation.reporting.chapter import Chapter
from validation.reporting.chapters import (
    code_verification,
    contact_forms,
    cross_check,
    errata,
    limitations,
    losses,
    mesh_physics,
    paper,
    parameters,
    path_of_contact,
    provenance,
    reference_model,
    scope,
    solution_verification,
    stability,
    stability_margins,
    steady_state,
    validity,
    validity_map,
)

CHAPTERS: tuple[Chapter, ...] = tuple(
    module.CHAPTER
    for module in (
        scope,
        parameters,
        path_of_contact,
        mesh_physics,
        steady_state,
        losses,
        code_verification,
        solution_verification,
        reference_model,
        cross_check,
        contact_forms,
        stability,
        stability_margins,
        validity,
        validity_map,
        paper,
        errata,
        limitations,
        provenance,
    )
)
