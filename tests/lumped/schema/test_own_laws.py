"""Is a law or a stiffness of the user what is computed with, kept in files, and refused if wrong?"""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from lumped import LawRangeWarning, ParameterError, load_gear_pair, speed_sweep, steady_state
from lumped.friction.registry import law_of
from lumped.path_of_contact import contact_path, friction_path_function, friction_profile, mesh_stiffness

PAIR = load_gear_pair("nasa_28_28")
PATH = contact_path(PAIR)
XI = np.linspace(PATH.L_XA, PATH.L_XD, 4001)[1:-1]


def traction(sliding_velocity, hertz_pressure):
    """Mu of the user, here linear in the sliding velocity."""
    return 0.004 * sliding_velocity + 0.0 * hertz_pressure


def test_a_function_is_evaluated_where_the_teeth_touch():
    pair = PAIR.with_(law=traction)
    # v_s = (omega_p + omega_g) |xi - L_XP|, equation (13): linear, so that the interpolation is exact.
    mu = 0.004 * (PATH.omega_pinion + PATH.omega_gear) * (XI - PATH.L_XP)
    assert friction_path_function(pair)(XI) == pytest.approx(mu, abs=1e-12)
    assert friction_path_function(pair).switches == pytest.approx([PATH.L_XP])
    # It is sampled after all other changes: at twice the speed the teeth slide twice as fast.
    assert friction_path_function(PAIR.with_(law=traction, speed=9750))(XI) == pytest.approx(
        2 * mu, abs=1e-12
    )
    assert "user's traction" in friction_profile(pair)["law_title"].to_numpy()
    assert "user's traction" in repr(pair)


@pytest.mark.parametrize("law", ["coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb"])
def test_a_published_law_comes_back_from_its_table(law):
    formula = PAIR.with_(law=law)
    mu = friction_path_function(formula)
    table = PAIR.with_(law=lambda xi: abs(float(mu(xi))))
    # 61 points a side, closer towards P; monotone cubics err by 8e-4 of the largest mu at most, at the corner
    # of law IV, which is 20 um wide. The motion sees the mean of that.
    assert np.abs(friction_path_function(table)(XI) - mu(XI)).max() < 1e-3 * np.abs(mu(XI)).max()
    a, b = (steady_state(pair)["dte"].to_numpy() for pair in (formula, table))
    assert np.abs(a - b).max() < 1e-6 * np.ptp(a)


def test_array_columns_and_file_are_one_law_and_a_saved_pair_keeps_it(tmp_path):
    x = np.linspace(PATH.L_XA, PATH.L_XD, 30)
    mu = 0.03 + 0.02 * np.sin(300 * x)
    rows = "\n".join(f"{m:.15g}, {r:.15g}" for m, r in np.stack([mu, x / PAIR.geometry.base_radius_pinion]).T)
    (tmp_path / "mu.csv").write_text(f"coefficient, roll_angle [rad]\n{rows}\n", encoding="utf-8")
    file = {"file": str(tmp_path / "mu.csv")}
    for pair in (
        PAIR.with_(law=mu),
        PAIR.with_(law={"position [mm]": 1e3 * x, "coefficient": mu}),
        PAIR.with_({"friction.table": file, "friction.law": "table"}),
    ):
        law = friction_path_function(pair)
        assert np.abs(law(x)) == pytest.approx(mu, abs=1e-10)
        assert law.breaks.size == 31  # the points and P: the table's own polynomials
        (tmp_path / "pair.toml").write_text(pair.to_toml(), encoding="utf-8")
        again = load_gear_pair(tmp_path / "pair.toml")
        assert again == pair
        assert hash(again) == hash(pair) == hash(pickle.loads(pickle.dumps(pair)))


def test_a_law_sampled_at_one_speed_says_so_at_another():
    pair = PAIR.with_(law=traction)
    with pytest.warns(LawRangeWarning, match="user's traction: pinion speed is 2000 rpm, outside"):
        speed_sweep(pair, [2000.0])
    assert not law_of(PAIR.with_(law=lambda xi: 0.05).friction).ranges  # this one holds at every speed


def total(phase):
    """Sum of all pairs [N/m], smooth and periodic."""
    return 2e8 * (1.0 + 0.1 * np.cos(2 * np.pi * phase))


STIFFNESS = {
    "function": total,
    "array": total(np.linspace(0.0, 1.0, 241)),
    "columns": {"stiffness [N/um]": total(np.arange(240) / 240) * 1e-6, "phase": np.arange(240) / 240},
}


@pytest.mark.parametrize("stiffness", STIFFNESS.values(), ids=STIFFNESS)
def test_a_total_stiffness_is_that_of_the_mesh(stiffness):
    mesh = mesh_stiffness(PAIR.with_(stiffness=stiffness, mesh__contact="prescribed"))
    # Monotone cubics with h = 1/240 of a period, second order at extremes: (2 pi h)^2/8 of the amplitude.
    amplitude = (2 * np.pi / 240) ** 2 / 8 * 2e7
    assert np.abs(mesh["mesh_stiffness"] - total(mesh["phase"])).max() < 2 * amplitude


def test_a_function_of_xi_is_the_stiffness_of_one_pair():
    mesh = mesh_stiffness(PAIR.with_(stiffness=lambda xi: 1e10 * xi))
    single = mesh["pair_stiffness"].isel(pair=0)
    xi = PATH.L_XA + mesh["phase"] * PAIR.geometry.base_pitch
    assert np.abs(single - 1e10 * xi).max() < 1e-9 * 1e10 * PATH.L_XD


def mu_columns(points, mu=(0.1, 0.1, 0.1, 0.1), name="coefficient"):
    return {"law": {"position [mm]": points, name: mu}}


REFUSED = [
    ({"law": lambda x: 0.05}, r"function\(x\): allowed a function whose arguments are called any of xi"),
    ({"law": lambda sliding_velocity: "a"}, "With sliding_velocity = .* it raises ValueError"),
    ({"law": lambda xi: -0.05}, "coefficient = -0.05: allowed 0 to 1. Give the magnitude"),
    ({"law": lambda xi: np.nan}, "finite numbers"),
    ({"law": [0.05, 0.06]}, "at least four values"),
    ({"law": "table"}, "friction.table = None"),
    (mu_columns([1, 2, 3, 4]), "friction.table.points = 1.0000 to"),
    (mu_columns([1, 2, 3, 4], name="mu"), r"The header is 'position \[mm\], mu'"),
    (mu_columns([8, 23, 22, 24]), "22 after 23: allowed increasing"),
    (mu_columns([7, 12, 15, 20, 24]), "4 values: allowed one per point"),
    ({"stiffness": np.linspace(1e8, 2e8, 9)}, "different values at the same phase"),
    ({"stiffness": lambda t: 1e8}, "called one of phase, xi"),
    ({"stiffness": lambda phase: -1e8}, r"-1e\+08 N/m"),
    ({"stiffness": {"phase": [0, 0.1, 0.2, 0.3], "stiffness [N/m]": [1e8] * 4}}, "a gap of 0.700 mesh"),
]


@pytest.mark.parametrize(("change", "message"), REFUSED)
def test_what_cannot_be_a_law_is_refused(change, message):
    with pytest.raises(ParameterError, match=message):
        PAIR.with_(**change)
