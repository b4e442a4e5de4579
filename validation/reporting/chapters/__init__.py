"""The chapters of the report, one module each, in their order: first those that the reader who
decides begins with, then evidence. A module writes ``CHAPTER``.

A chapter imports no other chapter. What several of them compute is in ``validation.reporting.results``, what
several of them say in ``validation.reporting.words``.
"""

from validation.reporting.chapter import Chapter
from validation.reporting.chapters import (
    code_verification,
    contact_forms,
    contact_loss,
    cross_check,
    four_springs,
    limitations,
    losses,
    mesh_physics,
    parameters,
    path_of_contact,
    provenance,
    solution_verification,
    stability,
    stability_margins,
    steady_state,
    tooth_stiffness,
    validity,
    validity_map,
)

CHAPTERS: tuple[Chapter, ...] = tuple(
    module.CHAPTER
    for module in (
        steady_state,
        cross_check,
        contact_loss,
        contact_forms,
        stability,
        stability_margins,
        validity,
        validity_map,
        four_springs,
        losses,
        parameters,
        limitations,
        path_of_contact,
        mesh_physics,
        tooth_stiffness,
        code_verification,
        solution_verification,
        provenance,
    )
)
