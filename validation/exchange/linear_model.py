"""The averaged gear pair as a linear model for python-control, SciPy, NumPy and MATLAB."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import scipy.signal

from lumped.arguments import file_path
from lumped.model.averaged import averaged_state_space
from lumped.model.periodic_system import Form
from lumped.schema.files import AnyPair, load_gear_pair
from validation.files.output import check_file, save_mat, whole_file

STATE_SPACE_SUFFIXES = (".mat", ".npz")


def scipy_state_space(pair: AnyPair, form: Form = "elastic") -> scipy.signal.StateSpace:
    """Return the time-averaged pair as a SciPy state space.

    For python-control, ``lumped.model.averaged.averaged_state_space`` returns the same model with named
    signals.

    Parameters
    ----------
    pair : a validated gear pair
    form : "elastic" (10 states) or "mesh" (6 states)

    Returns
    -------
    scipy.signal.StateSpace from (T_p, T_g) [N m] to (dte, x_p, x_g) [m]

    Raises
    ------
    ParameterError : form "full", which has no steady response
    """
    pair = load_gear_pair(pair)
    plant = averaged_state_space(pair, form)
    return scipy.signal.StateSpace(plant.A, plant.B, plant.C, plant.D)


def write_state_space(
    pair: AnyPair, path: str | Path, form: Form = "elastic", *, force: bool = False
) -> Path:
    """Write the time-averaged pair as a file of its matrices.

    ``sys = ss(A, B, C, D)`` in MATLAB; ``control.ss(f["A"], f["B"], f["C"], f["D"])`` or
    ``scipy.signal.StateSpace(...)`` of the same four in Python, with ``f = numpy.load(path)``.

    Parameters
    ----------
    pair : a validated gear pair
    path : .mat (MATLAB 5) or .npz (NumPy, without pickled objects)
    form : "elastic" (10 states) or "mesh" (6 states)
    force : overwrite an existing file

    Returns
    -------
    Path that was written; besides A, B, C, D it holds the names ``inputs`` [N m], ``outputs`` [m], ``states``
    (cell arrays in MATLAB), ``gear_pair`` and ``parameters`` (TOML)

    Raises
    ------
    ParameterError : form "full", an unknown suffix, or an existing file without ``force``
    """
    pair = load_gear_pair(pair)
    path = check_file(file_path("path", path), STATE_SPACE_SUFFIXES, force=force)
    plant = averaged_state_space(pair, form)
    matlab = path.suffix.lower() == ".mat"

    def names(labels: list[str]) -> np.ndarray[tuple[int], np.dtype[Any]]:
        return np.array(labels, dtype=object if matlab else np.str_)

    contents = {
        "A": plant.A,
        "B": plant.B,
        "C": plant.C,
        "D": plant.D,
        "inputs": names(plant.input_labels),
        "outputs": names(plant.output_labels),
        "states": names(plant.state_labels),
        "gear_pair": pair.name,
        "parameters": pair.to_toml(),
    }
    with whole_file(path) as temporary:
        if matlab:
            save_mat(contents, temporary)
        else:
            np.savez(temporary, **contents)
    return path
