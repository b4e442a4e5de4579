"""Is the one-degree-of-freedom pair with Coulomb friction exact, and is it the gear on rigid bearings?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import CoulombGearPair, monodromy, stability_zones
from floquet.gear.coulomb_zones import coulomb_gear_pair
from lumped import geometry, load_gear_pair, periodic_system
from lumped.errors import ParameterError
from lumped.model.bodies import bodies

MU = 0.2


@pytest.mark.parametrize("sign", ["reversing", "constant"])
@pytest.mark.parametrize("damping", [0.0, 0.05, 1.6])  # the last one overdamped in some or all pieces
def test_multipliers_are_those_of_the_engine(sign: str, damping: float) -> None:
    pair = CoulombGearPair(damping_ratio=damping, friction=MU, sign=sign)
    for ratio in (0.13, 1.9):
        found = monodromy(pair.system(ratio), 1e-11).multipliers
        assert np.allclose(np.abs(pair.multipliers(ratio)), np.abs(found), rtol=1e-6, atol=1e-12)


def test_a_gear_pair_has_the_pieces_and_gains_of_its_equations() -> None:
    gear = load_gear_pair("nasa_28_28").with_(
        mesh__relief="ignored", friction__law="coulomb", friction__coefficient=MU
    )
    system = periodic_system(gear, "mesh")
    g, edges = geometry(gear), system.cycle.edges
    middle = 0.5 * (edges[:-1] + edges[1:])
    pair = coulomb_gear_pair(gear, MU)
    mean = system.cycle.sample(middle).stiffness.max() * g.contact_ratio / bodies(gear).effective_mass
    assert np.allclose(pair.phases * g.mesh_period, edges, rtol=0, atol=1e-12 * g.mesh_period)
    assert np.allclose(-system.gain(middle).stiffness[:, 0] / mean, pair.gains, rtol=1e-12)
    # Approach and recess are equally long, so that friction leaves the mean stiffness alone.
    assert pair.gains @ np.diff(pair.phases) == pytest.approx(1.0, rel=1e-14)


def test_zones_over_speed_and_damping() -> None:
    zones = stability_zones(CoulombGearPair(friction=MU), np.linspace(0.6, 2.4, 91), [0.0, 0.01, 0.3])
    radius = zones["spectral_radius"]
    # 20 times the damping that closes the principal tongue: nothing is unstable.
    assert (radius.sel(damping_ratio=0.3) < 1.0).all()
    assert (radius.sel(damping_ratio=0.01).max("speed_ratio") > 1.0).all()
    for sign in ("reversing", "constant"):
        pair = CoulombGearPair(friction=MU, sign=sign, damping_ratio=0.01)
        ratio = float(zones.speed_ratio[70])
        exact = monodromy(pair.system(ratio), 1e-11).spectral_radius
        found = radius.sel(friction=sign, damping_ratio=0.01, speed_ratio=ratio)
        assert float(found) == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize(
    "bad", [{"contact_ratio": 2.1}, {"damping_ratio": -0.1}, {"friction": 1.0}, {"pressure_angle": 20.0}]
)
def test_bad_parameters_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ParameterError, match=next(iter(bad))):
        CoulombGearPair(**bad)
    with pytest.raises(ParameterError, match="speed_ratio"):
        CoulombGearPair().system(0.0)
