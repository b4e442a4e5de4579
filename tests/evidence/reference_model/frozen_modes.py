"""Natural frequencies of the machine with frozen mesh: exudyn's own linearisation beside the lumped model's.

exudyn differentiates the forces of the assembled system at its initial values. At fidelity "linear" that must
be the lumped matrix A(t) of the same instant. At fidelity "exact" the line of action turns with the gear
centres: the total normal load N acts as a spring -N/L_XY between y_p and y_g, which the lumped model has not.

Sources: docs/theory/multibody.md, "Two builds of one machine".
"""

from dataclasses import replace

import exudyn as exu
import numpy as np
from scipy.optimize import root

from lumped.model.periodic_system import periodic_system
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray
from multibody.contact import layout as kn
from multibody.run.model import ExudynModel, accelerations, build, contact_state
from multibody.run.setup import Setup, prepare

#: Largest residual acceleration of the loaded teeth over that of the load on a free body.
_AT_REST = 1e-9


def frozen_modes(pair: GearPair, phase: float = 0.3) -> dict[str, FloatArray]:
    """Natural frequencies [Hz] and damping ratios with the mesh frozen at a phase: source -> (2, modes)."""
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
    return {
        "exudyn linear": modes_of(linearised(straight, np.zeros(6))),
        "exudyn exact": modes_of(linearised(moving, q)),
        "lumped frozen": modes_of(np.linalg.eigvals(matrix).astype(np.complex128)),
        "lumped turned line": modes_of(np.linalg.eigvals(turned).astype(np.complex128)),
    }


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
    assert np.abs(residual(found.x)).max() < _AT_REST, "no rest at this phase: take one away from a switch"
    return np.asarray(q + scale * found.x / lengths, dtype=np.float64)


def linearised(model: ExudynModel, q: FloatArray) -> ComplexArray:
    """Eigenvalues of exudyn's linearisation about a position, without those of the free rotation."""
    initial = exu.ConfigurationType.Initial
    model.system.systemData.SetODE2Coordinates(q.tolist(), configuration=initial)
    model.system.systemData.SetODE2Coordinates_t([0.0] * q.size, configuration=initial)
    roots = model.system.ComputeODE2Eigenvalues(computeComplexEigenvalues=True, useAbsoluteValues=False)[0]
    values = np.asarray(roots, dtype=np.complex128)
    return values[np.argsort(np.abs(values))[2:]]


def modes_of(roots: ComplexArray) -> FloatArray:
    """Natural frequencies [Hz] and damping ratios of the roots that oscillate, by frequency, (2, m)."""
    upper = roots[roots.imag > 0.0]
    upper = upper[np.argsort(np.abs(upper))]
    return np.stack([np.abs(upper) / (2.0 * np.pi), -upper.real / np.abs(upper)])
