"""Natural frequencies of the machine with frozen mesh: exudyn's own linearisation beside the lumped model's.

exudyn differentiates the forces of the assembled system at its initial values. At fidelity "linear" that must
be the lumped matrix A(t) of the same instant. At fidelity "exact" the line of action turns with the gear
centres: the total normal load N acts as a spring -N/L_XY between y_p and y_g, which the lumped model has not.

Sources: docs/theory/multibody.md, "Three builds of one machine".
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import exudyn as exu
import numpy as np
from scipy.optimize import root

from lumped.arguments import real_number
from lumped.errors import NumericalError
from lumped.labelling import labelled_dataset
from lumped.model.averaged import averaged_matrix
from lumped.model.periodic_system import periodic_system
from lumped.model.results import provenance
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import ComplexArray, FloatArray
from multibody.contact import kernels as kn
from multibody.run.model import ExudynModel, accelerations, build, contact_state
from multibody.run.setup import Setup, prepare

if TYPE_CHECKING:
    import xarray as xr

SOURCES = {
    "exudyn linear": "exudyn's linearisation, fidelity linear",
    "exudyn exact": "exudyn's linearisation, fidelity exact, about the loaded teeth",
    "lumped frozen": "lumped A(t) at the phase",
    "lumped turned line": "lumped A(t) with the spring of the turned line of action",
    "lumped averaged": "lumped mean of A(t) over the mesh cycle",
}
#: Largest residual acceleration of the loaded teeth over that of the load on a free body.
_AT_REST = 1e-9


def frozen_modes(pair: AnyPair, phase: float = 0.3) -> xr.Dataset:
    """Compare natural frequencies and damping ratios of the pair with the mesh frozen at a phase.

    Parameters
    ----------
    pair : a validated gear pair
    phase : of the mesh cycle, 0 to 1 without the ends; pair n is at A at 0

    Returns
    -------
    xarray.Dataset over ``source`` (keys of ``SOURCES``) and ``mode`` by increasing frequency:
    ``natural_frequency`` [Hz] and ``damping_ratio`` [-]; the attribute ``normal_load`` is N [N]

    Raises
    ------
    ParameterError : the phase is out of range
    NumericalError : a mode is overdamped, or the loaded teeth find no rest at this phase
    """
    pair = load_gear_pair(pair)
    phase = real_number("phase", phase, 1e-9, 1.0 - 1e-9)
    linear, exact = (prepare(pair, fidelity) for fidelity in ("linear", "exact"))
    time = phase * linear.machine.period
    straight, moving = held(linear, time), held(exact, time)
    q = _at_rest(moving, time, exact.q, exact.deflection)
    _, contacts, counts = contact_state(moving, np.array([time]), q[None], np.zeros((1, 6)))
    load = float(contacts[0, : counts[0], kn.LOAD].sum())
    system = periodic_system(pair, "elastic")
    matrix = system.A(time)
    turned = matrix.copy()
    spring = load / float(exact.machine.parameters[kn.L_XY]) * np.array([[1.0, -1.0], [-1.0, 1.0]])
    turned[8:, 3:5] += spring / exact.machine.mass[:, None]
    found = {
        "exudyn linear": _modes(_without_turn(linearised(straight, np.zeros(6))[0])),
        "exudyn exact": _modes(_without_turn(linearised(moving, q)[0])),
        "lumped frozen": _modes(np.linalg.eigvals(matrix).astype(np.complex128)),
        "lumped turned line": _modes(np.linalg.eigvals(turned).astype(np.complex128)),
        "lumped averaged": _modes(np.linalg.eigvals(averaged_matrix(system)).astype(np.complex128)),
    }
    table = np.array([found[name] for name in SOURCES])
    return labelled_dataset(
        {
            "natural_frequency": (("source", "mode"), table[:, 0], "Hz", "undamped natural frequency"),
            "damping_ratio": (("source", "mode"), table[:, 1], "1", "damping ratio"),
        },
        {
            "source": (list(SOURCES), "1", "where the modes come from"),
            "mode": (np.arange(1, table.shape[2] + 1), "1", "mode by increasing frequency"),
        },
        provenance(pair, phase=phase) | {"normal_load": load},
    )


def held(setup: Setup, time: float) -> ExudynModel:
    """The model of a set-up with the nominal rotation held at a time; nominal speeds go on sliding."""
    parameters = setup.machine.parameters.copy()
    parameters[[kn.T_LOW, kn.T_HIGH]] = time
    return build(replace(setup.machine, parameters=parameters), setup.model.flags, setup.model.budget.limit)


def _at_rest(model: ExudynModel, time: float, q: FloatArray, scale: float) -> FloatArray:
    """Loaded position near q; the free rotation of the train is held, and its acceleration is left out."""
    p, inertia = model.parameters, model.machine.inertia
    rigid = np.array([1.0 / p[kn.RADIUS_P], -1.0 / p[kn.RADIUS_G]])  # leaves the overlap as it is
    size = model.machine.torque_pinion / float(p[kn.RADIUS_P]) / float(model.machine.mass.min())
    lengths = np.array([1.0, 1.0, p[kn.RADIUS_P], 1.0, 1.0, p[kn.RADIUS_G]])

    def residual(x: FloatArray) -> FloatArray:
        state = q + scale * x / lengths
        a = accelerations(model, np.array([time]), state[None], np.zeros((1, 6)))[0] * lengths / size
        a[5] += a[2]  # acceleration of the overlap
        a[2] = (state[[2, 5]] - q[[2, 5]]) * inertia @ rigid / (scale * inertia @ rigid**2)
        return np.asarray(a, dtype=np.float64)

    found = root(residual, np.zeros(6), tol=1e-13)
    if not np.abs(residual(found.x)).max() < _AT_REST:
        raise NumericalError("The loaded teeth find no rest at this phase; take one away from a switch.")
    return np.asarray(q + scale * found.x / lengths, dtype=np.float64)


def linearised(model: ExudynModel, q: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Eigenvalues (2n,) and vectors, in columns, of exudyn's linearisation about a position."""
    initial = exu.ConfigurationType.Initial
    model.system.systemData.SetODE2Coordinates(q.tolist(), configuration=initial)
    model.system.systemData.SetODE2Coordinates_t([0.0] * q.size, configuration=initial)
    found = model.system.ComputeODE2Eigenvalues(computeComplexEigenvalues=True, useAbsoluteValues=False)
    values, vectors = (np.asarray(x, dtype=np.complex128) for x in found[:2])
    return values, vectors


def _without_turn(roots: ComplexArray) -> ComplexArray:
    """Roots without those of the free rotation."""
    return roots[np.argsort(np.abs(roots))[2:]]


def _modes(roots: ComplexArray) -> FloatArray:
    """Natural frequencies [Hz] and damping ratios of conjugate roots, by frequency, (2, m)."""
    upper = roots[roots.imag > 0.0]
    if 2 * upper.size != roots.size:
        raise NumericalError("A mode of the frozen pair is overdamped: lower the damping ratios.")
    upper = upper[np.argsort(np.abs(upper))]
    return np.stack([np.abs(upper) / (2.0 * np.pi), -upper.real / np.abs(upper)])
