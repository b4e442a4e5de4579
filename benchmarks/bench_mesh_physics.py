"""How fast are tooth stiffness, Harris map, relief optimum, losses, and periodic motion in both forms?

    pytest benchmarks/bench_mesh_physics.py

Every fast route stands in one group with a baseline that does the same task the plain way, so that its factor
is measured in the same run on the same machine: "scipy.quad per position" integrates each strain energy
adaptively at each position; "brentq per position" solves the equilibrium of each position at each torque. The
results of both must agree, which is checked before anything is timed.
"""

import time

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import lumped
from lumped.losses import losses_of_laws, quasi_static_losses
from lumped.path_of_contact import pair_stiffness
from lumped.quasi_static import mesh_positions, optimal_relief, static_transmission_error
from lumped.stiffness.energy import linear_hertz_compliance, pair_compliance

POSITIONS = 65
CURVES = 100


@pytest.fixture(scope="module")
def pair():
    return lumped.load_gear_pair("nasa_28_28").with_(
        mesh__stiffness={"model": "energy", "hertz": "linear"},
        pinion__tip_relief=None,
        gear__tip_relief=None,
    )


#: Number of the position at which the compiled compliance is compared with quadrature.
CHECKED = 7


def plain_compliance(pair, g, xi):
    """Bending, shear and compression of both teeth at one position, each by adaptive quadrature [m/N]."""
    total = 0.0
    for gear_name, gear, length in (("pinion", pair.pinion, xi), ("gear", pair.gear, g.L_XY - xi)):
        profile = pair.wheels[0 if gear_name == "pinion" else 1].tooth
        u_c, h_c, _, a = (float(v[0]) for v in profile.involute_points(np.array([length])))
        modulus = gear.youngs_modulus
        cosine = np.cos(a)
        sine = np.sin(a)
        shear_modulus = modulus / (2.0 * (1.0 + gear.poisson_ratio))

        def strain(u, h, slope, load=(u_c, h_c, cosine, sine), moduli=(modulus, shear_modulus)):
            u_load, h_load, across, along = load
            arm = across * (u_load - u) - along * h_load
            bending = 1.5 * arm**2 / h**3 / moduli[0]
            shear = 0.6 * across**2 / h / moduli[1]
            axial = 0.5 * along**2 / h / moduli[0]
            return (bending + shear + axial) * slope

        def fillet(s, profile=profile, strain=strain):
            u, h, slope = (float(v[0]) for v in profile.fillet_points(np.array([s])))
            return strain(u, h, slope)

        def flank(s, profile=profile, strain=strain):
            u, h, slope, _ = (float(v[0]) for v in profile.involute_points(np.array([s])))
            return strain(u, h, slope)

        total += quad(fillet, *profile.fillet_range, epsrel=1e-10)[0]
        total += quad(flank, profile.form_length, length, epsrel=1e-10)[0]
    return total / g.face_width


def positions(g):
    return np.linspace(g.L_XA, g.L_XD, POSITIONS)


@pytest.mark.benchmark(group="teeth at 65 positions")
def test_gauss_on_all_positions(benchmark, pair):
    g = lumped.geometry(pair)
    compliance = benchmark(lambda: pair_compliance(pair, positions(g), hertz="linear"))
    moduli = (pair.pinion.youngs_modulus, pair.gear.youngs_modulus)
    ratios = (pair.pinion.poisson_ratio, pair.gear.poisson_ratio)
    hertz = linear_hertz_compliance(moduli, ratios) / g.face_width
    plain = plain_compliance(pair, g, positions(g)[CHECKED])
    bodies = compliance.pinion.foundation + compliance.gear.foundation + hertz
    assert 1 / compliance.stiffness[CHECKED] == pytest.approx(
        plain + bodies[CHECKED], rel=1e-8
    )  # quad at 1e-10 a piece


@pytest.mark.benchmark(group="teeth at 65 positions")
def test_baseline_scipy_quad_per_position(benchmark, pair):
    g = lumped.geometry(pair)
    run = lambda: [plain_compliance(pair, g, xi) for xi in positions(g)]  # noqa: E731
    benchmark.pedantic(run, rounds=3, iterations=1, warmup_rounds=1)


@pytest.mark.benchmark(group="k_i(xi) as a path function, to 1e-10")
@pytest.mark.parametrize("hertz", ["linear", "weber_banaschek"])
def test_path_function_of_one_pair(benchmark, pair, hertz):
    one = pair.with_(mesh__stiffness={"model": "energy", "hertz": hertz})
    g = lumped.geometry(one)
    assert benchmark(lambda: pair_stiffness(one))(g.L_XP) > 0.0
    assert benchmark.stats.stats.min < 0.1  # asked for: milliseconds


@pytest.mark.benchmark(group="100 static transmission error curves, 256 positions each")
def test_hundred_curves_at_once(benchmark, pair):
    torques = np.linspace(1.0, 120.0, CURVES)
    errors = benchmark(lambda: static_transmission_error(pair, torques, extended=False))
    plain = one_by_one(pair, torques[[3, 77]])
    np.testing.assert_allclose(errors["transmission_error"].values[[3, 77]], plain, rtol=1e-9)
    assert benchmark.stats.stats.min < 1.0  # asked for: a second


def one_by_one(pair, torques):
    g = lumped.geometry(pair)
    mesh = mesh_positions(pair, extended=False)
    curves = []
    for force in torques / g.base_radius_pinion:
        curve = []
        for k, e in zip(mesh.stiffness, mesh.error, strict=True):
            near = np.isfinite(e)
            k_near = k[near]
            e_near = e[near]

            def balance(delta, k=k_near, e=e_near, force=force):
                return float(k @ np.maximum(delta - e, 0.0)) - force

            curve.append(
                brentq(balance, e_near.min(), e_near.max() + 1.01 * force / k_near.min(), xtol=1e-16)
            )
        curves.append(curve)
    return np.array(curves)


@pytest.mark.benchmark(group="100 static transmission error curves, 256 positions each")
def test_baseline_brentq_per_position(benchmark, pair):
    torques = np.linspace(1.0, 120.0, CURVES)
    benchmark.pedantic(lambda: one_by_one(pair, torques), rounds=1, iterations=1)


@pytest.mark.benchmark(group="whole answers")
def test_relief_optimum(benchmark, pair):
    relief = benchmark.pedantic(lambda: optimal_relief(pair), rounds=3, iterations=1, warmup_rounds=1)
    assert relief.peak_to_peak < relief.unmodified


@pytest.mark.benchmark(group="whole answers")
def test_losses_quasi_static(benchmark, pair):
    assert 0.9 < benchmark(lambda: quasi_static_losses(pair)).mesh_efficiency < 1.0


@pytest.mark.benchmark(group="whole answers")
def test_losses_of_all_laws_with_periodic_motion(benchmark, pair):
    losses = benchmark.pedantic(lambda: losses_of_laws(pair), rounds=3, iterations=1, warmup_rounds=1)
    assert losses.sizes["law"] == 5


@pytest.mark.benchmark(group="periodic motion, 128 times: prescribed contact is the baseline")
@pytest.mark.parametrize("form", ["prescribed", "loaded"])
def test_steady_state(benchmark, pair, form):
    one = pair.with_(mesh__contact=form)
    assert benchmark(lambda: lumped.steady_state(one, samples_per_cycle=128)).sizes["time"] == 128


@pytest.mark.parametrize("stiffness", ["rectangular", "energy"])
@pytest.mark.parametrize("name", ["nasa_28_28", "fzg_c", "kahraman_blankenship_50_50"])
def test_speed_sweep(capsys, name, stiffness):
    """Alternate sweeps of both forms, so that both see the same machine. Aim: 5 %; the noise is 15 %."""
    pair = lumped.load_gear_pair(name).with_(mesh__stiffness={"model": stiffness})
    forms = {form: pair.with_(mesh__contact=form) for form in ("prescribed", "loaded")}
    speeds = np.linspace(500.0, 12000.0, 60)
    taken = {form: [] for form in forms}
    for _ in range(11):
        for form, one in forms.items():
            start = time.process_time()
            sweep = lumped.speed_sweep(one, speeds)
            taken[form].append(time.process_time() - start)
            assert bool(sweep["periodic"].all())
    ratio = np.median(np.divide(taken["loaded"][1:], taken["prescribed"][1:]))
    each = min(taken["prescribed"]) / speeds.size * 1e3
    with capsys.disabled():
        print(f"\n{name}, {stiffness}: {each:.2f} ms a speed, loaded contact {ratio:.2f} times as much")
    assert ratio < 1.15
