"""The mesh cycle of like teeth with loaded contact, whose laws are computed where they are read.

``MeshCycle.of`` fits polynomials to all laws, to 1e-11, because charts and margins read them at very many
places. The start of a motion by momentary load reads the laws at some hundred places: there the static state
of each pair is computed directly.

Sources: docs/theory/contact_energy.md, "Loaded contact of the linear model".
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.mesh.damper import damping_law
from lumped.model.mesh_cycle import MeshCycle, PairState
from lumped.model.tooth_laws import ToothLaws
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements
from lumped.quasi_static.loaded import Touching
from lumped.schema.bodies import bodies_of
from lumped.typing import FloatArray

#: The fastest vibration is sought in this many parts of the mesh cycle.
_STRETCHES = 16
#: Distance of the differences for the slope of a relief, over the base pitch.
_DIFFERENCE = 1e-6


class StaticCycle(MeshCycle):
    """The mesh cycle of a pair with loaded contact and like teeth.

    The fitted ``elements`` are made when they are first read.

    Parameters
    ----------
    laws : laws of the tooth pairs of a gear pair with like teeth and loaded contact
    """

    laws: ToothLaws

    def __init__(self, laws: ToothLaws) -> None:
        # The base class is frozen.
        object.__setattr__(self, "geometry", laws.geometry)
        object.__setattr__(self, "laws", laws)

    @cached_property
    def elements(self) -> MeshElements:
        """Element laws of one tooth pair."""
        return contact_of(self.laws.pair).elements(self.laws.pair)

    @property
    def touching(self) -> Touching:
        """Where a pair carries load in the static state."""
        assert self.laws.touching is not None
        return self.laws.touching

    @property
    def start(self) -> float:
        """Position at which a pair first carries load [m]."""
        return self.touching.interval[0]

    @property
    def end(self) -> float:
        """Position at which a pair last carries load [m]."""
        return self.touching.interval[1]

    @property
    def stiffness_scale(self) -> float:
        """Order of magnitude of the stiffness of the mesh, for scaling only [N/m]."""
        return self.laws.mesh.stiffness.largest

    @cached_property
    def switch_times(self) -> FloatArray:
        """Times strictly inside (0, T_m) at which a pair begins or ends contact, or its laws have kinks [s].

        Kinks where a tip corner begins to touch and where the full damper begins to act are left out.
        """
        places = [self.touching.contact.ravel(), self.touching.kinks, self.laws.friction.switches]
        return self._times([np.array([self.geometry.L_XP]), *places])

    @cached_property
    def breaks(self) -> FloatArray:
        """The edges, and times that divide the mesh cycle evenly [s]."""
        return np.union1d(self.edges, np.arange(1, _STRETCHES) * (self.period / _STRETCHES))

    @property
    def bends(self) -> FloatArray:
        """The switch times [s]."""
        return self.switch_times

    def sample(self, time: ArrayLike, segment: int | NDArray[np.int64] | None = None) -> PairState:
        """Return the coefficients of all pairs at times t [s]; arguments as of ``MeshCycle.sample``."""
        position, place, can_touch = self.places(time, segment)
        state = self.laws.mesh.pairs_in_contact(place)
        load, tangent, error, tilt = (
            part.reshape(place.shape) for part in (state.load, state.tangent, state.error, state.tilt)
        )
        carries = can_touch & (load > 0.0)
        closing = 1.0 - state.contact["gap_by_approach"].reshape(place.shape)
        corner_slope = state.contact["gap_by_position"].reshape(place.shape)
        rolling = (corner_slope + self._relief_slope(place)) / closing
        share = state.contact["damper_share"].reshape(place.shape)
        speed = self.geometry.omega_pinion * self.geometry.base_radius_pinion
        return PairState(
            position=position,
            contact=can_touch,
            stiffness=np.where(carries, tangent, 0.0),
            damping=np.where(carries, self._whole_damper(place) * share * closing, 0.0),
            friction=np.where(can_touch, self.laws.friction(place), 0.0),
            error=np.where(carries, error, 0.0),
            error_rate=np.where(carries, rolling * speed, 0.0),
            tilt=np.where(carries, tilt, 0.0),
            closing=np.where(carries, closing, 0.0),
        )

    def _relief_slope(self, place: FloatArray) -> FloatArray:
        """Slope over xi of the gap by reliefs, of pairs at places of any shape [-]."""
        distance = _DIFFERENCE * self.geometry.base_pitch
        behind, ahead = (self.laws.gap_of_like_teeth(place + way) for way in (-distance, distance))
        return np.asarray((ahead - behind) / (2.0 * distance), dtype=np.float64)

    def _whole_damper(self, place: FloatArray) -> FloatArray:
        """Damping coefficient of the full damper of pairs at places of any shape [N s/m]."""
        mass = bodies_of(self.laws.pair).effective_mass
        damping = damping_law(self.laws.pair.mesh.damping_ratio, self.laws.mesh.stiffness_at, mass)
        return np.asarray(damping(place.ravel()).reshape(place.shape), dtype=np.float64)
