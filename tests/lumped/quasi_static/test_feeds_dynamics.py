"""Does the linear dynamic model with static relief run into the static transmission error at low speed?"""

import numpy as np
import pytest

from lumped import geometry, load_gear_pair, mesh_elements, steady_state
from lumped.quasi_static import static_transmission_error


def relieved(**changes):
    return load_gear_pair("nasa_28_28").with_(
        {
            "mesh.contact": "prescribed",
            "mesh.relief": "static", "mesh.stiffness": {"model": "energy"}, "operating.pinion_torque": 56.5,
            "friction.law": "none", **changes,
        }
    )  # fmt: skip


def test_elements_carry_the_error_and_the_loaded_contact():
    pair = relieved()
    g, e = geometry(pair), mesh_elements(pair)
    assert float(e.error(g.L_XD)) == pytest.approx(
        23e-6, rel=1e-9
    )  # amount of the preset's relief at the tip
    assert float(e.stiffness(g.L_XA + 1e-6)) == 0.0  # 56.5 N m do not close 23 um
    assert float(e.damping(g.L_XA + 1e-6)) == pytest.approx(0.0, abs=1e-9)


def test_slow_running_is_quasi_static():
    exact = static_transmission_error(relieved(), phases=512, extended=False).transmission_error.values[0]
    differences = []
    for rpm in (400.0, 100.0):
        dte = steady_state(relieved(**{"operating.pinion_speed": rpm}), samples_per_cycle=512).dte.values
        differences.append(np.sqrt(np.mean((dte[:512] - exact) ** 2)) / np.ptp(exact))
    # Inertia forces grow with the square of the speed and damping with the speed; kinks of k and e ring.
    assert differences[1] < 3e-3
    assert differences[1] < differences[0] / 4
