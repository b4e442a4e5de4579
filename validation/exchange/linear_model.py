"""The averaged gear pair as a linear model for python-control, SciPy and MATLAB."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import scipy.signal

from lumped.averaged import averaged_state_space
from lumped.errors import refuse
from lumped.parameters import GearPair
from lumped.periodic_system import Form
from validation.exchange.results import write_mat
from validation.output import check_file


def scipy_state_space(pair: GearPair, form: Form = "relative") -> scipy.signal.StateSpace:
    """Return the time-averaged pair as a SciPy state space.

    For python-control, ``lumped.averaged.averaged_state_space`` returns the same model with named signals.

    Parameters
    ----------
    pair : a validated gear pair
    form : "relative" (10 states) or "feedback" (6 states)

    Returns
    -------
    scipy.signal.StateSpace from (T_p, T_g) [N m] to (dte, x_p, x_g) [m]

    Raises
    ------
    ParameterError : form "absolute", which has no steady response
    """
    plant = averaged_state_space(pair, form)
    return scipy.signal.StateSpace(plant.A, plant.B, plant.C, plant.D)


def write_state_space(
    pair: GearPair, path: str | Path, form: Form = "relative", *, force: bool = False
) -> Path:
    """Write the time-averaged pair as a MATLAB file: ``sys = ss(A, B, C, D)`` there.

    Parameters
    ----------
    pair : a validated gear pair
    path : .mat file
    form : "relative" (10 states) or "feedback" (6 states)
    force : overwrite an existing file

    Returns
    -------
    Path that was written; besides A, B, C, D it holds the names ``inputs`` [N m], ``outputs`` [m], ``states``
    as cell arrays, ``gear_pair`` and ``parameters`` (TOML)

    Raises
    ------
    ParameterError : form "absolute", an unknown suffix, or an existing file without ``force``
    """
    if form not in ("relative", "feedback"):
        raise refuse("form", form, "relative or feedback", "The rigid rotation has no steady response.")
    path = check_file(Path(path), (".mat",), force=force)
    plant = averaged_state_space(pair, form)

    def cells(names: list[str]) -> np.ndarray[tuple[int], np.dtype[np.object_]]:
        return np.array(names, dtype=object)

    write_mat(
        {
            "A": plant.A,
            "B": plant.B,
            "C": plant.C,
            "D": plant.D,
            "inputs": cells(plant.input_labels),
            "outputs": cells(plant.output_labels),
            "states": cells(plant.state_labels),
            "gear_pair": pair.name,
            "parameters": pair.to_toml(),
        },
        path,
    )
    return path
