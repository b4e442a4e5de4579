"""Compliance of a tooth pair, its change with the load and its coupling with the next pairs, a second time.

Every motion of both models reads these quantities from ``lumped``. ``validation.cross_check.stiffness``
compares them with the values of this file, which imports nothing from ``lumped.stiffness``,
``lumped.elasticity`` or ``lumped.gear_geometry``. What each value stands on:

- Rectangular and parabolic stiffness: the number of the file, or ISO 6336-1 coded a second time.
- Energy method: the tooth drawn and integrated in another way, the contact from the stresses below a Hertzian
  pressure, the body by the published polynomials coded a second time.
- Finite elements: the same tooth and contact as a beam, and the body as a ring that Ritz's method solves.
- Table: the values of the file at the points of the file.
- Coupling of neighbouring pairs: the ring that Ritz's method solves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.elasticity.body import (
    PUBLISHED_RING,
    SOLID,
    Body,
    foot_forces,
    foot_motions,
    published_deflection,
    ring_twist,
)
from multibody.elasticity.outline import Outline, load_angle, outline, teeth_masses
from multibody.elasticity.standard import mean_stiffness, single_stiffness
from multibody.elasticity.table import TablePoints, table_points
from multibody.elasticity.tooth import (
    Elasticity,
    beam_compliance,
    contact_depth,
    half_width,
    linear_contact,
    shortening,
)
from multibody.gears.circles import Circles, circles

#: Points of Gauss's rule for the mean of a stiffness over the path of contact.
_MEAN_POINTS = 24
#: A place this close to A or D, in base pitches, is left out.
_ENDS = 1e-6


class ElasticGear(NamedTuple):
    """One gear of an elastic pair.

    Attributes
    ----------
    outline : a tooth as the rack cuts it
    material : Young's modulus and Poisson's ratio
    plane : the same for the plane problem of tooth and body; equal to ``material`` in plane stress
    body : the gear below its teeth
    """

    outline: Outline
    material: Elasticity
    plane: Elasticity
    body: Body


@dataclass(frozen=True)
class ElasticPair:
    """What the second values need of a gear pair.

    Attributes
    ----------
    pair : the gear pair
    circles : circles and path of contact, by the formulas of this package
    pinion, gear : tooth, material and body of both gears
    face_width : common to both gears [m]
    nominal_load : load of a tooth pair that carries the operating torque alone [N]
    table : points of a tabulated stiffness; None for other models
    """

    pair: GearPair
    circles: Circles
    pinion: ElasticGear
    gear: ElasticGear
    face_width: float
    nominal_load: float
    table: TablePoints | None

    @property
    def contact_ratio(self) -> float:
        """Length of the path of contact over the base pitch."""
        return (self.circles.end - self.circles.start) / self.circles.pitch

    @property
    def materials(self) -> tuple[Elasticity, Elasticity]:
        """Material of pinion and gear."""
        return self.pinion.material, self.gear.material


def elastic_pair(pair: GearPair) -> ElasticPair:
    """Read a gear pair for the second values."""
    drawn = circles(pair)
    reach = (drawn.reach_pinion, drawn.reach_gear)
    pinion, gear = (_elastic_gear(pair, number, reach[number]) for number in (0, 1))
    model = pair.mesh.stiffness
    return ElasticPair(
        pair=pair,
        circles=drawn,
        pinion=pinion,
        gear=gear,
        face_width=min(pair.pinion.face_width, pair.gear.face_width),
        nominal_load=pair.operating.pinion_torque / drawn.base_pinion,
        table=table_points(model, drawn) if model.model == "table" else None,
    )


def _elastic_gear(pair: GearPair, number: int, reach: float) -> ElasticGear:
    """Pinion (0) or gear (1) whose flank ends at the length ``reach`` on its base tangent [m]."""
    gear = (pair.pinion, pair.gear)[number]
    tooth = outline(pair, number)
    material = Elasticity(gear.youngs_modulus, gear.poisson_ratio)
    model = pair.mesh.stiffness
    if model.model != "finite_elements":
        return ElasticGear(tooth, material, material, Body("untwisted", PUBLISHED_RING, material.poisson))
    plane = material
    if model.plane == "strain":
        plane = Elasticity(
            material.modulus / (1.0 - material.poisson**2), material.poisson / (1.0 - material.poisson)
        )
    bore_ratio = 2.0 * tooth.root_radius / gear.bore if gear.bore > 0.0 else SOLID
    if model.support != "free":
        return ElasticGear(tooth, material, plane, Body(model.support, bore_ratio, plane.poisson))
    masses = teeth_masses(tooth, reach)
    body = Body("free", min(bore_ratio, SOLID), plane.poisson, masses.mass, masses.inertia)
    return ElasticGear(tooth, material, plane, body)


def compared_places(elastic: ElasticPair, phases: int) -> FloatArray:
    """Places of all pairs in contact at evenly spaced phases of the mesh cycle; the points of a table [m].

    A place is a distance from X on the line of action.
    """
    drawn = elastic.circles
    if elastic.table is not None:
        return elastic.table.place
    phase = (np.arange(phases) + 0.5) / phases
    pairs = np.arange(math.ceil(elastic.contact_ratio))
    place = drawn.start + drawn.pitch * np.add.outer(pairs, phase).ravel()
    return np.asarray(place[place < drawn.end - _ENDS * drawn.pitch], dtype=np.float64)


def _factor_on_stiffness(pair: GearPair) -> float:
    """Factor of the file on the stiffness of a tooth pair, from the fields of the schema.

    The lumped model has its factors in ``lumped.path_of_contact.stiffness.FACTORS``.
    """
    return pair.mesh.stiffness_factor


def pair_compliance(elastic: ElasticPair, place: FloatArray, load: float) -> FloatArray:
    """Compliance of one tooth pair under a load [N], at places on the line of action [m/N].

    The factor of the file on the stiffness is applied.
    """
    model = elastic.pair.mesh.stiffness
    if model.model == "finite_elements":
        stiffness = 1.0 / _plane_compliance(elastic, place, load)
    elif model.model == "energy":
        stiffness = _energy_stiffness(elastic, place, load) * _ramp(elastic, place, model.ramp_length)
    elif model.model == "table":
        stiffness = _table_stiffness(elastic, place, load) * _ramp(elastic, place, model.ramp_length)
    elif model.model == "parabolic":
        stiffness = _parabola(elastic, place) * _ramp(elastic, place, model.ramp_length)
    else:
        number = model.pair_stiffness
        stiffness = np.full(place.shape, single_stiffness(elastic.pair) if number is None else number)
    return np.asarray(1.0 / (_factor_on_stiffness(elastic.pair) * stiffness), dtype=np.float64)


def changes_with_load(elastic: ElasticPair) -> bool:
    """Whether the stiffness changes with the load: a scaled or ramped curve keeps the operating torque."""
    model = elastic.pair.mesh.stiffness
    if model.model == "energy":
        return model.hertz != "linear" and model.scale == "none" and model.ramp_length == 0.0
    return model.model == "finite_elements"


def neighbours_coupled(elastic: ElasticPair) -> bool:
    """Whether the load of one pair moves the next pairs; a curve scaled to the standard contains it."""
    model = elastic.pair.mesh.stiffness
    return model.model == "finite_elements" or (model.model == "energy" and model.scale == "none")


def neighbour_motion(elastic: ElasticPair, pitches: int, place: FloatArray) -> FloatArray:
    """Motion of the pair so many base pitches ahead by a unit load on the pair at a place [m/N].

    The motions of both gears add. The factor of the file on the stiffness is applied.
    """
    distance = pitches * elastic.circles.pitch
    tangent = elastic.circles.tangent
    motion = _foot_motion(elastic.pinion, pitches, place, place + distance)
    # The line of the gear's base tangent counts from Y: the pair ahead has the smaller length.
    motion = motion + _foot_motion(elastic.gear, pitches, tangent - place - distance, tangent - place)
    return np.asarray(motion / (elastic.face_width * _factor_on_stiffness(elastic.pair)), dtype=np.float64)


def width_over_depth(elastic: ElasticPair, place: FloatArray) -> float:
    """Largest half width of the contact over the depth down to the middle of a tooth."""
    width = _half_width(elastic, place, elastic.nominal_load)
    pinion = contact_depth(elastic.pinion.outline, place)
    gear = contact_depth(elastic.gear.outline, elastic.circles.tangent - place)
    return float((width / np.minimum(pinion, gear)).max())


def _foot_motion(gear: ElasticGear, pitches: int, length: FloatArray, length_ahead: FloatArray) -> FloatArray:
    """Motion of the flank so many pitches further by a unit load on a flank, times face width [m^2/N].

    ``length`` and ``length_ahead`` are lengths on the base tangent; the reciprocal motion is the same.
    """
    tooth = gear.outline
    base = tooth.base_radius / tooth.root_radius
    angle = tooth.root_half_angle
    loads = foot_forces(load_angle(tooth, length), base, angle)
    ahead = foot_forces(load_angle(tooth, length_ahead), base, angle)
    motions = foot_motions(gear.body, angle, 2.0 * math.pi * pitches / tooth.teeth)
    return np.asarray(np.einsum("ik,ij,jk->k", ahead, motions, loads) / gear.plane.modulus)


def _energy_stiffness(elastic: ElasticPair, place: FloatArray, load: float) -> FloatArray:
    """Stiffness by the energy method, without ramps [N/m]."""
    model = elastic.pair.mesh.stiffness
    assert model.model == "energy"
    stiffness = 1.0 / _energy_compliance(elastic, place, load, linear=model.hertz == "linear")
    if model.scale == "none":
        return stiffness
    nodes, weights = np.polynomial.legendre.leggauss(_MEAN_POINTS)
    start = elastic.circles.start
    end = elastic.circles.end
    along = 0.5 * (start + end) + 0.5 * (end - start) * nodes
    curve = 1.0 / _energy_compliance(elastic, along, load, linear=model.hertz == "linear")
    mean = 0.5 * float(weights @ curve) * elastic.contact_ratio
    return stiffness * (mean_stiffness(elastic.pair, elastic.contact_ratio) / mean)


def _energy_compliance(elastic: ElasticPair, place: FloatArray, load: float, *, linear: bool) -> FloatArray:
    """Contact, beams and published body of both gears [m/N]; ``linear``: the linearised contact."""
    total = np.zeros(place.shape)
    for gear, length in _both(elastic, place):
        tooth = gear.outline
        angle = load_angle(tooth, length)
        base = tooth.base_radius / tooth.root_radius
        body = published_deflection(tooth.root_half_angle, PUBLISHED_RING, base / np.cos(angle) - 1.0, angle)
        body = body - ring_twist(PUBLISHED_RING, gear.material.poisson, base)
        total += beam_compliance(tooth, gear.material, length) + body / gear.material.modulus
    total += _contact(elastic, place, load) if not linear else linear_contact(elastic.materials)
    return total / elastic.face_width


def _plane_compliance(elastic: ElasticPair, place: FloatArray, load: float) -> FloatArray:
    """Contact, beams and ring of both gears: the sum beside plane finite elements [m/N]."""
    total = _contact(elastic, place, load)
    for gear, length in _both(elastic, place):
        total += beam_compliance(gear.outline, gear.plane, length) + _foot_motion(gear, 0, length, length)
    return total / elastic.face_width


def _contact(elastic: ElasticPair, place: FloatArray, load: float) -> FloatArray:
    """Shortening of both teeth by the contact, over the load, times face width [m^2/N]."""
    width = _half_width(elastic, place, load)
    total = np.zeros(place.shape)
    for gear, length in _both(elastic, place):
        total += shortening(width, contact_depth(gear.outline, length), gear.material)
    return total


def _half_width(elastic: ElasticPair, place: FloatArray, load: float) -> FloatArray:
    """Half width of the contact under a load [N] on one pair [m]."""
    return half_width(load / elastic.face_width, place, elastic.circles.tangent, elastic.materials)


def _both(elastic: ElasticPair, place: FloatArray) -> tuple[tuple[ElasticGear, FloatArray], ...]:
    """Both gears with the length of each place on their base tangents [m]."""
    return (elastic.pinion, place), (elastic.gear, elastic.circles.tangent - place)


def _parabola(elastic: ElasticPair, place: FloatArray) -> FloatArray:
    """Parabola with its peak in the middle of the path, from the file or from ISO 6336-1 [N/m]."""
    model = elastic.pair.mesh.stiffness
    assert model.model == "parabolic"
    start = elastic.circles.start
    end = elastic.circles.end
    peak = single_stiffness(elastic.pair) if model.peak is None else model.peak
    if model.end_ratio is None:
        # The mean of a parabola is a third of the ends and two thirds of the peak.
        single = mean_stiffness(elastic.pair, elastic.contact_ratio) / single_stiffness(elastic.pair)
        end_ratio = 3.0 * single / elastic.contact_ratio - 2.0
    else:
        end_ratio = model.end_ratio
    from_middle = (2.0 * place - start - end) / (end - start)
    return np.asarray(peak * (1.0 - (1.0 - end_ratio) * from_middle**2), dtype=np.float64)


def _table_stiffness(elastic: ElasticPair, place: FloatArray, load: float) -> FloatArray:
    """Stiffness of one pair at the points of a table, without ramps [N/m].

    A pair of a table of the whole mesh has the share that its stiffness by the energy method has in the sum
    over all pairs in contact; ramps act on the shares.
    """
    table = elastic.table
    assert table is not None
    if not table.whole_mesh:
        return table.stiffness
    model = elastic.pair.mesh.stiffness
    assert model.model == "table"
    drawn = elastic.circles
    total = np.zeros(place.shape)
    for pitches in range(-math.ceil(elastic.contact_ratio), math.ceil(elastic.contact_ratio) + 1):
        neighbour = place + pitches * drawn.pitch
        touching = (neighbour >= drawn.start) & (neighbour <= drawn.end)
        inside = np.clip(neighbour, drawn.start, drawn.end)
        share = _ramp(elastic, inside, model.ramp_length)
        share = share / _energy_compliance(elastic, inside, load, linear=False)
        total += np.where(touching, share, 0.0)
    single = 1.0 / _energy_compliance(elastic, place, load, linear=False)
    return np.asarray(table.stiffness * single / total, dtype=np.float64)


def _ramp(elastic: ElasticPair, place: FloatArray, length: float) -> FloatArray:
    """Factor over which a pair takes up its stiffness at both ends: the square of s^2 (3 - 2 s)."""
    if length == 0.0:
        return np.ones(place.shape)
    nearest = np.minimum(place - elastic.circles.start, elastic.circles.end - place)
    share = np.clip(nearest / length, 0.0, 1.0)
    return np.asarray((share * share * (3.0 - 2.0 * share)) ** 2, dtype=np.float64)
