"""Is the mesh between two rotors that of the gear pair?"""

from __future__ import annotations

import numpy as np
import pytest

import lumped
from floquet import GearRotor, gear_pair_multipliers, gears_on_rotors, monodromy
from floquet.gear.rotors import _deflection
from lumped.errors import ParameterError
from lumped.model.mesh_cycle import mesh_cycle

PAIR = lumped.load_gear_pair("nasa_28_28").with_(
    friction__law="none",
    mesh__relief="ignored",
    mesh__stiffness={"model": "parabolic"},
    mesh__damping_ratio=0.01,
    operating__pinion_speed="16500 rpm",
    bearings__gear__loa_stiffness=2.5e8,
    bearings__gear__oloa_stiffness=2.5e8,
)


def rigid(which: str, moved: int) -> GearRotor:
    """A gear on its bearings, which are the same in all directions; its coordinates turned round."""
    body, bearings = lumped.bodies(PAIR), getattr(PAIR.bearings, which)
    m, J = getattr(body, f"mass_{which}"), getattr(body, f"inertia_{which}")
    c = lumped.periodic_system(PAIR, "full").structure.damping[2 if which == "pinion" else 3]
    M, C, K = (
        np.diag(np.roll(values, moved))
        for values in ([m, m, J], [c, c, 0.0], [bearings.loa_stiffness] * 2 + [0.0])
    )
    return GearRotor(M, C, K, tuple((np.arange(3) + moved) % 3))


def test_rigid_shafts_are_the_lumped_pair():
    expected = gear_pair_multipliers(PAIR)
    found = monodromy(gears_on_rotors(PAIR, rigid("pinion", 0), rigid("gear", 1), centre_angle=2.0))
    assert found.certificate == "proven"
    assert found.verdict == expected.verdict
    assert found.multipliers.size == 10  # the free turn is gone
    moduli = np.sort(np.abs(found.multipliers)), np.sort(np.abs(expected.multipliers))
    np.testing.assert_allclose(*moduli, rtol=1e-8)


def test_teeth_approach_as_the_involute_says():
    pinion, gear = rigid("pinion", 0), rigid("gear", 2)
    g, angle = PAIR.geometry, 0.4
    v = _deflection(mesh_cycle(PAIR), pinion, gear, angle)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    for station, sign in ((pinion.station, 1.0), (3 + np.array(gear.station), -1.0)):
        x, y, _ = station
        # Towards each other by 1 is deeper by sin a, past each other by cos a; no approach in rolling.
        assert v[[x, y]] @ along == pytest.approx(sign * np.sin(g.operating_pressure_angle))
        assert v[[x, y]] @ across == pytest.approx(sign * np.cos(g.operating_pressure_angle))
    assert v[2] == g.base_radius_pinion
    assert v[3 + gear.station[2]] == g.base_radius_gear


def test_what_is_no_rotor_is_refused():
    one, two = np.eye(3), (0, 1, 2)
    with pytest.raises(ParameterError, match="station"):
        GearRotor(one, one, one, (0, 1, 1))
    with pytest.raises(ParameterError, match=r"C = shape \(2, 2\)"):
        GearRotor(one, np.eye(2), one, two)
    with pytest.raises(ParameterError, match="gear = "):
        gears_on_rotors(PAIR, GearRotor(one, one, one, two), one)
    massless = GearRotor(np.diag([1.0, 1.0, 0.0]), one, one, two)
    with pytest.raises(ParameterError, match="positive definite"):
        gears_on_rotors(PAIR, massless, massless)
