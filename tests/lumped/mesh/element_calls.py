"""The element of the mesh by itself, for tests: compiled calls, and a mesh of plain numbers."""

from __future__ import annotations

import numpy as np

from lumped.compiler import compiled
from lumped.mesh import element, linear, tables, tip_corners, unilateral_force
from lumped.mesh.records import CONTACT, EXACT, FLANKS, FORCE, LINE, PAIR, ContactLaw


@compiled
def place(position, flanks, line, law, pairs):
    """Put every pair at its position (pairs,)."""
    for i in range(pairs.size):
        tip_corners.place_pair(pairs[i], position[i], flanks[0], line[0], law)


@compiled
def corner_at(beyond, tip, length, flank_radius, tip_radius):
    """Gap of a tip corner, its slope and its tilt."""
    return tip_corners.corner_gap(beyond, tip, length, flank_radius, tip_radius)


@compiled
def line_at(step, node, mesh_tables, starts, line):
    """Gap of all pairs by eccentric gears and swing at a node; writes the line of action."""
    return tables.turn_line(step, node, mesh_tables, starts, line[0])


@compiled
def loads_at(approach, pairs, line, law, coupling, contacts):
    """Gaps and elastic loads at an approach."""
    matrix = np.empty((pairs.size, pairs.size))
    element.write_elastic_loads(approach, pairs, line[0], law, coupling, matrix, contacts)


@compiled
def force_at(approach, approach_rate, pairs, line, law, coupling, contacts, normal):
    """Force of the mesh at an approach and its rate."""
    matrix = np.empty((pairs.size, pairs.size))
    element.write_elastic_loads(approach, pairs, line[0], law, coupling, matrix, contacts)
    return unilateral_force.unilateral_force(approach_rate, pairs, line[0], law, contacts, normal)


@compiled
def static_at(guess, tolerance, pairs, line, law, coupling, contacts):
    """Static approach."""
    matrix = np.empty((pairs.size, pairs.size))
    numbers = guess, tolerance, law.force
    return element.static_approach(*numbers, pairs, line[0], law, coupling, matrix, contacts)


@compiled
def linear_about(static, pairs, line, law, contacts, forces, states, loads):
    """The linear form about a static approach whose contacts are known."""
    linear.linearise(static, pairs, line[0], law, contacts, forces, states[0], loads)


class Mesh:
    """Pairs of given numbers on a line of action of their own, and what the element makes of them.

    ``position`` (pairs,) xi [m]; other keywords set fields of PAIR, of LINE and of ContactLaw by name.
    """

    LAW = ContactLaw(
        force=3000.0, softening=0.0, linear_below=3.0, converged=EXACT, full_damper=200.0, coupled=False,
        apart_below=0.0, prescribed=False, radius_pinion=0.040, radius_gear=0.075, rolling_speed=6.0,
    )  # fmt: skip
    LENGTH = 0.0420  # [m] of the line between the base circles
    ENDS = (0.0080, 0.0235, LENGTH, 0.0, 0.0, 0.0, 0.0)  # FLANKS [m]

    def __init__(self, position, coupling=None, **numbers):
        unknown = numbers.keys() - {*self.LAW._fields, *LINE.names, *PAIR.names}
        assert not unknown, unknown
        position = np.atleast_1d(np.asarray(position, dtype=float))
        self.law = self.LAW._replace(**{name: numbers[name] for name in self.LAW._fields if name in numbers})
        self.line = np.zeros(1, LINE)
        self.pairs = np.zeros(position.size, PAIR)
        self.line["length"] = self.LENGTH
        self.pairs["stiffness"] = 3e8
        for name in LINE.names:
            self.line[name] = numbers.get(name, self.line[name])
        self.line["length"] += self.line["lengthening"]
        place(position, np.array([self.ENDS], FLANKS), self.line, self.law, self.pairs)
        for name in PAIR.names:
            self.pairs[name] = numbers.get(name, self.pairs[name])
        self.coupling = np.zeros((position.size,) * 2) if coupling is None else np.asarray(coupling)
        self.contacts = np.zeros(position.size, CONTACT)
        self.normal = np.zeros(position.size)

    def loads(self, approach):
        """Elastic loads (pairs,) [N]; ``contacts`` are those then."""
        loads_at(approach, self.pairs, self.line, self.law, self.coupling, self.contacts)
        return self.contacts["load"].copy()

    def force(self, approach, approach_rate):
        """MeshForce; ``normal`` are the loads then."""
        arguments = self.pairs, self.line, self.law, self.coupling, self.contacts, self.normal
        return force_at(approach, approach_rate, *arguments)

    def static(self):
        """Static approach [m]."""
        arguments = self.pairs, self.line, self.law, self.coupling, self.contacts
        return static_at(0.0, 1e-13, *arguments)

    def linear(self):
        """FORCE (3,), STATE and PAIR_LOAD (pairs,) about the static approach."""
        static = self.static()
        forces = np.zeros(3, FORCE)
        states = np.zeros(1, linear.STATE)
        loads = np.zeros(self.pairs.size, linear.PAIR_LOAD)
        linear_about(static, self.pairs, self.line, self.law, self.contacts, forces, states, loads)
        return forces, states[0], loads
