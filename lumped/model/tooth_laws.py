"""Tables of the contact over a mesh cycle: what each place of a tooth pair has, for every kind of pair.

A step of the integration has nodes, its ends among them as limits from inside. All laws of a tooth pair
repeat with every cycle, except for numbers that its own teeth bring: a constant error, the amounts of a
profile slope and of more tip relief, and its kind, which is that of its faults.

Sources: docs/theory/teeth.md, "Tables".
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from lumped.faults.base import ToothFault
from lumped.mesh.element import FLANKS, QUICK, ContactLaw, Records
from lumped.mesh.motion import RIPPLE
from lumped.mesh.statics import end_gaps
from lumped.mesh.tables import LAWS, TOOTH, TURNING, MeshTables
from lumped.path_of_contact import friction_path_function
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements, at_rest
from lumped.quasi_static.load_sharing import coupled
from lumped.quasi_static.loaded import StaticMesh, loaded_contact
from lumped.quasi_static.tooth_error import flank_relief, relief_starts
from lumped.schema.bodies import bodies_of
from lumped.schema.meeting_teeth import first_teeth, period_of
from lumped.schema.pair import GearPair
from lumped.schema.tooth_errors import ToothErrors, tooth_errors
from lumped.schema.torque_ripples import ripples
from lumped.typing import FloatArray, IntArray

#: Nodes at the ends of a step lie this fraction of a cycle inside it, and phases closer than this are one.
_INSIDE = 1e-11
#: Share of the gap of a tip's corner that is left when the line of action is longer or shorter.
_LEAST_GAP = 0.8
#: Way over the base pitch of corners that no deflection brings into the path of contact.
_CORNERS_OUT = 0.1
#: Way over the base pitch by which slopes are taken: rounding of gaps leaves 1e-10 of a slope of a relief.
_DIFFERENCE = 2e-6
_NO_PHASES = np.empty(0)


class ToothLaws:
    """Laws of tooth pairs over xi, of each kind, for tables; ``every`` end of a polynomial is a switch."""

    def __init__(self, pair: GearPair, every: bool = False) -> None:
        self.pair = pair
        self.healthy = pair.healthy
        self.every = every
        g = self.geometry = pair.geometry
        self.flanks = (pair.flank(0), pair.flank(1))
        self.mesh = StaticMesh(self.healthy)
        self.loaded = contact_of(pair).name == "loaded"
        self.elements: MeshElements | None = None
        touched = (g.L_XA, g.L_XD)
        if self.loaded:  # friction also of tip corners beyond A and D, as far as like teeth touch there
            touched = loaded_contact(at_rest(pair)).stiffness.interval
        else:
            self.elements = contact_of(pair).elements(self.healthy)
        self.friction = friction_path_function(self.healthy, interval=touched)
        self.kinds, self.faults = self._kinds()
        reach = 0.4 if self.loaded else 0.0  # as of the loaded contact of like teeth
        self.low, self.high = g.L_XA - reach * g.base_pitch, g.L_XD + reach * g.base_pitch

    def _kinds(self) -> tuple[IntArray, list[tuple[tuple[ToothFault, ...], ...]]]:
        """Kind of each pair of teeth, and the faults of pinion and gear of each kind."""
        of_teeth: list[list[tuple[ToothFault, ...]]] = []
        for gear in (self.pair.pinion, self.pair.gear):
            every: list[list[ToothFault]] = [[] for _ in range(gear.teeth)]
            for fault in gear.faults:
                every[fault.tooth - 1].append(fault)
            of_teeth.append([tuple(one) for one in every])
        found: dict[tuple[tuple[ToothFault, ...], ...], int] = {((), ()): 0}
        kinds = np.zeros((len(of_teeth[0]), len(of_teeth[1])), dtype=np.int64)
        for i, of_pinion in enumerate(of_teeth[0]):
            for j, of_gear in enumerate(of_teeth[1]):
                if of_pinion or of_gear:
                    kinds[i, j] = found.setdefault((of_pinion, of_gear), len(found))
        return kinds, list(found)

    def lengths(self, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lengths on the base tangents of pinion and gear [m]."""
        return xi, self.geometry.L_XY - xi

    def switches(self) -> FloatArray:
        """Positions at which a law of any kind jumps or has a kink [m]."""
        g = self.geometry
        found = [g.L_XA, g.L_XD, g.L_XP, self.low, self.high]
        if (e := self.elements) is None:
            laws = [self.friction, self.mesh.stiffness.law, *self.mesh.neighbours]
            found += [*relief_starts(self.healthy)]
        else:
            laws = [self.friction, e.stiffness, e.damping, e.error]
            found += [end for law in laws[1:] for end in law.interval]
        found += [place for law in laws for place in (law.breaks[1:-1] if self.every else law.switches)]
        for of_gears in self.faults:
            for which, faults in enumerate(of_gears):
                for fault in faults:
                    for place in fault.kinks(self.flanks[which]):
                        found.append(place if which == 0 else g.L_XY - place)
        for which, starts in enumerate(self._relief_starts()):
            found += [start if which == 0 else g.L_XY - start for start in starts]
        return np.asarray(found, dtype=np.float64)

    def _relief_starts(self) -> list[list[float]]:
        """Lengths on the base tangent of each gear at which a tip relief that acts starts [m]."""
        found: list[list[float]] = []
        for gear, flank in zip((self.pair.pinion, self.pair.gear), self.flanks, strict=True):
            relief = gear.tip_relief
            own = gear.deviations is not None and gear.deviations.tip_relief is not None
            if relief is None or not (own or self.pair.mesh.relief == "static"):
                found.append([])
            else:
                found.append([flank.length(relief.start_roll_angle)])
        return found

    def of_kind(self, kind: int, xi: FloatArray) -> Records:
        """LAWS of a kind at positions of any shape."""
        g = self.geometry
        inside = (xi >= self.low) & (xi <= self.high)
        if self.elements is None:
            k = np.where(inside, self.mesh.stiffness.extended(xi), 0.0)
            gap = self.mesh.relief(xi)
            c = self._dampers(k)
        else:
            k = self.elements.stiffness(xi)
            c = self.elements.damping(xi)
            gap = self.elements.error(xi)
        held = np.clip(xi, g.L_XA, g.L_XD)
        more = np.zeros(xi.shape)
        for which, length in enumerate(self.lengths(held)):
            for fault in self.faults[kind][which]:
                more = more + fault.compliance(self.flanks[which], length)
                gap = gap + fault.gap(self.flanks[which], length)
        if more.any():
            whole = k
            k = k / (1.0 + more * k)
            c = c * np.sqrt(k / np.where(whole > 0.0, whole, 1.0))
        first, last = self.friction.interval
        near = _INSIDE * g.base_pitch
        found = np.zeros(xi.shape, LAWS)
        found["stiffness"] = k
        found["damping"] = c
        found["gap"] = gap
        found["friction"] = self.friction(np.clip(xi, first + near, last - near))
        return found

    def _dampers(self, k: FloatArray) -> FloatArray:
        ratio = self.pair.mesh.damping_ratio
        mass = bodies_of(self.pair).effective_mass
        return np.asarray(2.0 * ratio * np.sqrt(k * mass), dtype=np.float64)

    def shapes(self, xi: FloatArray) -> Records:
        """TOOTH (..., 2) of pinion and gear: gap per unit of each number of their teeth."""
        g = self.geometry
        found = np.zeros((*xi.shape, 2), TOOTH)
        pitch = (g.L_XP, g.L_XY - g.L_XP)
        for which, length in enumerate(self.lengths(np.clip(xi, g.L_XA, g.L_XD))):
            flank = self.flanks[which]
            gear = (self.pair.pinion, self.pair.gear)[which]
            found["error"][..., which] = 1.0
            # Material at the tip, none at the pitch point, where the index is taken.
            found["slope"][..., which] = -(length - pitch[which]) / (flank.tip - flank.start)
            if gear.tip_relief is not None:
                unit = gear.tip_relief.model_copy(update={"amount": 1.0})
                radius = flank.wheel.tooth.base_radius
                found["relief"][..., which] = flank_relief(unit, flank.tip / radius, length / radius)
        return found

    def ends(self, kind: int) -> tuple[float, ...]:
        """FLANKS of a kind.

        With a stiffness of the whole mesh pairs touch from A to D, deflected or not: corners are further out.
        """
        g = self.geometry
        out = _CORNERS_OUT * g.base_pitch if self.pair.mesh.stiffness.whole_mesh else 0.0
        tips = [
            min([fault.end(flank) for fault in faults], default=flank.tip + out)
            for flank, faults in zip(self.flanks, self.faults[kind], strict=True)
        ]
        beyond = np.linspace(0.0, self.high - self.low, 65)[1:]
        radii = (g.base_radius_pinion, g.base_radius_gear)
        no_edge = -beyond, 0.0, g.L_XY  # an edge only adds to the gap
        before = end_gaps(beyond, tips[1], *no_edge, *radii) / beyond**2
        behind = end_gaps(beyond, tips[0], *no_edge, *radii[::-1]) / beyond**2
        least = _LEAST_GAP * before.min(), _LEAST_GAP * behind.min()
        return g.L_XY - tips[1], tips[0], g.L_XY, g.undercut_pinion, g.undercut_gear, *least

    def contact_law(self) -> ContactLaw:
        """Law of the contact for motions."""
        neighbours = self.loaded and len(self.mesh.neighbours) > 0
        return self.mesh.law._replace(converged=QUICK, coupled=neighbours, windows=not self.loaded)

    def turning(self) -> Records:
        """TURNING of both gears, then of each ripple of a torque; nothing swings yet."""
        first = first_teeth(self.pair)
        rows: list[tuple[float, ...]] = []
        for which, one in enumerate(tooth_errors(self.pair)):
            z = one.error.size
            rows.append((which, one.eccentricity, one.phase + 2.0 * np.pi * first[which] / z, z, 0.0))
        for ripple in torque_ripples(self.pair):
            start = ripple["start"] - 0.5 * np.pi
            cycles = 2.0 * np.pi / ripple["angle"]
            rows.append((ripple["shaft"], ripple["amplitude"], start, cycles, 0.0))
        return np.array(rows, TURNING)


def torque_ripples(pair: GearPair) -> Records:
    """RIPPLE of each harmonic of the torques."""
    return np.array([tuple(row) for row in ripples(pair)], RIPPLE)


def _of_teeth(teeth: ToothErrors) -> Records:
    """TOOTH of each tooth of a gear."""
    found = np.zeros(teeth.error.size, TOOTH)
    found["error"] = teeth.error
    found["slope"] = teeth.slope
    found["relief"] = teeth.relief
    return found


def mesh_tables(
    laws: ToothLaws,
    largest_step: float,
    outputs: int,
    nodes: FloatArray | tuple[float, ...] = (0.0,),
    ends: FloatArray = _NO_PHASES,
) -> MeshTables:
    """Tables on steps that end at outputs and wherever a law jumps or has a kink.

    Parameters
    ----------
    laws : of the pair
    largest_step : in mesh cycles
    outputs : evenly spaced in a cycle, the first at its start
    nodes : places in a step, rising from 0 to 1
    ends : further phases at which steps end, in mesh cycles
    """
    g = laws.geometry
    pair = laws.pair
    phases = np.mod((laws.switches() - g.L_XA) / g.base_pitch, 1.0)
    even = np.arange(outputs + 1) / outputs
    marks = np.unique(np.concatenate([even, phases, ends]))
    nearest = even[np.clip(np.round(marks * outputs).astype(np.int64), 0, outputs)]
    marks = np.where(np.abs(marks - nearest) < _INSIDE, nearest, marks)
    marks = marks[np.diff(marks, prepend=-1.0) > _INSIDE]
    parts = np.maximum(1, np.ceil(np.diff(marks) / largest_step - 1e-9)).astype(np.int64)
    pieces = zip(marks, marks[1:], parts, strict=False)
    edges = np.concatenate([*(low + (high - low) * np.arange(n) / n for low, high, n in pieces), [1.0]])
    starts = np.zeros(edges.size - 1, dtype=np.int64)
    starts[np.searchsorted(edges, even[:-1] - _INSIDE)] = 1
    low, high = edges[:-1], edges[1:]
    at = np.asarray(nodes, dtype=np.float64)
    moments = 1.0 / np.arange(1.0, at.size + 1.0)
    weights = np.asarray(np.linalg.solve(np.vander(at, increasing=True).T, moments), dtype=np.float64)
    tau = np.clip(low[:, None] + (high - low)[:, None] * at, low[:, None] + _INSIDE, high[:, None] - _INSIDE)
    ahead = np.arange(
        int(np.ceil((laws.high - g.L_XA) / g.base_pitch)) - 1,
        int(np.floor((laws.low - g.L_XA) / g.base_pitch)) - 1,
        -1,
    )
    place = np.asarray(g.L_XA + (tau[..., None] + ahead) * g.base_pitch, dtype=np.float64)
    way = _DIFFERENCE * g.base_pitch
    # At the ends of a step from inside, both by formulas of second order.
    one_sided = np.array([-1.5, 2.0, -0.5]) / way
    inner = np.array([-0.5, 0.0, 0.5]) / way
    sense = np.where(at < 1.0, 1.0, -1.0)
    inside = (at > 0.0) & (at < 1.0)
    offsets = np.where(inside, -way, 0.0) + np.multiply.outer([0.0, way, 2.0 * way], sense)
    weights_of = np.where(inside, inner[:, None], one_sided[:, None] * sense)

    def slope(function: Callable[[FloatArray], Records]) -> Records:
        """Of every field over xi, one-sided at the ends of a step."""
        values = [function(place + offset[:, None]) for offset in offsets]
        found = np.zeros(values[0].shape, values[0].dtype)
        shape = (1, at.size, 1) + (1,) * (found.ndim - 3)
        for name in found.dtype.names or ():
            found[name] = sum(w.reshape(shape) * one[name] for w, one in zip(weights_of, values, strict=True))
        return found

    kinds = range(len(laws.faults))
    slopes = np.stack([slope(partial(laws.of_kind, kind)) for kind in kinds])
    if not laws.loaded:  # fixed windows stay at their places
        slopes["stiffness"] = slopes["damping"] = slopes["friction"] = 0.0
    near = (place >= laws.low) & (place <= laws.high)
    neighbours = laws.mesh.neighbours if laws.loaded else ()
    flat = place.reshape(-1, ahead.size)[:, ::-1], near.reshape(-1, ahead.size)[:, ::-1]
    coupling = np.zeros((edges.size - 1, at.size, ahead.size, ahead.size))
    if neighbours:
        found = coupled(neighbours, *flat)[:, ::-1, ::-1]
        coupling = np.ascontiguousarray(found.reshape(edges.size - 1, at.size, ahead.size, ahead.size))
    turning = laws.turning()
    turn = 2.0 * np.pi / turning["cycles"] * tau[..., None]
    pinion, gear = tooth_errors(pair)
    return MeshTables(
        edges=edges,
        nodes=at,
        weights=weights,
        outputs=starts,
        ahead=ahead,
        position=place,
        laws=np.stack([laws.of_kind(kind, place) for kind in kinds]),
        slopes=slopes,
        shape=laws.shapes(place),
        shape_slope=slope(laws.shapes),
        flanks=np.array([laws.ends(kind) for kind in kinds], FLANKS),
        coupling=coupling,
        kinds=laws.kinds,
        pinion=_of_teeth(pinion),
        gear=_of_teeth(gear),
        turning=turning,
        turned=np.stack([np.cos(turn), np.sin(turn)], axis=-1),
        cotangent=1.0 / np.tan(g.operating_pressure_angle),
        first=np.array(first_teeth(pair), dtype=np.int64),
        period=period_of(pair),
        duration=g.mesh_period,
        lengthening=laws.mesh.lengthening,
        law=laws.contact_law(),
    )
