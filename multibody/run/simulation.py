"""Simulate a gear pair with the multibody model and return the lumped model's variables.

Sources: docs/theory/multibody.md.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import Supports, on_springs, supports_of
from lumped.model.results import cycle_peak_to_peak, labelled
from lumped.model.solution import Initial
from lumped.model.steady import sample_times
from lumped.model.sweep import running_speeds
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress, ProgressRequest
from multibody.run.integration import Segment
from multibody.run.model import ExudynModel, contact_state, from_lumped_state, to_lumped_state
from multibody.run.setup import MOST_CYCLES, Fidelity, Setup, prepare

if TYPE_CHECKING:
    import xarray as xr


_COORDINATES = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g")
#: Variables beyond those of the lumped model: name -> (dimensions, unit, plain name).
EXTRA = {
    "overlap": (("time",), "m", "overlap of the driving flanks along the actual line of action"),
    "normal_load_back": (("pair", "time"), "N", "normal load on the back sides of the teeth"),
}


#: Per-pair variable -> field of the contact record that holds it.
_FIELDS = {
    "mu": "friction_coefficient",
    "normal_load": "load",
    "friction_force": "friction_force",
    "sliding_velocity": "sliding_velocity",
    "position": "position",
}


class Recorder:
    """Collects states and contacts at the output times (n,) [s] while the integration runs."""

    def __init__(self, model: ExudynModel, time: FloatArray) -> None:
        self.model = model
        self.time = time
        machine = model.machine
        geometry = machine.record.geometry
        n = time.size
        self.q = np.zeros((n, machine.size))
        self.v = np.zeros((n, machine.size))
        phase = time / machine.period
        self.advance = np.maximum(phase - np.floor(phase + 1e-9), 0.0) * geometry.pitch
        ahead = np.arange(machine.ahead, machine.ahead - machine.pairs, -1)[:, None] * geometry.pitch
        self.pairs = {
            name: np.zeros((machine.pairs, n)) for name in (*_FIELDS, "contact", "normal_load_back")
        }
        # A pair without contact has the nominal position.
        self.pairs["position"] += geometry.L_XA + ahead + self.advance
        self.stiffness = np.zeros(n)
        self.overlap = np.full(n, np.nan)

    def visit(self, segment: Segment, start: float, stop: float) -> None:
        """Record the output times in [start, stop)."""
        slack = 1e-9 * self.model.machine.period
        low, high = np.searchsorted(self.time, [start - slack, stop - slack])
        if low == high:
            return
        inside = np.clip(self.time[low:high], segment.times[0], segment.times[-1])
        self.q[low:high], self.v[low:high] = segment.at(inside)
        self._contacts(int(low), int(high))

    def finish(self, q: FloatArray, v: FloatArray, end: float) -> None:
        """Record the last output time, as the first instant of the cycle that would follow."""
        rolling = self.model.record.rolling
        period = self.model.machine.period
        self.q[-1] = q
        self.v[-1] = v
        if np.isfinite(rolling.earliest):
            rolling.earliest = end + 1e-12 * period
            rolling.latest = end + 1e-9 * period
        self._contacts(self.time.size - 1, self.time.size)

    def _contacts(self, low: int, high: int) -> None:
        """Evaluate the contacts at output times low ... high - 1, and sort them into the slots of pairs."""
        machine = self.model.machine
        geometry = machine.record.geometry
        part = slice(low, high)
        states = contact_state(self.model, self.time[part], self.q[part], self.v[part])
        for j in range(int(states.counts.max(initial=0))):
            samples = np.flatnonzero(j < states.counts)
            contact = states.contacts[samples, j]
            rows = low + samples
            # Whole pitches ahead of the nominal position of the newest pair. A pair that enters early or
            # leaves late takes the slot of the pair without contact.
            pitches = np.rint((contact["position"] - geometry.L_XA - self.advance[rows]) / geometry.pitch)
            slot = np.mod(machine.ahead - pitches.astype(int), machine.pairs)
            drive = contact["flank"] > 0
            driving = (slot[drive], rows[drive])
            for name, field in _FIELDS.items():
                self.pairs[name][driving] = contact[field][drive]
            self.pairs["contact"][driving] = 1.0
            coasting = (slot[~drive], rows[~drive])
            np.add.at(self.pairs["normal_load_back"], coasting, contact["load"][~drive])
            self.stiffness[rows[drive]] += contact["stiffness"][drive]
            self.overlap[rows[drive]] = contact["compression"][drive]

    def dataset(self, attributes: Mapping[str, Any]) -> xr.Dataset:
        """Return everything recorded under the lumped model's names."""
        import xarray as xr

        geometry = self.model.machine.record.geometry
        rolling = self.model.machine.record.rolling
        per_pair = dict(self.pairs)
        back = per_pair.pop("normal_load_back")
        values = self._motion() | per_pair
        nominal = (rolling.omega_p + rolling.omega_g) * (per_pair["position"] - geometry.L_XP)
        values |= {
            "friction_power_nominal": -per_pair["friction_force"] * nominal,
            "mesh_stiffness": self.stiffness,
            "friction_power": -per_pair["friction_force"] * per_pair["sliding_velocity"],
        }
        result = labelled(self.time, values, attributes)
        overlap = np.where(np.isnan(self.overlap), values["dte"], self.overlap)
        for name, data in (("overlap", overlap), ("normal_load_back", back)):
            dims, unit, text = EXTRA[name]
            result[name] = xr.DataArray(data, dims=dims, attrs={"units": unit, "long_name": text})
        train = self.model.machine.train
        if train is not None:
            result["bearing_force"] = xr.DataArray(
                train.bearing_force(self.q, self.v),
                {"bearing": list(train.bearing_names), "direction": ["loa", "oloa"], "time": result["time"]},
                dims=("bearing", "direction", "time"),
                attrs={"units": "N", "long_name": "force of each bearing on its shaft"},
            )
        return result

    def _motion(self) -> dict[str, FloatArray]:
        """Coordinates, rates, transmission error and bearing forces."""
        machine = self.model.machine
        states = [f"{name}{suffix}" for suffix in ("", "_dot") for name in _COORDINATES]
        q = self.q[:, :6]
        v = self.v[:, :6]
        values = dict(zip(states, to_lumped_state(q, v).T, strict=True))
        values |= {"dte": q @ machine.overlap, "dte_dot": v @ machine.overlap}
        if machine.train is not None:
            force = machine.train.bearing_force(self.q, self.v)
            names = machine.train.bearing_names
            for gear, name in (("p", "pinion"), ("g", "gear")):
                of_gear = [i for i, bearing in enumerate(names) if bearing.startswith(name)]
                for j, axis in enumerate("xy"):
                    values[f"bearing_force_{axis}_{gear}"] = force[of_gear, j].sum(axis=0)
            return values
        stiffness = machine.bearing_stiffness
        damping = machine.bearing_damping
        for i, gear in enumerate("pg"):
            for j, axis in enumerate("xy"):
                name = f"{axis}_{gear}"
                values[f"bearing_force_{name}"] = -(
                    stiffness[i, j] * values[name] + damping[i, j] * values[f"{name}_dot"]
                )
        return values


#: Runs over intervals with the ends (m + 1,), calls a function with the number and the segment of each
#: interval, and returns the state at the end.
Run = Callable[[FloatArray, Callable[[int, Segment], None]], tuple[FloatArray, FloatArray]]


@shows_progress("multibody model")
def simulate(
    pair: AnyPair,
    cycles: int = 20,
    *,
    fidelity: Fidelity = "exact",
    samples_per_cycle: int = 256,
    initial: Initial | ArrayLike = "static",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-8,
    friction_velocity: float | None = None,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Transient of the gear pair as an exudyn multibody system.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles, 1 to 100000
    fidelity : "linear" solves the lumped equations with exudyn's objects; "exact" lets rigid gears turn
        through finite angles with true involute contact
    samples_per_cycle : output times per mesh cycle; the grid ends on the last cycle's end
    initial : "static", "periodic" or 12 states, as for ``lumped.simulate``; on shafts no states, and the
        periodic motion is the model's own with the linear mesh
    effects : finite-motion effects that act at fidelity "exact", see ``multibody.EFFECTS``: a collection of
        names, or a mapping name -> bool in which names left out act; default all. At fidelity "linear" only
        "contact_loss", the lumped equations with teeth that push and never pull
    rtol : relative tolerance of the integration
    friction_velocity : sliding velocity over which friction changes its sign (tanh) [m/s]; 0 changes at
        once; None chooses, and the attribute ``friction_velocity_reason`` says why (see
        ``multibody.run.setup``)
    supports : "springs" of ``pair.bearings``, or the elastic "shafts" of ``pair.shafts`` with their own
        bearings, motor and load; by default the shafts of a pair that has them
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``time`` [s] and ``pair`` with the variables, names and units of
    ``lumped.simulate``, and

        overlap : overlap of the driving flanks along the actual line of action [m]
        normal_load_back : normal load on the back sides of the teeth [N]
        bearing_force : on shafts, force of each bearing on its shaft over (bearing, direction, time) [N]

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : a force is not finite, or the step size collapses

    Notes
    -----
    At fidelity "exact" the friction law is read where the nominal motion slides as fast as the teeth actually
    do, with the sign of the actual sliding velocity, so friction never feeds energy in.
    """
    progress = reported_to(progress)
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, MOST_CYCLES)
    supports = supports_of(pair, supports)
    setup = prepare(pair, fidelity, initial, effects, rtol, friction_velocity, supports)
    run, _, _ = record(setup, cycles, samples_per_cycle, progress=progress)
    return run


def record(
    setup: Setup,
    cycles: int,
    samples_per_cycle: int,
    *,
    first_cycle: int = 0,
    progress: Progress | None = None,
    run: Run | None = None,
) -> tuple[xr.Dataset, FloatArray, FloatArray]:
    """Variables of a run from ``first_cycle`` on, and the state q, v (size,) at the end of the run.

    run : visits the segments of an earlier run; None: integrate
    """
    period = setup.machine.period
    grid = sample_times(period, samples_per_cycle)
    time = np.concatenate([grid + j * period for j in range(first_cycle, cycles)] + [[cycles * period]])
    edges = setup.edges(cycles)
    recorder = Recorder(setup.model, time)

    def visit(number: int, segment: Segment) -> None:
        recorder.visit(segment, float(edges[number]), float(edges[number + 1]))
        if progress is not None:
            progress(float(edges[number + 1] / edges[-1]))

    q, v = (run or setup.run)(edges, visit)
    recorder.finish(q, v, float(edges[-1]))
    attributes = setup.attributes | {
        "cycles": cycles,
        "samples_per_cycle": samples_per_cycle,
        "force_evaluations": setup.model.budget.calls,
    }
    return recorder.dataset(attributes), q, v


def at_mean_speed(
    pair: GearPair, reference: xr.Dataset, swing: FloatArray, samples: int, settling: int
) -> xr.Dataset:
    """Run from the start of a lumped motion, with the brake torque under which the run keeps the mean speed.

    A first run shows how far the common rotation of the base circles drifts from the swing of the lumped
    motion. The second run starts without this drift, and with the brake torque that stops the drift.

    Parameters
    ----------
    reference : the lumped motion at the output times
    swing : (k,) common rotation of the base circles in the lumped motion [m]
    samples : output times in a mesh cycle
    settling : mesh cycles of the first run from which no drift is read
    """
    names = [f"{name}{suffix}" for suffix in ("", "_dot") for name in _COORDINATES]
    state = np.array([float(reference[name][0]) for name in names])
    setup = prepare(pair, initial=state, supports="springs")
    inertia = setup.machine.inertia
    radii = setup.machine.base_radii
    mass = float((inertia / radii**2).sum())
    period = setup.machine.period

    def drift(motion: xr.Dataset, last: int | None = None) -> FloatArray:
        rotations = np.stack([motion[name].to_numpy()[:last] for name in ("theta_p", "theta_g")])
        return np.asarray(inertia / radii @ rotations / mass - swing[:last], dtype=np.float64)

    def run(place: float, rate: float, brake: float) -> xr.Dataset:
        rotations = np.stack([place / radii, rate / radii], axis=1)
        q, v = from_lumped_state(state - np.pad(rotations, ((0, 4), (0, 0))).T.ravel())
        started = replace(setup, q=q, v=v).with_torques(setup.machine.torque_pinion, brake)
        return record(started, (reference.sizes["time"] - 1) // samples, samples)[0]

    of_lumped = drift(reference, samples + 1)
    start = float(of_lumped[0])
    start_rate = float(of_lumped[-1] - of_lumped[0]) / period
    first = run(start, start_rate, setup.machine.torque_gear)
    low = settling * samples
    time = period / samples * np.arange(swing.size)
    bend, rate, place = (float(c) for c in np.polyfit(time[low:], drift(first)[low:], 2))
    brake = setup.machine.torque_gear + 2.0 * bend * mass * float(radii[1])
    return run(start + place, start_rate + rate, brake).assign_attrs(brake_torque=brake)


_VARIABLES = {
    "dte_rms": ("m", "root mean square of the transmission error about its mean"),
    "dte_peak_to_peak": ("m", "peak to peak of the transmission error"),
    "overlap_min": ("m", "smallest overlap of the driving flanks; negative: the teeth separate"),
    "separated": ("1", "share of time in which no driving flanks touch"),
    "back_side": ("1", "share of time in which the back sides touch"),
    "unsettled": ("1", "change of the root mean square from the first to the second half, relative"),
}


@shows_progress("speed sweep, multibody model")
def speed_sweep(
    pair: AnyPair,
    speeds_rpm: Iterable[float],
    *,
    settle: int = 80,
    cycles: int = 20,
    samples_per_cycle: int = 128,
    fidelity: Fidelity = "exact",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-7,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Response over speed with the state carried from one speed to the next, in the order given.

    Parameters
    ----------
    pair : a validated gear pair; its speed is replaced
    speeds_rpm : pinion speeds in the order of the sweep, rising or falling [rpm]
    settle : mesh cycles run at every speed before the response is taken
    cycles : mesh cycles over which it is taken
    samples_per_cycle : output times per mesh cycle
    fidelity, effects, rtol : as ``multibody.simulate``
    supports : "springs", on which alone a state is carried on; needed for a pair with shafts
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``speed`` [rpm], in the order of the sweep. ``unsettled`` says where ``settle`` was
    too short, as near the boundary of stability, or where the motion beats.

    Raises
    ------
    ParameterError, NumericalError : as ``multibody.simulate``
    """
    progress = reported_to(progress)
    pair = on_springs(load_gear_pair(pair), supports, "multibody.speed_sweep")
    speeds = running_speeds(speeds_rpm)
    settle = whole_number("settle", settle, 0, MOST_CYCLES)
    cycles = whole_number("cycles", cycles, 1, MOST_CYCLES)
    table = {name: np.full(speeds.size, np.nan) for name in _VARIABLES}
    state: FloatArray | None = None
    for j, rpm in enumerate(speeds):
        pair_at_speed = pair.with_({"operating.pinion_speed": float(rpm)})
        initial = "periodic" if state is None else state
        setup = prepare(pair_at_speed, fidelity, initial, effects, rtol, supports="springs")
        run, q, v = record(setup, settle + cycles, samples_per_cycle, first_cycle=settle)
        # Whole cycles end at the phase at which they start, so the state is a start at the next speed.
        state = to_lumped_state(q, v)
        # The last sample is the first of the next cycle. Means over whole cycles leave the last sample out.
        dte = run["dte"].to_numpy()[:-1]
        overlap = run["overlap"].to_numpy()[:-1]
        table["dte_rms"][j] = np.std(dte)
        table["dte_peak_to_peak"][j] = cycle_peak_to_peak(run, "dte")
        table["overlap_min"][j] = overlap.min()
        table["separated"][j] = np.mean(overlap <= 0.0)
        table["back_side"][j] = np.mean(run["normal_load_back"].to_numpy()[:, :-1].sum(0) > 0.0)
        halves = [np.std(half) for half in np.split(dte, [cycles // 2 * samples_per_cycle]) if half.size]
        table["unsettled"][j] = abs(halves[-1] - halves[0]) / np.std(dte)
        if progress is not None:
            progress((j + 1) / speeds.size)
    return labelled_dataset(
        {name: ("speed", values, *_VARIABLES[name]) for name, values in table.items()},
        {"speed": (speeds, "rpm", "pinion speed")},
        provenance(pair, settle=settle, cycles=cycles, rtol=rtol)
        | {
            "model": "multibody",
            "fidelity": fidelity,
            "teeth": "alike" if pair.healthy is pair else "as given",
            "supports": "springs",
        },
    )
