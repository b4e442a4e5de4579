"""What a gear on a drawing may have and spurcheck does not compute: name -> what it models instead.

The refusal of an unknown key, of numbers of teeth, and the page of limits have their sentences from here.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Limit:
    """A feature of gears that spurcheck does not compute.

    Attributes
    ----------
    subject : name of the feature
    names : keys of gear programs for the feature
    stems : words that mean the feature in any key: "helix" in ``pinion.helix_angle``
    sentence : what spurcheck models instead, and what to do
    keys : keys of a file that are refused with the sentence, for the tests
    """

    subject: str
    names: tuple[str, ...]
    stems: tuple[str, ...]
    sentence: str
    keys: tuple[str, ...]


HELICAL = Limit(
    "helical gears",
    ("beta", "helical", "spiral_angle", "overlap_ratio"),
    ("helix",),
    "Gears are spur gears; helical ones are not computed, nor by their transverse section. Delete it where "
    "it is 0.",
    ("helix_angle", "pinion.helix", "pinion.beta"),
)
INTERNAL = Limit(
    "internal gears",
    ("internal", "internal_gear", "is_internal", "annulus"),
    ("ring",),
    "Both gears are external; a gear with internal teeth (a negative number of teeth) is not computed.",
    ("internal", "gear.ring_gear"),
)
SEVERAL_MESHES = Limit(
    "several meshes",
    ("stages", "stage", "meshes"),
    ("idler", "idlers"),
    "A file has one mesh of two gears. Compute each mesh as a pair of its own; how meshes act on each other "
    "through a shared gear or shaft is not computed.",
    ("stages", "gear.idler"),
)
PLANETARY = Limit(
    "planetary stages",
    ("sun", "carrier", "epicyclic"),
    ("planet", "planets", "planetary"),
    "Planetary stages are not computed: one pinion drives one external gear. The mesh of sun and planet "
    "alone can be computed as a pair, on fixed axes and with its share of the torque.",
    ("planets", "number_of_planets", "planet_carrier.teeth"),
)
CROWNING = Limit(
    "crowning",
    ("barrelling", "barreling", "end_relief"),
    ("crown", "crowning", "crowned"),
    "The mesh is plane: the load is even over the face width, and crowning does not act. Delete it; "
    "tip_relief and root_relief change the profile.",
    ("pinion.crowning",),
)
LEAD = Limit(
    "lead corrections",
    ("flank_line", "end_easing", "face_load_factor", "khb", "k_h_beta"),
    ("lead",),
    "The mesh is plane: flanks are straight and parallel over the face width. Delete it; deviations of "
    "single teeth go into deviations.",
    ("gear.lead_slope",),
)
MISALIGNMENT = Limit(
    "misalignment",
    ("tilt", "skew", "inclination", "parallelism", "f_sigma_beta", "fbx", "fby"),
    ("misalign", "misaligned", "misalignment"),
    "The axes are parallel and the load is even over the face width. Delete it; the run-out of a gear is "
    "mounting.eccentricity in its section, and mesh.stiffness_factor makes the mesh softer.",
    ("mesh.misalignment", "shafts.misalignment_angle"),
)

#: Everything that a drawing may have and no file, in the order of the page of limits.
LIMITS = (HELICAL, INTERNAL, SEVERAL_MESHES, PLANETARY, CROWNING, LEAD, MISALIGNMENT)


def about_key(key: str) -> str:
    """Return the sentence on a key of a feature that is not computed; empty for any other key.

    >>> about_key("number_of_planets")[:34]
    'Planetary stages are not computed:'
    """
    name = key.lower()
    words = set(name.split("_"))
    for limit in LIMITS:
        if name in limit.names or words.intersection(limit.stems):
            return limit.sentence
    return ""


_NUMBERS = re.compile(r"[+\-\u2212\u2013]?\d+")


def about_teeth(text: str) -> str:
    """Return the sentence on numbers of teeth of gears that are not computed; empty for any other text.

    >>> about_teeth("20/-60")[:23], about_teeth("12/24/48")[:20]
    ('Both gears are external', 'A file has one mesh ')
    """
    if not re.fullmatch(r"[\s\d+\-\u2212\u2013/:x,()\[\]]*", text):
        return ""
    numbers = _NUMBERS.findall(re.sub(r"(?<=\d)\s*[-\u2212\u2013]\s*(?=\d)", "/", text))
    return _of_numbers([int(re.sub("[\u2212\u2013]", "-", number)) for number in numbers])


def _of_numbers(teeth: Iterable[int]) -> str:
    numbers = list(teeth)
    if any(number < 0 for number in numbers):
        return INTERNAL.sentence
    return SEVERAL_MESHES.sentence if len(numbers) > 2 else ""
