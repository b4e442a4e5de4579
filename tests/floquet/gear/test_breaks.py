"""Do knots of tables end pieces everywhere, and is the misfit of the gains a bound between samples too?"""

import numpy as np
import pytest

from floquet.gear.axes import GearVariation
from floquet.gear.block import feedback_system
from floquet.gear.multipliers import OffLineOfAction
from lumped import GearPair, load_gear_pair
from lumped.model.averaged import averaged_matrix
from lumped.model.mesh_cycle import mesh_cycle
from lumped.model.periodic_system import periodic_system


def with_table(points: int, factor: float) -> GearPair:
    """A constant table with one sample that stands out."""
    pair = load_gear_pair("nasa_28_28").with_(
        {"mesh.contact": "prescribed", "friction.law": "none", "mesh.damping_ratio": 0.02}
    )
    stiffness = np.full(points, 60e6)
    stiffness[int(0.437 * points)] *= factor
    table = {
        "model": "table", "axis": "phase", "stiffness": stiffness.tolist(),
        "points": np.linspace(0.0, pair.geometry.contact_ratio, points).tolist(),
    }  # fmt: skip
    return pair.with_({"mesh.stiffness": table})


def test_breaks_hold_every_knot_of_every_law() -> None:
    for pair in (
        with_table(1000, 3.0),
        load_gear_pair("fzg_c").with_(mesh__contact="prescribed", friction__law="benedict_kelley"),
    ):
        cycle = mesh_cycle(pair)
        g, e = cycle.geometry, cycle.elements
        for law in (e.stiffness, e.damping, e.friction, e.error):
            times = np.mod((law.breaks - g.L_XA) / g.base_pitch, 1.0) * cycle.period
            assert np.abs(times[:, None] - cycle.breaks).min(axis=1).max() <= 1e-13 * cycle.period
        assert np.isin(cycle.edges, cycle.breaks).all()
        assert set(cycle.breaks) - {0.0, cycle.period} == set(periodic_system(pair).breakpoints)


def test_the_average_of_a_table_is_exact() -> None:
    system = periodic_system(with_table(400, 50.0), "mesh")
    mean = system.cycle.elements.stiffness.mean() * system.cycle.geometry.contact_ratio
    direct = averaged_matrix(system)[3:, :3] - system.constant[3:, :3]
    per_stiffness = (system.structure.normal / system.structure.mass) @ system.reduction.T
    assert direct == pytest.approx(mean * np.outer(per_stiffness, system.deflection), rel=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 1.0 - 1e-15, 1.0 + 1e-12, 0.3])
def test_bearings_at_critical_damping_are_within_their_bound(ratio: float) -> None:
    pair = load_gear_pair("nasa_28_28").with_(
        {"mesh.contact": "prescribed", "bearings.pinion.oloa_damping_ratio": min(ratio, 1.0)}
    )
    system = periodic_system(pair, "elastic")
    T = np.array([system.period])
    values, errors = OffLineOfAction.of(feedback_system(GearVariation(pair))).multipliers(T)
    s = system.structure
    omega = np.sqrt(s.stiffness[4] / s.mass[4])
    zeta = min(ratio, 1.0)
    root = np.emath.sqrt(zeta**2 - 1.0)
    exact = np.exp(omega * system.period * np.array([-zeta + root, -zeta - root]))
    assert (np.abs(values[0, [0, 2]] - exact) <= errors[0, [0, 2]]).all()
    if ratio == 0.3:
        assert errors[0, [0, 2]].max() < 1e-14
