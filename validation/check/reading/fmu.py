"""A functional mock-up unit (FMI 1 to 3) is simulated by FMPy, and its variables become a table.

FMPy runs in a second process, because an FMU holds machine code of somebody else. Values that the file sets
hold: its parameters are not those of the pair.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lumped.arguments import nearest
from lumped.errors import refuse, shown
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.reading.meaning import names_to_type, understood
from validation.check.reading.table import Column, Table, listed
from validation.files.matlab import check_size

#: Communication steps in a mesh cycle.
_SAMPLES = 512
#: Mesh cycles of the simulations one after the other, until the motion of half the time is that of the end.
_CYCLES = (64, 256, 1024)
#: Mesh cycles that are kept.
_KEPT = 16
#: Largest difference of both mesh cycles of a settled motion, over the motion.
_SETTLED = 1e-3
#: Rounding of a value, over the largest value.
_ROUNDING = 1e-9
#: Seconds after which a simulation is ended.
_PATIENCE = 600.0
#: Most variables that are listed in a refusal.
_LISTED = 20
_PROGRAM = """
import json, sys, numpy, fmpy
path, target, request = sys.argv[1], sys.argv[2], json.loads(sys.argv[3])
if request is None:
    description = fmpy.read_model_description(path, validate=False)
    units = {}
    for variable in description.modelVariables:
        if variable.type in ("Real", "Float64", "Float32") and variable.causality != "parameter":
            unit = variable.unit or getattr(variable.declaredType, "unit", None)
            units[variable.name] = unit
    with open(target, "w") as file:
        json.dump(units, file)
else:
    result = fmpy.simulate_fmu(path, validate=False, stop_time=request["stop"],
                               output_interval=request["step"], output=request["names"])
    numpy.savez(target, **{f"={name}": result[name] for name in result.dtype.names})
"""


class _Variable(NamedTuple):
    """Variable of an FMU: its name and its unit; None: no unit is stated."""

    name: str
    unit: str | None


def read_fmu(path: Path, pair: GearPair, field: str = "theirs", names: tuple[str, ...] = ()) -> Table:
    """Simulate an FMU until its motion repeats, and return its last mesh cycles.

    Parameters
    ----------
    path : .fmu file
    pair : the pair, whose mesh period is the period of the motion
    field : name of the argument in refusals
    names : variables to return; default: those whose names are understood

    Raises
    ------
    ParameterError : FMPy is not installed, no FMU, no variable whose name is understood, a simulation fails
    """
    if importlib.util.find_spec("fmpy") is None:
        action = "Type: pip install 'spurcheck[fmu]'."
        raise refuse(field, path, "an FMU, with FMPy installed", action)
    if not path.is_file():
        raise refuse(field, path, "a file that exists", "Check the folder and the name.")
    variables = _variables(path, field)
    chosen = _chosen(variables, names, field)
    period = pair.geometry.mesh_period
    step = period / _SAMPLES
    values: dict[str, FloatArray] = {}
    settled = False
    cycles = _CYCLES[0]
    for cycles in _CYCLES:
        request = {"stop": cycles * period, "step": step, "names": [one.name for one in chosen]}
        values = _simulated(path, request, field)
        settled = _repeats(chosen, values, cycles, period)
        if settled:
            break
    first = int(np.searchsorted(values["time"], (cycles - _KEPT - 0.5 / _SAMPLES) * period))
    columns = [Column("time", values["time"][first:], "s")]
    columns += [Column(one.name, values[one.name][first:], one.unit) for one in chosen]
    end = "" if settled else ", whose motion does not repeat yet"
    remark = f"The FMU is simulated over {cycles} mesh cycles, of which the last {_KEPT} are read{end}."
    return Table(path.stem, tuple(columns), remarks=(remark,))


def _variables(path: Path, field: str) -> list[_Variable]:
    try:
        with zipfile.ZipFile(path) as archive:
            check_size(sum(member.file_size for member in archive.infolist()))
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        why = f"It cannot be read ({shown(str(error), 120)}). Export the FMU again."
        raise refuse(field, path, "an FMU", why) from None
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "variables.json"
        _run(path, target, None, field)
        units = json.loads(target.read_text(encoding="utf-8"))
    return [_Variable(name, unit) for name, unit in units.items()]


def _chosen(variables: list[_Variable], names: tuple[str, ...], field: str) -> list[_Variable]:
    """Variables to simulate: those of the names, or those whose names are understood."""
    by_name = {one.name: one for one in variables}
    if names:
        for name in names:
            if name not in by_name:
                action = nearest(name, by_name) or "Correct the name of the variable."
                raise refuse(field, shown(name), f"one of {listed(tuple(by_name), _LISTED)}", action)
        return [by_name[name] for name in names]
    chosen = [one for one in variables if understood(one.name) is not None]
    if not chosen:
        allowed = f"an FMU with a variable named by one of {', '.join(names_to_type())}"
        action = (
            "Rename the outputs, or name them as columns in a description: a .toml file with data = 'x.fmu'."
        )
        raise refuse(field, listed(tuple(by_name), _LISTED) or "no variables", allowed, action)
    return chosen


def _simulated(path: Path, request: dict[str, Any], field: str) -> dict[str, FloatArray]:
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "result.npz"
        _run(path, target, request, field)
        with np.load(target, allow_pickle=False) as file:
            return {name[1:]: np.asarray(file[name], dtype=np.float64) for name in file}


def _run(path: Path, target: Path, request: dict[str, Any] | None, field: str) -> None:
    """Run FMPy in a second process, or refuse the FMU with the last line of its error."""
    command = [sys.executable, "-P", "-c", _PROGRAM, str(path), str(target), json.dumps(request)]
    why = ""
    try:
        run = subprocess.run(command, capture_output=True, check=False, timeout=_PATIENCE)
        if run.returncode or not target.is_file():
            *_, why = run.stderr.decode(errors="replace").strip().split("\n")
            why = why or "the process that simulates it has ended"
    except subprocess.TimeoutExpired:
        why = f"a simulation takes more than {_PATIENCE:.0f} s"
    if why:
        action = f"It cannot be simulated ({shown(why, 200)}). Try: fmpy simulate {path.name}."
        raise refuse(field, path, "an FMU that FMPy simulates", action)


def _repeats(chosen: list[_Variable], values: dict[str, FloatArray], cycles: int, period: float) -> bool:
    """Whether the last mesh cycle is that of half the time, of all variables."""
    phases = np.arange(_SAMPLES) / _SAMPLES - 1.0
    for one in chosen:
        known = understood(one.name)
        is_rotation = known is not None and known.meaning.quantity in ("theta_p", "theta_g")
        late, early = (
            _cycle(values["time"], values[one.name], (cycles - back + phases) * period, is_rotation)
            for back in (0, cycles // 2)
        )
        rounding = _ROUNDING * float(np.abs(values[one.name]).max())
        if np.abs(late - early).max() > _SETTLED * float(np.ptp(late)) + rounding:
            return False
    return True


def _cycle(time: FloatArray, values: FloatArray, places: FloatArray, is_rotation: bool) -> FloatArray:
    """Samples of one mesh cycle; of a rotation without its mean and its trend over the mesh cycle."""
    cycle = np.interp(places, time, values)
    if not is_rotation:
        return cycle
    period = places[-1] - places[0] + places[1] - places[0]
    start, end = np.interp([places[0], places[0] + period], time, values)
    cycle = cycle - (end - start) * (places - places[0]) / period
    return np.asarray(cycle - cycle.mean())
