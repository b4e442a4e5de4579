"""Campbell diagram of a gear pair: frequencies over speed, with the speeds at which tongues are expected.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from floquet.engine.tongues import mode_shares, tongue_coordinates
from floquet.gear.axes import vary
from floquet.gear.multipliers import gear_block
from floquet.gear.tongues import predicted_lines
from floquet.rank_one.batch import fast_monodromies
from lumped.arguments import real_number, real_numbers, whole_number
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset, provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import ComplexArray, FloatArray

if TYPE_CHECKING:
    import xarray as xr


def campbell(
    pair: AnyPair, speeds_rpm: npt.ArrayLike, *, mesh_orders: int = 6, orders: int = 6, rtol: float = 1e-9
) -> xr.Dataset:
    """Frequencies of the Floquet solutions over speed, against mesh orders and predicted tongues.

    A multiplier fixes its frequency up to multiples of the mesh frequency only. The branch is resolved by the
    mode shape: a solution belongs to the mode of the mean system in which it has the largest share of action,
    turning forwards, and its frequency is the branch nearest to that mode's. Six multipliers make three such
    solutions and their conjugates. In a tongue the growing solution stands for the mode.

    Parameters
    ----------
    pair : the gear pair
    speeds_rpm : (k,) pinion speeds [rpm], increasing
    mesh_orders : multiples of the mesh frequency to list
    orders : largest order k of the predicted lines (omega_i +- omega_j)/k
    rtol : of the monodromy matrices

    Returns
    -------
    Dataset over ``speed_rpm``, ``mode``, ``mesh_order`` and ``line``: ``frequency`` and ``decay`` [1/s] of
    the Floquet solution of each mode (speed_rpm, mode); ``natural_frequency`` of the mean system (mode);
    ``mesh_frequency`` (speed_rpm, mesh_order); ``line_speed`` [rpm] and ``line_frequency``, the mesh
    frequency there (line, with the labels in ``label``) inside the range, for modes that deflect the mesh;
    ``spectral_radius`` of the feedback block.

    Raises
    ------
    ParameterError : speeds that are not increasing
    NumericalError
        A speed so low that a multiplier is too small for a number.
    """
    pair = load_gear_pair(pair)
    speeds = real_numbers("speeds_rpm", speeds_rpm, 0.0, above=True, increasing=True, unit="rpm")
    mesh_orders = whole_number("mesh_orders", mesh_orders, 1, 1000)
    rtol = real_number("rtol", rtol, 1e-13, 1e-3)
    mean = gear_block(pair).modal()
    modes = mean.omega
    # A mode that leaves the dynamic transmission error alone feeds nothing back: no tongue can involve it.
    meshing = np.abs(mean.v) > 1e-9 * np.abs(mean.v).max()
    frequency, decay = np.empty((speeds.size, modes.size)), np.empty((speeds.size, modes.size))
    radius = np.empty(speeds.size)
    for index, speed in enumerate(speeds):
        block = gear_block(vary(pair, {"speed_rpm": float(speed)}))
        matrix = fast_monodromies(block, tolerance=0.01 * rtol).matrices[0]
        omega = block.modal().omega
        exponents = _exponents_by_mode(matrix, omega, block.period)
        if not np.isfinite(exponents).all():
            raise NumericalError(
                f"At {speed:g} rpm a mode dies out within one mesh cycle: its multiplier is too small for a "
                "number. Raise the lowest speed."
            )
        frequency[index] = exponents.imag / (2.0 * np.pi)
        decay[index] = -exponents.real
        radius[index] = np.exp(exponents.real.max() * block.period)
    teeth, mesh_order = pair.pinion.teeth, np.arange(1, mesh_orders + 1)
    mesh = speeds[:, None] * teeth / 60.0 * mesh_order
    lines = {
        tongue: speed
        for tongue, speed in predicted_lines(pair, orders).items()
        if speeds[0] <= speed <= speeds[-1] and meshing[tongue.mode_i - 1] and meshing[tongue.mode_j - 1]
    }
    line_speed = np.array(list(lines.values()))
    each, orders_over = ("speed_rpm", "mode"), ("speed_rpm", "mesh_order")
    return labelled_dataset(
        {
            "frequency": (each, frequency, "Hz", "frequency of the Floquet solution"),
            "decay": (each, decay, "1/s", "decay rate, < 0 growth"),
            "natural_frequency": ("mode", modes / (2.0 * np.pi), "Hz", "that of the mean system"),
            "mesh_frequency": (orders_over, mesh, "Hz", "multiples of the mesh frequency"),
            "line_speed": ("line", line_speed, "rpm", "predicted speed of a tongue"),
            "line_frequency": ("line", line_speed * teeth / 60.0, "Hz", "mesh frequency on the line"),
            "spectral_radius": ("speed_rpm", radius, "1", "spectral radius"),
        },
        {
            "speed_rpm": (speeds, "rpm", "pinion speed"),
            "mode": (np.arange(1, modes.size + 1), "1", "mode of the mean system"),
            "mesh_order": (mesh_order, "1", "multiple of the mesh frequency"),
        },
        provenance(pair) | {"title": f"Campbell diagram of {pair.name}"},
    ).assign_coords(tongue_coordinates("line", lines))


def _exponents_by_mode(matrix: FloatArray, omega: FloatArray, period: float) -> ComplexArray:
    """Exponent (m,) [1/s] of the solution that belongs to each mode, on the branch near its frequency."""
    values, vectors = np.linalg.eig(matrix)
    forward = np.stack([mode_shares(x, omega)[0] for x in vectors.T])
    # Each mode gets a solution of its own. In a tongue a growing and a decaying one share the mode equally:
    # the slight preference for the larger modulus takes the growing one.
    modulus = np.abs(values)
    solution, mode = linear_sum_assignment(-forward * (1.0 + 0.01 * modulus / modulus.max())[:, None])
    chosen = values[solution[np.argsort(mode)]].astype(complex)
    # A multiplier that is zero, or so small that it has lost its digits, has no exponent.
    chosen[np.abs(chosen) < np.finfo(np.float64).tiny] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        principal = np.log(chosen) / period
    mesh = 2.0 * np.pi / period
    return np.asarray(principal + 1j * mesh * np.round((omega - principal.imag) / mesh))
