"""Stiffness of a tooth pair, change of the stiffness with the load, and coupling: against second values.

Both models read these quantities from ``lumped.path_of_contact``, so no comparison of motions can show a
fault in these quantities. The second values come from ``multibody.elasticity.pair``, and share no code with
``lumped.stiffness``. Each row names the source of the second value. A formula coded a second time is evidence
against faults of coding alone, because both codes have one source.

Sources: docs/theory/elasticity.md, "What checks the stiffness of a pair".
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lumped import GearPair
from lumped.path_of_contact import pair_stiffness
from lumped.path_of_contact.stiffness import contact_softening, cross_compliances
from lumped.typing import FloatArray
from multibody.elasticity.pair import (
    ElasticPair,
    changes_with_load,
    compared_places,
    elastic_pair,
    neighbour_motion,
    neighbours_coupled,
    pair_compliance,
    width_over_depth,
)
from validation.cross_check.verdict import Judgement

#: Phases of the mesh cycle, at each of which all pairs in contact are compared.
PHASES = 8
#: Places of a pair behind, as shares of the range of its coupling with a pair ahead.
_SHARES = np.array([0.1, 0.5, 0.9])
#: Operating load over the other load at which the change of a compliance is compared.
_LOADS = 4.0
#: Rounding of a formula that is coded twice; quadrature, fits and truncated series of both sides.
_ROUNDING = 1e-9
_QUADRATURE = 1e-6
#: Weber and Banaschek's formula leaves out terms of the square of the half width over the depth. So much of
#: the square changes the stiffness of a pair at most, and its change with the load.
_SHALLOW_STIFFNESS = 0.02
_SHALLOW_CHANGE = 0.4
#: Series of a ring by two methods, over the compliance of the pair: 1e-4 on 170 pairs.
_RING = 1e-3
#: A beam on a ring is softer than plane finite elements by this share, and by how much the share varies: 1 to
#: 15 % along the path of 160 pairs, up to 19 % on the most unusual of 500.
_BEAM_EXCESS = 0.08
_BEAM_VARIATION = 0.12
#: Largest change of this share along the path of contact: 0.047 on 660 pairs.
_BEAM_SHAPE = 0.06
#: Coupling by finite elements against a foot without a tooth, over the compliance of the pair. A term goes
#: with 1/z: the ring spreads the mass of the teeth evenly over the rim, and no tooth bends. A share of the
#: coupling itself counts on thin rims, which become oval.
_FOOT = 0.02
_TOOTH_MASS = 0.9
_RIM = 0.1

#: Stiffness model -> what the second value of a pair's compliance stands on.
_SOURCES = {
    "rectangular": "ISO 6336-1, coded a second time: checks the code, not the standard",
    "parabolic": "ISO 6336-1, coded a second time: checks the code, not the standard",
    "energy": "own beam and contact; body by the published polynomials, coded a second time",
    "finite_elements": "own beam, contact and elastic ring, less 8 % for their softness",
    "table": "the table of the file, at its points: checks the interpolation",
}
_GIVEN = "the numbers of the file: checks how they are used"
_CONTACT = "stresses below a Hertzian pressure, at two loads"
_SERIES = "elastic ring, solved by Ritz's method"
_NONE = "this stiffness has none"


@dataclass(frozen=True)
class StiffnessAgreement:
    """One elastic quantity of a pair against its second value.

    Attributes
    ----------
    quantity : "stiffness", "shape", "softening" or "neighbours"
    long_name : the quantity in words
    source : source of the second value
    difference : largest difference as a share; ``reason`` names the whole
    size : largest second value, as a share of the same whole
    limit, reason : largest ``difference`` within the limit, and the reason for the limit
    """

    quantity: str
    long_name: str
    source: str
    difference: float
    size: float
    limit: float
    reason: str

    @property
    def within(self) -> bool:
        """Whether the difference is within the limit. NaN is not within the limit."""
        return self.difference <= self.limit

    @property
    def telling(self) -> bool:
        """Whether the check would see that the quantity is left out."""
        return self.size > self.limit

    @property
    def judgement(self) -> Judgement:
        """The difference against its limit."""
        return Judgement(f"elasticity: {self.quantity}", self.difference, self.limit, self.reason)


@dataclass(frozen=True)
class _Compared:
    """A pair and both values of its compliance.

    Attributes
    ----------
    pair : the gear pair
    elastic : the pair as the second values read it
    place : places on the line of action that are compared [m]
    compliance : second value under the operating load [m/N]
    stiffness : value of the lumped model [N/m]
    shallowness : square of the half width of the contact over its depth
    """

    pair: GearPair
    elastic: ElasticPair
    place: FloatArray
    compliance: FloatArray
    stiffness: FloatArray
    shallowness: float


def stiffness_agreement(pair: GearPair) -> tuple[StiffnessAgreement, ...]:
    """Compare the elasticity of a tooth pair with its second values, at places over the whole mesh cycle."""
    elastic = elastic_pair(pair)
    place = compared_places(elastic, PHASES)
    compared = _Compared(
        pair=pair,
        elastic=elastic,
        place=place,
        compliance=pair_compliance(elastic, place, elastic.nominal_load),
        stiffness=pair_stiffness(pair)(place),
        shallowness=width_over_depth(elastic, place) ** 2,
    )
    return (*_stiffness(compared), _softening(compared), _neighbours(compared))


def _stiffness(compared: _Compared) -> Iterator[StiffnessAgreement]:
    """Stiffness of a pair at places in single and multiple contact."""
    model = compared.pair.mesh.stiffness
    second = 1.0 / compared.compliance
    if model.model == "finite_elements":
        second = second * (1.0 + _BEAM_EXCESS)
        ratio = compared.stiffness / second
        yield StiffnessAgreement(
            "shape",
            "stiffness along the path of contact",
            _source(compared.pair),
            float(np.abs(ratio / ratio.mean() - 1.0).max()),
            float(np.abs(second / second.mean() - 1.0).max()),
            _BEAM_SHAPE,
            "ratio of both stiffnesses over its mean; a beam on a ring has nearly the shape of the plane "
            "solution: 0.047 at most on 660 pairs",
        )
    limits = {
        "finite_elements": (
            _BEAM_VARIATION,
            "difference over the largest stiffness; stress spread evenly and linearly at the foot makes a "
            "beam on a ring softer than the plane solution, by 1 to 15 % on 160 pairs, of which 8 % are "
            "taken off",
        ),
        "energy": (
            _QUADRATURE + _SHALLOW_STIFFNESS * compared.shallowness,
            "difference over the largest stiffness; Weber and Banaschek's formula leaves out the square of "
            "the half width over the depth",
        ),
        "table": (
            _QUADRATURE + _SHALLOW_STIFFNESS * compared.shallowness * model.whole_mesh,
            "difference over the largest stiffness; fits of the table and of the shares of the pairs",
        ),
    }
    limit, reason = limits.get(
        model.model, (_ROUNDING, "difference over the largest stiffness; the same formula: rounding")
    )
    yield StiffnessAgreement(
        "stiffness",
        "stiffness of a tooth pair",
        _source(compared.pair),
        float(np.abs(compared.stiffness - second).max() / second.max()),
        1.0,
        limit,
        reason,
    )


def _source(pair: GearPair) -> str:
    """What the second value of the stiffness stands on."""
    model = pair.mesh.stiffness
    if model.model == "rectangular" and model.pair_stiffness is not None:
        return _GIVEN
    if model.model == "parabolic" and None not in (model.peak, model.end_ratio):
        return _GIVEN
    if model.model == "energy" and model.scale == "iso6336":
        return f"{_SOURCES['energy']}; mean of ISO 6336-1, coded a second time"
    if model.model == "table" and model.whole_mesh:
        return f"{_SOURCES['table']}; shares of the pairs by own beam and contact"
    return _SOURCES[model.model]


def _softening(compared: _Compared) -> StiffnessAgreement:
    """Change of the compliance between the operating load and a quarter of the load."""
    fall = contact_softening(compared.pair) * math.log(_LOADS)  # of the lumped model, over the two loads
    name = "change of the compliance with the load"
    if not changes_with_load(compared.elastic):
        share = abs(fall) * float(compared.stiffness.max())
        reason = "change over the compliance; none: the stiffness holds for every load"
        return StiffnessAgreement("softening", name, _NONE, share, 0.0, _ROUNDING, reason)
    light = compared.elastic.nominal_load / _LOADS
    change = pair_compliance(compared.elastic, compared.place, light) - compared.compliance
    return StiffnessAgreement(
        "softening",
        name,
        _CONTACT,
        float(np.abs(fall / change - 1.0).max()),
        1.0,
        _QUADRATURE + _SHALLOW_CHANGE * compared.shallowness,
        "difference over the change; Weber and Banaschek's formula leaves out the square of the half width "
        "over the depth",
    )


def _neighbours(compared: _Compared) -> StiffnessAgreement:
    """Motions of all pairs that may touch at the same time as a loaded pair, over the pair's compliance."""
    pair = compared.pair
    name = "motion of a pair by the load of the next one"
    laws = cross_compliances(pair)
    least = 1.0 / float(compared.stiffness.max())
    if not neighbours_coupled(compared.elastic):
        share = max((float(np.abs(law(law.interval[0]))) / least for law in laws), default=0.0)
        reason = "motion over the compliance of the pair; none: a pair of this stiffness stands alone"
        return StiffnessAgreement("neighbours", name, _NONE, share, 0.0, _ROUNDING, reason)
    difference = 0.0
    size = 0.0
    mean = float(compared.compliance.mean())
    pitch = compared.elastic.circles.pitch
    start = compared.elastic.circles.start
    end = compared.elastic.circles.end
    for pitches in range(1, math.floor((end - start) / pitch) + 1):
        place = start + (end - start - pitches * pitch) * _SHARES
        second = neighbour_motion(compared.elastic, pitches, place)
        lumped = laws[pitches - 1](place) if pitches <= len(laws) else np.zeros(place.shape)
        difference = max(difference, float(np.abs(lumped - second).max()) / mean)
        size = max(size, float(np.abs(second).max()) / mean)
    limit = _RING
    reason = "difference over the compliance of the pair; two solutions of one ring: truncated series"
    if pair.mesh.stiffness.model == "finite_elements":
        limit = _FOOT + _TOOTH_MASS * _mean_tooth_share(pair) + _RIM * size
        reason = (
            "difference over the compliance of the pair; the ring has a foot without a tooth, and the mass "
            "of the teeth is spread over it: the fewer teeth, the larger the difference"
        )
    return StiffnessAgreement("neighbours", name, _SERIES, difference, size, limit, reason)


def _mean_tooth_share(pair: GearPair) -> float:
    """Share 1/z of one tooth in a gear, the mean of both gears, each with the weight of its softness."""
    softness = (1.0 / pair.pinion.youngs_modulus, 1.0 / pair.gear.youngs_modulus)
    return (softness[0] / pair.pinion.teeth + softness[1] / pair.gear.teeth) / sum(softness)
