"""A periodic motion over a mesh cycle, a revolution or the hunting period, and its labelled result.

Sources: docs/theory/teeth.md, "Motion", "Brake torque".
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from lumped.labelling import Variable
from lumped.mesh.tables import MeshTables
from lumped.model.mesh_cycle import PairState
from lumped.model.periodic_system import LTVSystem
from lumped.model.results import labelled, peak_to_peak, response
from lumped.model.swing import swing
from lumped.quasi_static.contacts import contact_of
from lumped.schema.meeting_teeth import teeth_of_pairs
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    import xarray as xr

#: Most and least outputs of a mesh cycle by default, and how many all cycles together are to have.
_MOST_SAMPLES = 512
_LEAST_SAMPLES = 32
_ALL_SAMPLES = 65536


#: Argument ``contact``: teeth that are tied to the linear form, or that only push.
Contact = Literal["linear", "unilateral"]


class Touch(Enum):
    """How the teeth touch in a motion; the value is how a result says it."""

    TIED = "fixed windows of contact, teeth tied (linear)"
    WINDOWS = "fixed windows of contact, unilateral"
    MOMENTARY = "own gaps and tip corners, unilateral"
    LINEAR = "linear about the own static state of every pair"

    @property
    def contact(self) -> Contact:
        """Which argument ``contact`` asks for it."""
        return "linear" if self in (Touch.TIED, Touch.LINEAR) else "unilateral"


class Origin(Enum):
    """How a motion was found; the value is how a result says it."""

    LINEAR = "near the linear motion"
    SETTLED = "a run settles to it"


@dataclass(frozen=True, eq=False)
class RevolutionMotion:
    """Periodic motion over ``period`` mesh cycles.

    Attributes
    ----------
    system : the "full" system of the healthy twin
    tables : the contact that was integrated
    touch : how the teeth touch
    time : (k,) [s]
    states : (k, n)
    load : (pairs, k) normal load of each place, of ``tables.ahead`` [N]
    pinion_torque, brake_torque : mean torques that hold the mean speed against moments [N m]
    powers : mean power of sliding, tooth dampers, bearings, shafts, and of the gap that closes as the teeth
        roll [W]; {} where it is not known
    closure : mismatch of the state after the period, over the largest displacement
    error : difference of the dynamic transmission error to that of longer steps, over its largest value;
        twice as long of like teeth and of the linear form, four times of teeth that differ and push only
    spectral_radius : of the motion itself where teeth are alike, else of the healthy twin
    origin : how a motion with unilateral contact was found
    first : number of the mesh cycle of the first time
    stiffness : (k,) of the mesh in the linear form [N/m]; None: that of the pairs that carry load
    between : variable -> how much the outputs miss of its peak to peak with like teeth [m]
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

    @property
    def period(self) -> int:
        """Mesh cycles."""
        return self.tables.period

    @property
    def losses(self) -> dict[str, float]:
        """Place -> mean power that is lost there [W]."""
        return {
            place: self.powers[place] for place in ("sliding", "tooth_dampers", *self.system.supports.places)
        }

    def balance(self, conservative: bool) -> dict[str, float]:
        """Torques that hold the mean speed [N m], and efficiency, as of ``lumped.model.powers.balance``.

        Where the powers are not known there is no efficiency.
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
        """Number of the pair in each place at each output, (pairs, k)."""
        cycle = self.first + np.arange(self.time.size) // self.tables.outputs.sum()
        return np.asarray(cycle - self.tables.ahead[:, None], dtype=np.int64)

    @cached_property
    def teeth(self) -> tuple[IntArray, IntArray]:
        """Teeth of pinion and gear in each place at each output, from 0, (pairs, k)."""
        return teeth_of_pairs(self.pair, self.number)

    @cached_property
    def touches(self) -> BoolArray:
        """Whether the pair in each place can carry load, (pairs, k): in its window, or where it does."""
        tables = self.tables
        g = self.pair.geometry
        if not tables.law.windows:
            return np.asarray(self.load != 0.0)
        step = np.resize(np.flatnonzero(tables.outputs), self.time.size)
        place = tables.position[step, 0].T  # just inside of the step
        return np.asarray((place > g.L_XA) & (place < g.L_XD))

    @cached_property
    def kept(self) -> IntArray:
        """Places of a result: those of like teeth, and further ones that carry load."""
        g = self.pair.geometry
        like = np.round((self.system.cycle.offsets - g.L_XA) / g.base_pitch)
        return np.flatnonzero(np.isin(self.tables.ahead, like) | (self.load != 0.0).any(axis=1))

    @cached_property
    def pairs(self) -> PairState:
        """Coefficients of the pair in each place at each output; a pair that carries nothing has none."""
        tables = self.tables
        step = np.resize(np.flatnonzero(tables.outputs), self.time.size)
        pitch = tables.law.rolling_speed * tables.duration
        touches = self.touches
        moved = 0.0 * self.time if tables.law.windows else swing(tables, self.time)
        # As the integration does: the step is that of the shifted middle of the own one.
        middle = 0.5 * (tables.edges[step] + tables.edges[step + 1])
        pitches, phase = np.divmod(middle + moved / pitch, 1.0)
        at = np.searchsorted(tables.edges[1:-1], phase, side="right")
        phase -= middle - tables.edges[step]
        place, when = np.nonzero(touches)
        place = np.clip(place - pitches[when].astype(np.int64), 0, tables.ahead.size - 1)
        kind = tables.kinds[self.teeth][touches]
        way = ((phase - tables.edges[at]) * pitch)[when]
        laws, slopes = (table[kind, at[when], 0, place] for table in (tables.laws, tables.slopes))

        def of_pairs(name: str) -> FloatArray:
            found = np.zeros(touches.shape)
            found[touches] = laws[name] + slopes[name] * way
            return found

        k, c, mu, gap = (of_pairs(name) for name in ("stiffness", "damping", "friction", "gap"))
        return PairState(tables.position[step, 0].T + moved, touches, k, c, mu, gap, np.zeros(gap.shape))


def default_samples(period: int) -> int:
    """Outputs a mesh cycle: fewer, the more cycles a period has; a power of two."""
    found: int = 2 ** int(math.log2(_ALL_SAMPLES / period))
    return min(max(found, _LEAST_SAMPLES), _MOST_SAMPLES)


def labelled_motion(
    motion: RevolutionMotion, attributes: dict[str, Any], *, periodic: bool = True
) -> xr.Dataset:
    """A motion under the names of ``lumped.model.results.VARIABLES``; of teeth that differ with their names.

    Not ``periodic``: a transient, about which the attributes of the periodic motion say nothing.
    """
    system = motion.system
    pairs = motion.pairs
    kept = motion.kept
    values = response(system, motion.time, motion.states, motion.load[kept], pairs.of_places(kept))
    if motion.stiffness is not None:
        values["mesh_stiffness"] = motion.stiffness
    further: dict[str, Variable] = {}
    alike = motion.pair.healthy is motion.pair
    if not alike:
        further = {
            f"{name}_tooth": (("pair", "time"), teeth[kept] + 1, "1", f"tooth of the {name}, counted from 1")
            for name, teeth in zip(("pinion", "gear"), motion.teeth, strict=True)
        }
    attributes = attributes | motion.balance(contact_of(motion.pair).conservative)
    attributes |= {
        "model": "lumped",
        "contact": motion.touch.contact,
        "period_cycles": motion.period,
        "teeth": "alike" if alike else "as given",
        "touch": motion.touch.value,
        "spectral_radius": motion.spectral_radius,
    }
    if motion.origin is not None:
        attributes["origin"] = motion.origin.value
    if motion.powers:
        attributes |= {f"power_{place}": power for place, power in motion.losses.items()}
        left = 0.0 if contact_of(motion.pair).conservative else motion.powers["rolling"]
        attributes["power_energy_residual"] = left
    if periodic:
        attributes |= _of_period(motion, values)
    run = labelled(motion.time, values, attributes, further)
    return system.supports.labelled(run, motion.states)


def _of_period(motion: RevolutionMotion, values: dict[str, FloatArray]) -> dict[str, float]:
    """Errors and ranges of a motion that closes."""
    found = {
        "closure": motion.closure,
        "error_estimate": motion.error,
    }
    closed = np.append(motion.time, motion.period * motion.system.period)
    for name in ("dte", "x_p", "x_g", "y_p", "y_g"):
        one, rate = (np.append(values[key], values[key][0]) for key in (name, f"{name}_dot"))
        found[f"{name}_peak_to_peak"] = peak_to_peak(closed, one, rate) + motion.between.get(name, 0.0)
    return found
