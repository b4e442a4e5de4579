"""Make the files of the reference cases again: ``python -m validation.reference_cases.make``.

The same machine makes the same bytes. The parameter files of the pairs are read; all other files are written.
Names after the command make these cases alone, and a folder after ``--folder`` receives the files.

Source: docs/reference_cases.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
import xarray as xr

import lumped
import multibody
from floquet import PROPAGATORS, PeriodicSystem
from floquet.engine.propagation import propagate
from lumped import GearPair
from lumped.typing import FloatArray
from validation.check.quantities import QUANTITIES
from validation.cross_check.motions import CONTACT_LOSS
from validation.cross_check.own_teeth import both_motions
from validation.files.output import write_text
from validation.reference_cases.definitions import DEFINITIONS, Definition
from validation.reference_cases.discrepancy import StaticValues, discrepancies
from validation.reference_cases.equations import SingleDegree, equation_of
from validation.reference_cases.files import (
    DATA,
    INDEX,
    LICENCE_FILE,
    SCHEMA_VERSION,
    case_file,
    checksum,
    curves_file,
    curves_text,
    pair_file,
    read_curves,
)

#: Every so many samples of a curve are compared with the transition matrices of floquet.
_STRIDE = 4
#: Relative tolerance of the transition matrices, and of the multibody model.
_RTOL_FLOQUET = 1e-12
_RTOL_MULTIBODY = 1e-9
#: States of a gear pair, in the order of ``lumped.simulate``.
_COORDINATES = ("theta_p", "theta_g", "x_p", "x_g", "y_p", "y_g")
STATES = (*_COORDINATES, *(f"{name}_dot" for name in _COORDINATES))
_PHASE_ZERO = (
    "At t = 0 a tooth pair is at the start of contact A, which follows from the geometry without "
    "deflection. Row i is at t = i T/n; the row at the end of the period is left out."
)
_MISFIT = (
    "root of SUM |U_m - V_m|^2 over mesh orders up to 40 over the root of SUM |U_m|^2; U of the curve, "
    "V of the other motion; rounded up"
)


@dataclass(frozen=True)
class Computed:
    """Curves of a case and the same channels by other ways.

    Attributes
    ----------
    time : (k,) [s]
    curves : channel -> (k,) in SI
    others : way, a field of ``Discrepancy`` -> channel -> (k,) in SI
    static : static values of the case
    period : mesh cycles of the period
    mesh_period : mesh cycle [s]
    made_by : words: where the curves come from
    start : state at t = 0: variable -> value in SI; empty on shafts, which have states of their own
    stride : every so many samples are compared
    """

    time: FloatArray
    curves: Mapping[str, FloatArray]
    others: Mapping[str, Mapping[str, FloatArray]]
    static: StaticValues
    period: int
    mesh_period: float
    made_by: str
    start: Mapping[str, float]
    stride: int = 1

    def stated(self) -> dict[str, dict[str, float]]:
        """Return channel -> way -> discrepancy from the curves as the file has them, rounded up."""
        static = {name: self.static.of_unit(unit_of(name)) for name in self.curves}
        published = read_curves(curves_text(self.time, self.curves), "published").channels
        return discrepancies(
            {one.name: one.values[:: self.stride] for one in published},
            self.others,
            static,
            self.period,
        )


def unit_of(channel: str) -> str:
    """Return the SI unit of the static value by which a channel is scaled; a rate counts as its motion."""
    return QUANTITIES[channel].unit.removesuffix("/s")


def channels_of(motion: xr.Dataset, names: tuple[str, ...]) -> dict[str, FloatArray]:
    """Return the channels of a motion of either program; a channel that the motion lacks is left out."""
    channels = {}
    for name in names:
        quantity = QUANTITIES[name]
        if quantity.variable not in motion:
            continue
        values = motion[quantity.variable]
        if quantity.derivative:
            values = motion[name]
        channels[name] = (values.sum("pair") if quantity.summed else values).to_numpy()
    return channels


def channels_of_equation(
    equation: SingleDegree, time: FloatArray, dte: FloatArray, dte_dot: FloatArray, names: tuple[str, ...]
) -> dict[str, FloatArray]:
    """Return the channels of a motion (k,) with one degree of freedom.

    The mesh force is that of the tooth pairs and of the damper. The tooth pairs alone make friction.
    """
    stiffness = equation.mesh_stiffness(time)
    channels = {
        "dte": dte,
        "dte_dot": dte_dot,
        "mesh_force": stiffness * dte + equation.damping * dte_dot,
        "friction": equation.friction_coefficient(time) * stiffness * dte,
        "mesh_stiffness": stiffness,
    }
    return {name: channels[name] for name in names}


def by_transition_matrices(equation: SingleDegree, times: FloatArray) -> FloatArray:
    """Periodic motion (k, 2) at times that begin with 0, by transition matrices of ``floquet``.

    The third state is constant and carries the force. Each state is divided by its static size.
    """
    size = equation.force / float(equation.stiffness(equation.edges[:1])[0])
    scale = np.array([size, size * 2.0 * np.pi / equation.period, 1.0])

    def matrix(time: FloatArray) -> FloatArray:
        values = np.zeros((time.size, 3, 3))
        values[:, 0, 1] = 1.0
        values[:, 1, 0] = -equation.stiffness(time) / equation.mass
        values[:, 1, 1] = -equation.damping / equation.mass
        values[:, 1, 2] = equation.force / equation.mass
        return np.asarray(values * scale / scale[:, None])

    marks = np.union1d(times[1:], equation.edges[1:-1])
    system = PeriodicSystem(matrix, equation.period, tuple(marks), vectorized=True)
    flow = propagate(system, PROPAGATORS["gauss"], _RTOL_FLOQUET)
    to_end = np.empty((flow.times.size, 3, 3))
    to_end[0] = np.eye(3)
    for number, step in enumerate(flow.steps):
        to_end[number + 1] = step @ to_end[number]
    to_end *= flow.scaling[:, None] / flow.scaling
    cycle = to_end[-1]
    start = np.linalg.solve(np.eye(2) - cycle[:2, :2], cycle[:2, 2])
    places = np.searchsorted(flow.times, times - 1e-9 * equation.period)
    return np.asarray((to_end[places] @ np.append(start, 1.0))[:, :2] * scale[:2])


def one_degree(definition: Definition) -> Computed:
    """Compute a case with one degree of freedom."""
    equation = equation_of(definition.equation or {})
    time = equation.period * np.arange(definition.samples_per_cycle) / definition.samples_per_cycle
    motion = equation.motion(time)
    names = definition.channels
    few = time[::_STRIDE]
    dte, dte_dot = by_transition_matrices(equation, few).T
    curves = channels_of_equation(equation, time, motion.dte, motion.dte_dot, names)
    rounded = {name: values[::_STRIDE] for name, values in curves.items()}
    mean = float(motion.dte.mean())
    return Computed(
        time,
        curves,
        {"closed_form": rounded, "floquet": channels_of_equation(equation, few, dte, dte_dot, names)},
        StaticValues(equation.force, mean, 1.0),
        1,
        equation.period,
        "closed form",
        {"dte": float(motion.dte[0]), "dte_dot": float(motion.dte_dot[0])},
        _STRIDE,
    )


def start_of(motion: xr.Dataset) -> dict[str, float]:
    """Return the state of a gear pair at t = 0."""
    return {name: float(motion[name][0]) for name in STATES}


def multibody_motion(pair: GearPair, definition: Definition, motion: xr.Dataset) -> xr.Dataset:
    """Return the periodic motion of the multibody model with exact kinematics near the lumped motion."""
    lost = float(motion["normal_load"].sum("pair").min()) <= 0.0
    near = definition.contact == "unilateral" and pair.shafts is None
    return multibody.steady_state(
        pair,
        fidelity="exact",
        samples_per_cycle=definition.samples_per_cycle,
        initial=np.array(list(start_of(motion).values())) if near else None,
        effects=CONTACT_LOSS["exact"] if lost else None,
        rtol=_RTOL_MULTIBODY,
    )


def six_degrees(definition: Definition, pair: GearPair) -> Computed:
    """Compute a case of a gear pair."""
    samples = definition.samples_per_cycle
    contact = definition.contact or "linear"
    motion, finer = (
        lumped.steady_state(pair, contact=contact, samples_per_cycle=share * samples).isel(
            time=slice(None, None, share)
        )
        for share in (definition.steps_per_sample, 2 * definition.steps_per_sample)
    )
    period = int(motion.attrs.get("period_cycles", 1))
    if period > 1:  # teeth differ
        _, reference, exact = both_motions(pair, samples)
        count = period * samples
        # The runs begin ten cycles after the start of the period; the period is turned back.
        turn = round(float(reference["time"][0]) / pair.geometry.mesh_period) * samples
        order = np.roll(np.arange(count), turn % count)
        exact = exact.isel(time=order)
    else:
        exact = multibody_motion(pair, definition, motion)
    names = definition.channels
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    return Computed(
        motion["time"].to_numpy(),
        channels_of(motion, names),
        {"lumped": channels_of(finer, names), "multibody": channels_of(exact, names)},
        StaticValues(force, float(motion["dte"].mean()), pair.geometry.base_radius_pinion),
        period,
        pair.geometry.mesh_period,
        f"lumped.steady_state, contact {contact}, on {motion.attrs['supports']}",
        {} if pair.shafts is not None else start_of(motion),
    )


def statement_of(definition: Definition, computed: Computed) -> dict[str, Any]:
    """Return what the file of a case states, as plain data."""
    return {
        "schema_version": SCHEMA_VERSION,
        "name": definition.name,
        "description": definition.description,
        "frequent_fault": definition.fault,
        "source": definition.source,
        "licence": "CC0-1.0",
        "pair": "" if definition.contact is None else pair_file(definition.name),
        "curves": curves_file(definition.name),
        "sampling": {
            "samples_per_cycle": definition.samples_per_cycle,
            "mesh_cycles": computed.period,
            "mesh_period": computed.mesh_period,
            "phase_zero": _PHASE_ZERO,
        },
        "motion": {"curves_from": computed.made_by, "contact": definition.contact or "none"},
        "start": dict(computed.start),
        **({} if definition.equation is None else {"equation": dict(definition.equation)}),
        "discrepancy": {"meaning": _MISFIT, **computed.stated()},
    }


def compute(definition: Definition) -> Computed:
    """Compute a case."""
    if definition.contact is None:
        return one_degree(definition)
    return six_degrees(definition, lumped.load_gear_pair(DATA / pair_file(definition.name)))


def make(names: list[str], folder: Path) -> None:
    """Write the files of these cases into a folder, and the index of all files that are in it."""
    for definition in DEFINITIONS:
        if not names or definition.name in names:
            computed = compute(definition)
            write_text(folder / curves_file(definition.name), curves_text(computed.time, computed.curves))
            text = tomli_w.dumps(statement_of(definition, computed))
            write_text(folder / case_file(definition.name), text)
            print(f"made {definition.name}")
    files = [LICENCE_FILE]
    for definition in DEFINITIONS:
        kinds = (case_file, curves_file, *(() if definition.contact is None else (pair_file,)))
        files += [kind(definition.name) for kind in kinds]
    digits = {file: checksum((folder / file).read_bytes()) for file in files if (folder / file).exists()}
    write_text(folder / INDEX, tomli_w.dumps({"schema_version": SCHEMA_VERSION, "sha256": digits}))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Make the files of the reference cases again.")
    parser.add_argument("names", nargs="*", help="cases; default: all")
    parser.add_argument("--folder", type=Path, default=DATA, help="folder for the files")
    line = parser.parse_args()
    make(line.names, line.folder)
