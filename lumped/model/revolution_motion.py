"""A periodic motion over a mesh cycle, a revolution or the hunting period, and its labelled result.

Sources: docs/theory/teeth.md, "Motion", "Brake torque".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.labelling import Variable
from lumped.mesh.tables import MeshTables
from lumped.model.linear_or_unilateral import ContactArgument
from lumped.model.mesh_cycle import PairState
from lumped.model.periodic_system import LTVSystem
from lumped.model.propagation import fastest_frequency
from lumped.model.results import (
    MotionValues,
    PlainMotion,
    gear_values,
    labelled,
    pair_values,
    peaks_to_peaks,
)
from lumped.model.steady import SWINGING
from lumped.model.swing import swing
from lumped.quasi_static.contacts import contact_of
from lumped.schema.meeting_teeth import teeth_of_pairs
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    import xarray as xr

#: Most and least outputs in a mesh cycle by default, and about how many outputs a period has by default.
_MOST_SAMPLES = 512
_LEAST_SAMPLES = 32
_ALL_SAMPLES = 65536


class Touch(Enum):
    """How the teeth touch in a motion; the value is how a result says it."""

    TIED = "over the path of contact as prescribed; teeth are tied and may pull (linear)"
    WINDOWS = "over the path of contact as prescribed; teeth may separate"
    MOMENTARY = "where the gap of each tooth pair closes, tip corners included; teeth may separate"
    LINEAR = "linear about the static state of each tooth pair; teeth may pull"

    @property
    def contact(self) -> ContactArgument:
        """The argument ``contact`` that gives this."""
        return "linear" if self in (Touch.TIED, Touch.LINEAR) else "unilateral"


class Origin(Enum):
    """How a motion was found; the value is how a result says it."""

    LINEAR = "near the linear motion"
    SETTLED = "a run settles to it"
    NEIGHBOUR = "followed from a neighbouring torque or speed"


@dataclass(frozen=True, eq=False)
class RevolutionMotion:
    """A periodic motion over ``period`` mesh cycles. A place is a row of all pairs that pass it one by one.

    Attributes
    ----------
    system : the "full" system of the healthy twin
    tables : tables of the contact, with which the motion was integrated
    touch : how the teeth touch
    time : (k,) [s]
    states : (k, n)
    load : (places, k) normal load in each place of ``tables.ahead`` [N]
    pinion_torque, brake_torque : mean torques that balance the moments at the mean speed [N m]
    powers : mean powers "sliding", "tooth_dampers", "bearings", "shafts", and "rolling", the power of the
        gaps that change as the teeth roll [W]; {} where they were not computed
    closure : mismatch of the state after the period, over the largest displacement
    error : difference of the dynamic transmission error to a motion by longer steps, over the largest value.
        The steps are twice as long for like teeth and linear motions, four times for other unilateral motions
    spectral_radius : largest modulus of the multipliers of the motion; where teeth differ, of the twin with
        like teeth
    origin : how a motion with unilateral contact was found
    first : mesh cycle at the first time
    stiffness : (k,) stiffness of the mesh in the linear form [N/m]; None: the sum over pairs that carry load
    between : part of the peak to peak of each variable that the outputs miss, with like teeth [m]
    resolved_peak_to_peak : name -> peak to peak from outputs that resolve the fastest vibration [m]. Empty:
        the outputs of the motion itself are the closest
    """

    pair: GearPair
    system: LTVSystem
    tables: MeshTables
    touch: Touch
    time: FloatArray
    states: FloatArray
    load: FloatArray
    pinion_torque: float
    brake_torque: float
    powers: dict[str, float]
    closure: float
    error: float
    spectral_radius: float
    origin: Origin | None = None
    first: int = 0
    stiffness: FloatArray | None = None
    between: dict[str, float] = field(default_factory=dict)
    resolved_peak_to_peak: dict[str, float] = field(default_factory=dict)

    @property
    def period(self) -> int:
        """Mesh cycles after which the motion repeats."""
        return self.tables.period

    @property
    def losses(self) -> dict[str, float]:
        """Mean losses [W] by name: sliding, tooth dampers and the places of the supports."""
        return {
            place: self.powers[place] for place in ("sliding", "tooth_dampers", *self.system.supports.places)
        }

    def balance(self, conservative: bool) -> dict[str, float]:
        """Torques that hold the mean speed [N m], and efficiency, as of ``lumped.model.powers.balance``.

        Without powers there is no efficiency.
        """
        if not self.powers:
            return {"brake_torque": self.brake_torque, "pinion_torque": self.pinion_torque}
        g = self.pair.geometry
        torque = self.pinion_torque
        brake = self.brake_torque - (self.powers["rolling"] / g.omega_gear if conservative else 0.0)
        efficiency = 1.0 - sum(self.losses.values()) / (torque * g.omega_pinion)
        return {"brake_torque": brake, "pinion_torque": torque, "mesh_efficiency": efficiency}

    @cached_property
    def number(self) -> IntArray:
        """Number of the pair in each place at each output, (places, k)."""
        cycle = self.first + np.arange(self.time.size) // self.tables.outputs.sum()
        return np.asarray(cycle - self.tables.ahead[:, None], dtype=np.int64)

    @cached_property
    def teeth(self) -> tuple[IntArray, IntArray]:
        """Teeth of pinion and gear in each place at each output, counted from 0, (places, k)."""
        return teeth_of_pairs(self.pair, self.number)

    @cached_property
    def touches(self) -> BoolArray:
        """Whether each pair is in its window or, with loaded contact, carries load; (places, k)."""
        tables = self.tables
        g = self.pair.geometry
        if not tables.law.prescribed:
            return np.asarray(self.load != 0.0)
        step = np.resize(np.flatnonzero(tables.outputs), self.time.size)
        place = tables.position[step, 0].T  # just inside of the step
        return np.asarray((place > g.L_XA) & (place < g.L_XD))

    @cached_property
    def shown_places(self) -> IntArray:
        """Places (n,) that a result shows: the places of like teeth, and further places that carry load."""
        g = self.pair.geometry
        like = np.round((self.system.cycle.offsets - g.L_XA) / g.base_pitch)
        return np.flatnonzero(np.isin(self.tables.ahead, like) | (self.load != 0.0).any(axis=1))

    @cached_property
    def pairs(self) -> PairState:
        """Coefficients of the pair in each place at each output; 0 for a pair that carries no load."""
        tables = self.tables
        step = np.resize(np.flatnonzero(tables.outputs), self.time.size)
        pitch = tables.law.rolling_speed * tables.duration
        touches = self.touches
        swung = 0.0 * self.time if tables.law.prescribed else swing(tables, self.time)
        # As in ``lumped.mesh.tables.nearest_node``: the step to which the middle of the own step swings.
        middle = 0.5 * (tables.edges[step] + tables.edges[step + 1])
        pitches, phase = np.divmod(middle + swung / pitch, 1.0)
        swung_step = np.searchsorted(tables.edges[1:-1], phase, side="right")
        phase -= middle - tables.edges[step]
        place, when = np.nonzero(touches)
        place = np.clip(place - pitches[when].astype(np.int64), 0, tables.ahead.size - 1)
        kind = tables.kinds[self.teeth][touches]
        distance = ((phase - tables.edges[swung_step]) * pitch)[when]
        laws, slopes = (table[kind, swung_step[when], 0, place] for table in (tables.laws, tables.slopes))

        def of_pairs(name: str) -> FloatArray:
            values = np.zeros(touches.shape)
            values[touches] = laws[name] + slopes[name] * distance
            return values

        k, c, mu, gap = (of_pairs(name) for name in ("stiffness", "damping", "mu", "gap"))
        return PairState(tables.position[step, 0].T + swung, touches, k, c, mu, gap, np.zeros(gap.shape))


def default_samples(period: int) -> int:
    """Default number of outputs in a mesh cycle: a power of two, smaller for periods of many cycles."""
    samples: int = 2 ** int(math.log2(_ALL_SAMPLES / period))
    return min(max(samples, _LEAST_SAMPLES), _MOST_SAMPLES)


def plain_motion(
    motion: RevolutionMotion, origin: Callable[[], dict[str, Any]], *, periodic: bool = True
) -> PlainMotion:
    """Return a motion with the names of ``lumped.model.results.VARIABLES``.

    A transient is not ``periodic`` and has no attributes of a periodic motion. ``origin`` returns the
    attributes about the origin of the motion, which only the dataset has. Of teeth that differ the dataset
    names the teeth of each pair.
    """
    system = motion.system
    places = motion.shown_places
    load = motion.load[places]
    known = gear_values(system, motion.states) | {"normal_load": load}
    if motion.stiffness is not None:
        known["mesh_stiffness"] = motion.stiffness

    def of_pairs() -> dict[str, FloatArray]:
        return pair_values(system, motion.states, load, motion.pairs.of_places(places))

    values = MotionValues(known, of_pairs)
    attributes = _attributes(motion) | (_of_period(motion, values) if periodic else {})

    def make_dataset() -> xr.Dataset:
        run = labelled(motion.time, values, origin() | attributes, _teeth_of_pairs(motion))
        return system.supports.labelled(run, motion.states)

    return PlainMotion(motion.time, values, attributes, make_dataset)


def _teeth_of_pairs(motion: RevolutionMotion) -> dict[str, Variable]:
    """Variables with the teeth of each pair, where teeth differ."""
    if motion.pair.healthy is motion.pair:
        return {}
    return {
        f"{name}_tooth": (
            ("pair", "time"),
            teeth[motion.shown_places] + 1,
            "1",
            f"tooth of the {name}, counted from 1",
        )
        for name, teeth in zip(("pinion", "gear"), motion.teeth, strict=True)
    }


def _attributes(motion: RevolutionMotion) -> dict[str, Any]:
    """Attributes of every motion: torques, losses and the words that say which motion it is."""
    attributes: dict[str, Any] = dict(motion.balance(contact_of(motion.pair).conservative))
    attributes |= {
        "model": "lumped",
        "contact": motion.touch.contact,
        "period_cycles": motion.period,
        "teeth": "alike" if motion.pair.healthy is motion.pair else "as given",
        "touch": motion.touch.value,
        "spectral_radius": motion.spectral_radius,
    }
    if motion.origin is not None:
        attributes["origin"] = motion.origin.value
    if motion.powers:
        attributes |= {f"power_{place}": power for place, power in motion.losses.items()}
        residual = 0.0 if contact_of(motion.pair).conservative else motion.powers["rolling"]
        attributes["power_energy_residual"] = residual
    return attributes


def _of_period(motion: RevolutionMotion, values: Mapping[str, FloatArray]) -> dict[str, float]:
    """Errors and ranges of a motion that closes."""
    attributes = {
        "closure": motion.closure,
        "error_estimate": motion.error,
    }
    sizes = motion.resolved_peak_to_peak or swings_of_period(
        motion.system, motion.time, values, motion.period
    )
    attributes |= {f"{name}_peak_to_peak": sizes[name] + motion.between.get(name, 0.0) for name in SWINGING}
    return attributes


def swings_of_period(
    system: LTVSystem, time: FloatArray, values: Mapping[str, FloatArray], cycles: int
) -> dict[str, float]:
    """Return the peak to peak of each variable of ``SWINGING`` over a period of mesh cycles [m].

    Extremes between two outputs are those of a cubic. Where a vibration lies between two outputs, the rate at
    an output says nothing about the next output, and the cubic overshoots: see ``resolves``.
    """
    closed = np.append(time, cycles * system.period)
    periods, rates = (
        np.array([np.append(values[key], values[key][0]) for key in keys])
        for keys in (SWINGING, [f"{name}_dot" for name in SWINGING])
    )
    return dict(zip(SWINGING, peaks_to_peaks(closed, periods, rates).tolist(), strict=True))


def resolves(system: LTVSystem, samples: int) -> bool:
    """Return whether ``samples`` outputs in a mesh cycle are two or more in each vibration."""
    return fastest_frequency(system) * system.period <= math.pi * samples
