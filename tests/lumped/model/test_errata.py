"""Is each printed sign of eqs. 1, 2, 7 and 9 wrong, shown by statics, third law and power?"""

import numpy as np
import pytest

from lumped import geometry, periodic_system, simulate, steady_state
from lumped.model.equations import structure


def static_torques(pair, xi, mu, as_printed=()):
    """T_p and T_g per unit normal load of one pair at xi that keep both gears at constant speed."""
    s = structure(pair, as_printed)
    per_load = s.normal + mu * s.friction(np.array(xi))
    return -per_load[0], per_load[1]


def efficiency(pair, xi, mu, as_printed=()):
    t_p, t_g = static_torques(pair, xi, mu, as_printed)
    g = geometry(pair)
    return t_g * g.omega_gear / (t_p * g.omega_pinion)


class TestEquation1:
    def test_efficiency_by_statics(self, nasa):
        # 28/28, mu 0.05 in recess at xi = 21 mm: r_b 41.7693, arms 21 and 30.4056 - 21 = 9.4056 mm.
        assert efficiency(nasa, 21e-3, 0.05) == pytest.approx(
            (41.7693 + 0.05 * 9.4056) / (41.7693 + 0.05 * 21), abs=1e-6
        )
        assert efficiency(nasa, 21e-3, 0.05, (1,)) == pytest.approx(1.037, abs=5e-4)

    @pytest.mark.parametrize("pair_name", ["nasa", "unequal", "high_contact"])
    def test_friction_takes_power_everywhere_on_the_path(self, pair_name, request):
        pair = request.getfixturevalue(pair_name)
        g = geometry(pair)
        for xi in np.linspace(g.L_XA, g.L_XD, 41):
            s = np.sign(xi - g.L_XP)
            assert efficiency(pair, xi, 0.05 * s) <= 1.0 + 1e-15
            # Lost power over unit normal load: mu times the sliding velocity.
            t_p, t_g = static_torques(pair, xi, 0.05 * s)
            sliding = abs(g.omega_pinion * xi - g.omega_gear * (g.L_XY - xi))
            assert t_p * g.omega_pinion - t_g * g.omega_gear == pytest.approx(0.05 * sliding, abs=1e-9)

    def test_as_printed_friction_gives_power_in_recess(self, nasa):
        g = geometry(nasa)
        recess = np.linspace(g.L_XP, g.L_XD, 20)[1:]
        assert all(efficiency(nasa, xi, 0.05, (1,)) > 1.0 for xi in recess)

    def test_as_printed_the_pair_makes_energy_over_a_cycle(self, coulomb_pair):
        """The printed moments add up: friction drives the pinion where it brakes it."""
        repaired = steady_state(coulomb_pair).attrs["mesh_efficiency"]
        printed = steady_state(coulomb_pair, as_printed=(1,)).attrs["mesh_efficiency"]
        assert repaired < 1.0
        assert printed != pytest.approx(repaired, abs=1e-3)


class TestEquation2:
    def test_the_gear_would_not_be_driven(self, nasa):
        t_p, t_g = static_torques(nasa, 15e-3, 0.0)
        assert t_g / t_p == pytest.approx(1.0, rel=1e-14)
        t_p, t_g = static_torques(nasa, 15e-3, 0.0, (2,))
        assert t_g / t_p == pytest.approx(-1.0, rel=1e-14)

    def test_the_gear_runs_away(self, coulomb_pair):
        repaired = simulate(coulomb_pair, 10)
        printed = simulate(coulomb_pair, 10, as_printed=(2,))
        assert abs(printed["theta_g_dot"][-1]) > 20 * abs(repaired["theta_g_dot"]).max()
        assert abs(printed["dte"]).max() > 20 * abs(repaired["dte"]).max()


@pytest.mark.parametrize(("number", "body", "axis"), [(7, "x", (2, 3)), (9, "y", (4, 5))])
class TestEquations7And9:
    def test_third_law_residual(self, nasa, number, body, axis):
        """Per unit load the forces on the two bodies sum to zero; as printed they sum to two."""
        for printed, residual in (((), 0.0), ((number,), 2.0)):
            s = structure(nasa, printed)
            force = s.normal if body == "x" else s.friction(np.array(20e-3))
            assert abs(force[axis[0]] + force[axis[1]]) == residual

    def test_bearings_carry_opposite_forces(self, coulomb_pair, number, body, axis):
        """In the mean the bearings of pinion and gear react to the same mesh force, oppositely."""
        p, g = f"bearing_force_{body}_p", f"bearing_force_{body}_g"
        for printed, sign in (((), -1.0), ((number,), 1.0)):
            run = steady_state(coulomb_pair, as_printed=printed)
            assert float(run[g].mean()) == pytest.approx(sign * float(run[p].mean()), rel=1e-6)
            assert abs(float(run[p].mean())) > 0.0


def test_printed_signs_change_only_their_own_rows(nasa):
    repaired = periodic_system(nasa, "full")
    t = 0.3 * repaired.period
    rows = {1: 6, 2: 7, 7: 9, 9: 11}
    for number, row in rows.items():
        difference = periodic_system(nasa, "full", as_printed=(number,)).A(t) - repaired.A(t)
        assert set(np.flatnonzero(np.abs(difference).max(axis=1))) == {row}
