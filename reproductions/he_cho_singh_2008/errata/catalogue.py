"""The errata chapter: every misprint of the paper's model section shown by computation.

Sources: Abbas Al-Zubaidi 2008, compared with docs/theory/equations.md and docs/theory/friction.md.
"""

from __future__ import annotations

import math

from lumped.path_of_contact import contact_path
from lumped.schema.files import AnyPair
from reproductions.he_cho_singh_2008.errata.energy_residual import erratum_3
from reproductions.he_cho_singh_2008.errata.film import film_errata
from reproductions.he_cho_singh_2008.errata.laws import law_errata
from reproductions.he_cho_singh_2008.errata.signs import sign_errata
from reproductions.he_cho_singh_2008.errata.structure import erratum_5b, erratum_8
from reproductions.he_cho_singh_2008.operating_points import papers_pair
from reproductions.he_cho_singh_2008.records import ErrataChapter

#: Coulomb friction of the sign errata: large enough to show, credible for a dry or boundary lubricated mesh.
SHOWN_COEFFICIENT = 0.05

_TEXT = (
    "Each misprint is put back alone, with everything else repaired. Equations of motion are judged by what "
    "no choice of parameters can change: forces between two bodies come in opposite pairs (third law), "
    "forces at one contact point create no power, a passive mesh has an efficiency between 0 and 1, and a "
    "balanced drive keeps its mean speed. Laws are judged by dimensions where these decide, else by their "
    "source's values. The effects on motion, mean speed and Floquet multipliers say how much each misprint "
    "matters."
)


def errata_chapter(pair: AnyPair) -> ErrataChapter:
    """Show every erratum of the paper by computation.

    Parameters
    ----------
    pair : a gear pair at the operating point of the effects; its friction law is replaced by Coulomb friction
        of 0.05 for the signs, and by the law in question for the laws

    Returns
    -------
    ErrataChapter with text, numbers and verdict per row

    Raises
    ------
    NumericalError : the pair has no periodic motion at its operating point
    """
    pair = papers_pair(pair)
    shown = pair.with_({"friction.law": "coulomb", "friction.coefficient": SHOWN_COEFFICIENT})
    (*first, ninth), histories = sign_errata(shown)
    return ErrataChapter(
        text=_TEXT,
        conditions={
            "gear pair": pair.name,
            "pinion speed": f"{pair.operating.pinion_speed * 30.0 / math.pi:.6g} rpm",
            "pinion torque": f"{pair.operating.pinion_torque:.6g} N m",
            "flanks and contact, as in the paper": "involutes without relief, in contact from A to D",
            "friction of the sign errata": f"Coulomb, mu = {SHOWN_COEFFICIENT}",
            "composite roughness": f"{1e6 * contact_path(pair).composite_roughness:.4g} µm",
        },
        errata=(
            *first,
            erratum_3(pair),
            erratum_8(),
            ninth,
            erratum_5b(pair),
            *law_errata(pair),
            *film_errata(pair),
        ),
        histories=histories,
    )
