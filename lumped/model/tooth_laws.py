"""Laws of tooth pairs over the path of contact, and their tables over a mesh cycle, for every kind of pair.

A step of the integration has nodes. At the ends of a step the tables have limits from inside the step. All
laws of a tooth pair repeat with every mesh cycle. Only the two teeth of a pair differ: by a constant gap, by
the amounts of a profile slope and of additional tip relief, and by their faults, which are the kind of the
pair.

Sources: docs/theory/teeth.md, "Tables".
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache, partial
from typing import NamedTuple, Self

import numpy as np

from lumped.faults.base import ToothFault
from lumped.mesh.damper import damping_coefficient, rescaled_damping
from lumped.mesh.motion import RIPPLE
from lumped.mesh.records import FLANKS, QUICK, ContactLaw, Records
from lumped.mesh.statics import flank_end_gaps
from lumped.mesh.tables import LAWS, TOOTH, TURNING, MeshTables
from lumped.mesh.unloaded import RELIEF, couplings, relief_slopes, reliefs_at
from lumped.path_of_contact import friction_path_function
from lumped.quasi_static.contacts import contact_of
from lumped.quasi_static.elements import MeshElements, at_rest
from lumped.quasi_static.loaded import Touching, static_mesh, touching
from lumped.quasi_static.tooth_error import relief_record, relief_starts
from lumped.schema.bodies import bodies_of
from lumped.schema.meeting_teeth import first_teeth, period_of
from lumped.schema.pair import GearPair
from lumped.schema.tooth_errors import ToothErrors, tooth_errors
from lumped.schema.torque_ripples import ripples
from lumped.typing import FloatArray, IntArray

#: Distance in mesh cycles of the nodes at the ends of a step from these ends; closer phases count as one.
_INSIDE = 1e-11
#: Share of the gap of a tip corner that remains at least when the line of action gets longer or shorter.
_LEAST_GAP = 0.8
#: Distance over the base pitch at which no deflection brings a tip corner into contact.
_CORNERS_OUT = 0.1
#: Distance over the base pitch of the differences for slopes: rounding then leaves 1e-10 of the slope of a
#: relief.
_DIFFERENCE = 2e-6
_NO_PHASES = np.empty(0)


class ToothLaws:
    """Laws of tooth pairs over xi, for each kind of pair.

    With ``every``, all breaks of the laws count as switches.
    """

    def __init__(self, pair: GearPair, every: bool = False) -> None:
        self.pair = pair
        self.healthy = pair.healthy
        self.every = every
        g = self.geometry = pair.geometry
        self.flanks = (pair.flank(0), pair.flank(1))
        rest = at_rest(pair)
        self.mesh = static_mesh(rest)
        self.loaded = contact_of(pair).name == "loaded"
        self.elements: MeshElements | None = None
        self.touching: Touching | None = None
        touched = (g.L_XA, g.L_XD)
        if self.loaded:  # friction also of tip corners beyond A and D, as far as like teeth touch there
            self.touching = touching(rest)
            touched = self.touching.interval
        else:
            self.elements = contact_of(pair).elements(self.healthy)
        self.friction = friction_path_function(self.healthy, interval=touched)
        self.kinds, self.faults = self._kinds()
        reach = 0.4 if self.loaded else 0.0  # as of the loaded contact of like teeth
        self.low = g.L_XA - reach * g.base_pitch
        self.high = g.L_XD + reach * g.base_pitch

    def _kinds(self) -> tuple[IntArray, list[tuple[tuple[ToothFault, ...], ...]]]:
        """Return the kind of each pair of teeth (z1, z2), and the faults of pinion and gear of each kind."""
        of_teeth: list[list[tuple[ToothFault, ...]]] = []
        for gear in (self.pair.pinion, self.pair.gear):
            every: list[list[ToothFault]] = [[] for _ in range(gear.teeth)]
            for fault in gear.faults:
                every[fault.tooth - 1].append(fault)
            of_teeth.append([tuple(one) for one in every])
        kind_of_faults: dict[tuple[tuple[ToothFault, ...], ...], int] = {((), ()): 0}
        kinds = np.zeros((len(of_teeth[0]), len(of_teeth[1])), dtype=np.int64)
        for i, of_pinion in enumerate(of_teeth[0]):
            for j, of_gear in enumerate(of_teeth[1]):
                if of_pinion or of_gear:
                    kinds[i, j] = kind_of_faults.setdefault((of_pinion, of_gear), len(kind_of_faults))
        return kinds, list(kind_of_faults)

    def lengths(self, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lengths on the base tangents of pinion and gear at positions xi [m]."""
        return xi, self.geometry.L_XY - xi

    @cached_property
    def switches(self) -> FloatArray:
        """Positions at which a law of any kind jumps or has a kink [m]."""
        g = self.geometry
        places = [g.L_XA, g.L_XD, g.L_XP, self.low, self.high]
        if (e := self.elements) is None:
            laws = [self.friction, self.mesh.stiffness.law, *self.mesh.neighbours]
            places += [*relief_starts(self.healthy)]
        else:
            laws = [self.friction, e.stiffness, e.damping, e.error]
            places += [end for law in laws[1:] for end in law.interval]
        places += [place for law in laws for place in (law.breaks[1:-1] if self.every else law.switches)]
        for of_gears in self.faults:
            for gear, faults in enumerate(of_gears):
                for fault in faults:
                    for place in fault.kinks(self.flanks[gear]):
                        places.append(place if gear == 0 else g.L_XY - place)
        for gear, starts in enumerate(self._relief_starts()):
            places += [start if gear == 0 else g.L_XY - start for start in starts]
        return np.asarray(places, dtype=np.float64)

    def _relief_starts(self) -> list[list[float]]:
        """Lengths on the base tangent of each gear at which a tip relief that acts starts [m]."""
        starts: list[list[float]] = []
        for gear, flank in zip((self.pair.pinion, self.pair.gear), self.flanks, strict=True):
            relief = gear.tip_relief
            has_deviation = gear.deviations is not None and gear.deviations.tip_relief is not None
            if relief is None or not (has_deviation or self.pair.mesh.relief == "static"):
                starts.append([])
            else:
                starts.append([flank.length(relief.start_roll_angle)])
        return starts

    def gap_of_like_teeth(self, xi: FloatArray) -> FloatArray:
        """Return the gap of like teeth at positions xi of any shape, without tip corners [m]."""
        if self.elements is not None:
            return self.elements.error(xi)
        reliefs = self.mesh.unloaded.reliefs
        if reliefs.size == 0:
            return np.zeros(xi.shape)
        on_flanks = np.clip(xi, self.geometry.L_XA, self.geometry.L_XD)
        return np.asarray(reliefs_at(reliefs, on_flanks.ravel()).reshape(xi.shape), dtype=np.float64)

    def of_kind(self, kind: int, xi: FloatArray) -> Records:
        """Return LAWS of a kind at positions xi of any shape [m]."""
        g = self.geometry
        if self.elements is None:
            single = self.mesh.single_pairs(xi.ravel())
            k = single.stiffness.reshape(xi.shape)
            gap = single.gap.reshape(xi.shape)
            mass = bodies_of(self.pair).effective_mass
            c = damping_coefficient(self.pair.mesh.damping_ratio, k, mass)
        else:
            k = self.elements.stiffness(xi)
            c = self.elements.damping(xi)
            gap = self.elements.error(xi)
        on_flanks = np.clip(xi, g.L_XA, g.L_XD)
        compliance = np.zeros(xi.shape)
        for gear, length in enumerate(self.lengths(on_flanks)):
            for fault in self.faults[kind][gear]:
                compliance = compliance + fault.compliance(self.flanks[gear], length)
                gap = gap + fault.gap(self.flanks[gear], length)
        if compliance.any():
            healthy_stiffness = k
            k = k / (1.0 + compliance * k)
            c = rescaled_damping(c, k, healthy_stiffness)
        first, last = self.friction.interval
        near = _INSIDE * g.base_pitch
        laws = np.zeros(xi.shape, LAWS)
        laws["stiffness"] = k
        laws["damping"] = c
        laws["gap"] = gap
        laws["mu"] = self.friction(np.clip(xi, first + near, last - near))
        return laws

    def shapes(self, xi: FloatArray) -> Records:
        """Return TOOTH (..., 2): gap at positions xi per unit of each number of both teeth."""
        g = self.geometry
        shapes = np.zeros((*xi.shape, 2), TOOTH)
        pitch = (g.L_XP, g.L_XY - g.L_XP)
        for index, length in enumerate(self.lengths(np.clip(xi, g.L_XA, g.L_XD))):
            flank = self.flanks[index]
            gear = (self.pair.pinion, self.pair.gear)[index]
            shapes["gap"][..., index] = 1.0
            # Material at the tip, none at the pitch point, at which the pitch is measured.
            shapes["slope"][..., index] = -(length - pitch[index]) / (flank.tip - flank.start)
            if gear.tip_relief is not None:
                unit = gear.tip_relief.model_copy(update={"amount": 1.0})
                radius = flank.wheel.tooth.base_radius
                relief = np.array([relief_record(unit, flank.tip, radius)], RELIEF)
                shapes["relief"][..., index] = reliefs_at(relief, length.ravel()).reshape(length.shape)
        return shapes

    @cached_property
    def flank_ends(self) -> Records:
        """FLANKS of each kind."""
        return np.array([self.ends(kind) for kind in range(len(self.faults))], FLANKS)

    def ends(self, kind: int) -> tuple[float, ...]:
        """Return FLANKS of a kind.

        With a stiffness of the whole mesh pairs touch from A to D only: the tip corners are placed further
        out.
        """
        g = self.geometry
        further_out = _CORNERS_OUT * g.base_pitch if self.pair.mesh.stiffness.whole_mesh else 0.0
        tips = [
            min([fault.end(flank) for fault in faults], default=flank.tip + further_out)
            for flank, faults in zip(self.flanks, self.faults[kind], strict=True)
        ]
        beyond = np.linspace(0.0, self.high - self.low, 65)[1:]
        radii = (g.base_radius_pinion, g.base_radius_gear)
        no_edge = -beyond, 0.0, g.L_XY  # an edge only adds to the gap
        before = flank_end_gaps(beyond, tips[1], *no_edge, *radii) / beyond**2
        behind = flank_end_gaps(beyond, tips[0], *no_edge, *radii[::-1]) / beyond**2
        least = _LEAST_GAP * before.min(), _LEAST_GAP * behind.min()
        return g.L_XY - tips[1], tips[0], g.L_XY, g.undercut_pinion, g.undercut_gear, *least

    @cached_property
    def teeth(self) -> tuple[Records, Records]:
        """TOOTH of each tooth of the pinion, and of the gear."""
        pinion, gear = tooth_errors(self.pair)
        return _of_teeth(pinion), _of_teeth(gear)

    def contact_law(self) -> ContactLaw:
        """Return the law of the contact for motions."""
        neighbours = self.loaded and len(self.mesh.neighbours) > 0
        g = self.geometry
        return self.mesh.law._replace(
            converged=QUICK,
            coupled=neighbours,
            prescribed=not self.loaded,
            rolling_speed=g.omega_pinion * g.base_radius_pinion,
        )

    def turning(self) -> Records:
        """Return TURNING of both gears, then of each ripple of a torque; the swing is still 0."""
        first = first_teeth(self.pair)
        rows: list[tuple[float, ...]] = []
        for shaft, teeth in enumerate(tooth_errors(self.pair)):
            z = teeth.error.size
            rows.append((shaft, teeth.eccentricity, teeth.phase + 2.0 * np.pi * first[shaft] / z, z, 0.0))
        for ripple in torque_ripples(self.pair):
            start = ripple["start"] - 0.5 * np.pi
            cycles = 2.0 * np.pi / ripple["angle"]
            rows.append((ripple["shaft"], ripple["amplitude"], start, cycles, 0.0))
        return np.array(rows, TURNING)


def torque_ripples(pair: GearPair) -> Records:
    """Return RIPPLE of each harmonic of the torques."""
    return np.array([tuple(row) for row in ripples(pair)], RIPPLE)


def _of_teeth(teeth: ToothErrors) -> Records:
    """Return TOOTH of each tooth of a gear: the errors of the schema are gaps here."""
    numbers = np.zeros(teeth.error.size, TOOTH)
    numbers["gap"] = teeth.error
    numbers["slope"] = teeth.slope
    numbers["relief"] = teeth.relief
    return numbers


class _Steps(NamedTuple):
    """Steps of a mesh cycle: phases of their ends (steps + 1,).

    1 where an output is at the start (steps,).
    """

    edges: FloatArray
    outputs: IntArray


def _steps(laws: ToothLaws, largest_step: float, outputs: int, ends: FloatArray) -> _Steps:
    """Steps that end at outputs, at further ``ends`` and wherever a law jumps or has a kink."""
    g = laws.geometry
    phases = np.mod((laws.switches - g.L_XA) / g.base_pitch, 1.0)
    even = np.arange(outputs + 1) / outputs
    marks = np.unique(np.concatenate([even, phases, ends]))
    nearest = even[np.clip(np.round(marks * outputs).astype(np.int64), 0, outputs)]
    marks = np.where(np.abs(marks - nearest) < _INSIDE, nearest, marks)
    marks = marks[np.diff(marks, prepend=-1.0) > _INSIDE]
    parts = np.maximum(1, np.ceil(np.diff(marks) / largest_step - 1e-9)).astype(np.int64)
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    inside = np.repeat(np.diff(marks), parts) * number / np.repeat(parts, parts)
    edges = np.append(np.repeat(marks[:-1], parts) + inside, 1.0)
    starts = np.zeros(edges.size - 1, dtype=np.int64)
    starts[np.searchsorted(edges, even[:-1] - _INSIDE)] = 1
    return _Steps(edges, starts)


@lru_cache(maxsize=64)
def _quadrature_weights(places: tuple[float, ...]) -> FloatArray:
    """Weights (nodes,) of the quadrature that is exact for polynomials through the nodes."""
    nodes = np.array(places)
    moments = 1.0 / np.arange(1.0, nodes.size + 1.0)
    return np.asarray(np.linalg.solve(np.vander(nodes, increasing=True).T, moments), dtype=np.float64)


class _Differences(NamedTuple):
    """Differences of second order for slopes at the nodes of steps.

    At the ends of a step they are one-sided, so that they do not look beyond the step.

    Attributes
    ----------
    offsets : (3, nodes) from a node to the positions of a difference [m]
    weights : (3, nodes) of the values there [1/m]
    """

    offsets: FloatArray
    weights: FloatArray

    @classmethod
    def at_nodes(cls, nodes: FloatArray, distance: float) -> Self:
        """Return the differences at nodes, places in a step from 0 to 1, over a distance [m]."""
        one_sided = np.array([-1.5, 2.0, -0.5]) / distance
        central = np.array([-0.5, 0.0, 0.5]) / distance
        sense = np.where(nodes < 1.0, 1.0, -1.0)
        inside = (nodes > 0.0) & (nodes < 1.0)
        offsets = np.where(inside, -distance, 0.0) + np.multiply.outer([0.0, distance, 2.0 * distance], sense)
        return cls(offsets, np.where(inside, central[:, None], one_sided[:, None] * sense))

    def positions(self, position: FloatArray) -> FloatArray:
        """Return the positions (3, steps, nodes, pairs) of the differences at (steps, nodes, pairs) [m]."""
        return np.asarray(position + self.offsets[:, None, :, None], dtype=np.float64)

    def slope(self, values: FloatArray) -> FloatArray:
        """Return the slope (steps, nodes, pairs, ...) of values (3, steps, nodes, pairs, ...) there."""
        shape = (1, self.weights.shape[1], 1) + (1,) * (values.ndim - 4)
        return sum((w.reshape(shape) * one for w, one in zip(self.weights, values, strict=True)), np.zeros(1))


def _slopes(
    function: Callable[[FloatArray], Records], position: FloatArray, differences: _Differences
) -> Records:
    """Slope over xi of every field of a function: positions [m] -> records of the same shape.

    ``position`` (steps, nodes, pairs) [m].
    """
    values = function(differences.positions(position))
    slopes = np.zeros(values.shape[1:], values.dtype)
    for name in slopes.dtype.names or ():
        slopes[name] = differences.slope(values[name])
    return slopes


def _gap_slopes(laws: ToothLaws, position: FloatArray, differences: _Differences) -> Records:
    """Slopes of LAWS (1, steps, nodes, pairs) of like teeth, whose contacts do not swing.

    Nothing reads the slopes of other laws than the gap: these slopes are 0.
    """
    slopes = np.zeros((1, *position.shape), LAWS)
    if laws.elements is not None:
        slopes["gap"] = differences.slope(laws.elements.error(differences.positions(position)))
    elif (reliefs := laws.mesh.unloaded.reliefs).size:
        ends = laws.geometry.L_XA, laws.geometry.L_XD
        slopes["gap"] = relief_slopes(reliefs, *ends, position, differences.offsets, differences.weights)
    return slopes


def _coupling(laws: ToothLaws, position: FloatArray) -> FloatArray:
    """Coupling w_ij (steps, nodes, pairs, pairs) of the pairs at positions (steps, nodes, pairs) [m]."""
    pairs = position.shape[2]
    if not laws.loaded or not laws.mesh.neighbours:
        return np.zeros((*position.shape, pairs))
    near = (position >= laws.low) & (position <= laws.high)
    # ``couplings`` has the pair behind first, the tables the pair ahead.
    places = np.ascontiguousarray(position.reshape(-1, pairs)[:, ::-1])
    computed = np.ascontiguousarray(near.reshape(-1, pairs)[:, ::-1])
    coupling = couplings(laws.mesh.unloaded.neighbours, places, computed)[:, ::-1, ::-1]
    return np.ascontiguousarray(coupling.reshape(*position.shape, pairs))


def mesh_tables(
    laws: ToothLaws,
    largest_step: float,
    outputs: int,
    nodes: FloatArray | tuple[float, ...] = (0.0,),
    ends: FloatArray = _NO_PHASES,
) -> MeshTables:
    """Return the tables of a mesh cycle, on steps that end at outputs and wherever a law jumps or has a kink.

    Parameters
    ----------
    laws : laws of the tooth pairs
    largest_step : in mesh cycles
    outputs : number of outputs in a cycle, evenly spaced, the first at the start of the cycle
    nodes : places in a step, increasing from 0 to 1
    ends : further phases at which steps end, in mesh cycles
    """
    g = laws.geometry
    steps = _steps(laws, largest_step, outputs, ends)
    low = steps.edges[:-1]
    high = steps.edges[1:]
    in_step = np.asarray(nodes, dtype=np.float64)
    phase = low[:, None] + (high - low)[:, None] * in_step
    phase = np.clip(phase, low[:, None] + _INSIDE, high[:, None] - _INSIDE)
    ahead = np.arange(
        int(np.ceil((laws.high - g.L_XA) / g.base_pitch)) - 1,
        int(np.floor((laws.low - g.L_XA) / g.base_pitch)) - 1,
        -1,
    )
    position = np.asarray(g.L_XA + (phase[..., None] + ahead) * g.base_pitch, dtype=np.float64)
    distance = _DIFFERENCE * g.base_pitch
    differences = _Differences.at_nodes(in_step, distance)
    kinds = range(len(laws.faults))
    unlike = laws.pair is not laws.healthy
    if unlike:
        slopes = np.stack([_slopes(partial(laws.of_kind, kind), position, differences) for kind in kinds])
    else:
        slopes = _gap_slopes(laws, position, differences)
    if not laws.loaded:  # fixed windows stay at their places
        slopes["stiffness"] = 0.0
        slopes["damping"] = 0.0
        slopes["mu"] = 0.0
    no_shapes = np.zeros((*position.shape, 2), TOOTH)  # the numbers of like teeth are 0: no shape acts
    turning = laws.turning()
    acts = turning["amplitude"] != 0.0
    angle = 2.0 * np.pi / turning["cycles"][acts] * phase[..., None]
    turned = np.zeros((*phase.shape, turning.size, 2))
    turned[:, :, acts] = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    pinion, gear = laws.teeth
    return MeshTables(
        edges=steps.edges,
        nodes=in_step,
        weights=_quadrature_weights(tuple(in_step.tolist())),
        outputs=steps.outputs,
        ahead=ahead,
        position=position,
        laws=np.concatenate([laws.of_kind(kind, position)[None] for kind in kinds]),
        slopes=slopes,
        shape=laws.shapes(position) if unlike else no_shapes,
        shape_slope=_slopes(laws.shapes, position, differences) if unlike else no_shapes,
        flanks=laws.flank_ends,
        coupling=_coupling(laws, position),
        kinds=laws.kinds,
        pinion=pinion,
        gear=gear,
        turning=turning,
        turned=turned,
        cotangent=1.0 / np.tan(g.operating_pressure_angle),
        first=np.array(first_teeth(laws.pair), dtype=np.int64),
        period=period_of(laws.pair),
        duration=g.mesh_period,
        lengthening=laws.mesh.lengthening,
        law=laws.contact_law(),
        alike=not unlike,
    )
