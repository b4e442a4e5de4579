"""Every number of page 1 and of the main tables, computed again from the saved data and the parameter file.

The functions here are this test's own: they read NetCDF and TOML, and nothing of the program.
"""

import math

import numpy as np
import pytest


def static_force(parameters):
    """T_p over the pinion's base radius m z cos(alpha)/2 [N]; torque in N m, module in mm."""
    rack, pinion = parameters["basic_rack"], parameters["pinion"]
    radius = 0.5e-3 * rack["module"] * pinion["teeth"] * math.cos(math.radians(rack["pressure_angle"]))
    return parameters["operating"]["pinion_torque"] / radius


def mesh_frequency(parameters):
    return parameters["operating"]["pinion_speed"] / 60.0 * parameters["pinion"]["teeth"]


def power(parameters):
    operating = parameters["operating"]
    return operating["pinion_torque"] * operating["pinion_speed"] * math.pi / 30.0


def amplitudes(values, cycles=1):
    """Amplitudes at the orders 1 to 10 by sums of cosines and sines."""
    phase = 2.0 * np.pi * np.arange(values.size) * cycles / values.size
    found = []
    for order in range(1, 11):
        c, s = (2.0 * np.mean(values * f(order * phase)) for f in (np.cos, np.sin))
        found.append(math.hypot(c, s))
    return np.array(found)


def row(table, name):
    return next(one for one in table if one["name"] == name)


def test_numbers_of_page_1(written):
    numbers, force = written.document["numbers"], static_force(written.parameters)
    cycle = written.data("prediction")
    total = cycle["normal_load"].sum("pair").to_numpy()
    x, y = (cycle[f"bearing_force_{line}_p"].to_numpy() for line in "xy")
    assert numbers["dynamic_factor"]["value"] == pytest.approx(total.max() / force, rel=1e-9)
    assert numbers["tooth_load"]["value"] == pytest.approx(
        cycle["normal_load"].max().item() / force, rel=1e-9
    )
    sampled = np.ptp(cycle["dte"].to_numpy())
    assert sampled <= numbers["dte_peak_to_peak"]["value"] * (1 + 1e-9) <= 1.01 * sampled
    lost = total.min() <= 0.0
    assert ("least_force" in numbers) == lost == (written.document["verdict"]["kind"] == "DO_NOT_RUN")
    if lost:
        assert numbers["least_force"]["value"] == 0.0
    else:
        rms = math.sqrt(np.mean((x - x.mean()) ** 2) + np.mean((y - y.mean()) ** 2))
        assert numbers["bearing_rms"]["value"] == pytest.approx(rms, rel=1e-9)
        loudest = np.sort(np.argsort(-np.hypot(amplitudes(x), amplitudes(y)))[:2]) + 1
        assert f"orders {loudest[0]} and {loudest[1]}" in numbers["bearing_rms"]["note"]
        first = mesh_frequency(written.parameters) * loudest[0]
        assert f"({float(f'{first / 1e3:.2g}'):g}" in numbers["bearing_rms"]["note"]  # kHz, two digits


def test_the_second_program_is_the_saved_run_and_not_the_prediction(written):
    numbers, force = written.document["numbers"], static_force(written.parameters)
    cycle = written.data("second_program")
    total = cycle["normal_load"].sum("pair").to_numpy()
    assert numbers["dynamic_factor"]["second"] == pytest.approx(total.max() / force, rel=1e-9)
    assert numbers["dte_peak_to_peak"]["second"] == pytest.approx(np.ptp(cycle["dte"].to_numpy()), rel=0.01)
    assert not np.allclose(
        cycle["dte"].to_numpy()[:64], written.data("prediction")["dte"].to_numpy()[:64], rtol=1e-6
    )


def test_ranges_are_the_percentiles_of_the_samples(written):
    samples = written.data("uncertainty")
    for key in ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "efficiency"):
        low, high = np.percentile(samples[key].to_numpy(), [5.0, 95.0])
        one = written.document["numbers"][key]
        assert (one["low"], one["high"]) == pytest.approx((low, high), rel=1e-12), key
    for one in written.document["chapters"]["how_sure"]["ranges"]:
        name = next(n for n in samples.data_vars if samples[n].attrs.get("long_name") == one["result"])
        ends = np.percentile(samples[name].to_numpy(), [5.0, 50.0, 95.0])
        assert [one[k]["value"] for k in ("low", "middle", "high")] == pytest.approx(list(ends), rel=1e-12)


def test_the_efficiency_is_that_of_the_losses(written):
    cycle = written.data("prediction")
    sliding = -cycle["friction_power"].sum("pair").mean().item()
    loss = (1.0 - written.document["numbers"]["efficiency"]["value"]) * power(written.parameters)
    # Dampers take the rest; sliding is the largest part on these pairs.
    assert sliding < loss < 2.5 * sliding
    losses = written.document["chapters"]["losses"]["losses"]
    assert row(losses, "input power")["value"]["value"] == pytest.approx(power(written.parameters), rel=1e-9)
    assert row(losses, "loss of the mesh")["value"]["value"] == pytest.approx(loss, rel=1e-6)


def test_the_table_of_orders(written):
    cycle, table = written.data("prediction"), written.document["chapters"]["response"]["orders"]
    dte = amplitudes(cycle["dte"].to_numpy())
    bearing = np.hypot(*(amplitudes(cycle[f"bearing_force_{line}_p"].to_numpy()) for line in "xy"))
    for one, a, b in zip(table, dte, bearing, strict=True):
        assert one["dte"]["value"] == pytest.approx(a, rel=1e-9, abs=1e-12)
        assert one["bearing"]["value"] == pytest.approx(b, rel=1e-9, abs=1e-9)
        frequency = one["order"] * mesh_frequency(written.parameters)
        assert one["frequency"] == {"value": pytest.approx(frequency, rel=1e-9), "unit": "Hz"}


def test_the_table_of_forces(written):
    cycle, table = written.data("prediction"), written.document["chapters"]["forces"]["forces"]
    total = cycle["normal_load"].sum("pair").to_numpy()
    expected = {
        "static mesh force": static_force(written.parameters),
        "largest mesh force": total.max(),
        "smallest mesh force": max(total.min(), 0.0),
        "largest load of one tooth pair": cycle["normal_load"].max().item(),
        "bearing force, pinion, along the line of action, mean": cycle["bearing_force_x_p"].mean().item(),
        "bearing force, gear, off it, mean": cycle["bearing_force_y_g"].mean().item(),
    }
    for name, value in expected.items():
        assert row(table, name)["value"] == {"value": pytest.approx(value, rel=1e-9, abs=1e-9), "unit": "N"}


def test_the_largest_hertzian_pressure(written):
    """p = sqrt(N E'/(2 pi b rho)), rho = rho_p rho_g/(rho_p + rho_g), E' = E/(1 - nu^2) for equal steels."""
    parameters, cycle = written.parameters, written.data("prediction")
    rack, pinion, gear = (parameters[k] for k in ("basic_rack", "pinion", "gear"))
    alpha = math.radians(rack["pressure_angle"])
    r_p, r_g = (0.5e-3 * rack["module"] * g["teeth"] for g in (pinion, gear))
    length = (r_p + r_g) * math.sin(alpha)
    xi, load = cycle["position"].to_numpy(), cycle["normal_load"].to_numpy()
    tip = [r + 1e-3 * rack["module"] for r in (r_p, r_g)]
    end = math.sqrt(tip[0] ** 2 - (r_p * math.cos(alpha)) ** 2)
    start = length - math.sqrt(tip[1] ** 2 - (r_g * math.cos(alpha)) ** 2)
    xi = np.clip(xi, start, end)
    radius = xi * (length - xi) / length
    modulus = pinion["youngs_modulus"] * 1e9 / (1.0 - pinion["poisson_ratio"] ** 2)
    width = 1e-3 * min(pinion["face_width"], gear["face_width"])
    pressure = np.sqrt(np.maximum(load, 0.0) * modulus / (2.0 * math.pi * width * radius)).max()
    found = row(written.document["chapters"]["forces"]["forces"], "largest Hertzian pressure")
    assert found["value"]["value"] == pytest.approx(pressure, rel=1e-6)


def test_the_table_of_stability(written):
    table = written.document["chapters"]["stability"]["stability"]
    radius = row(table, "largest Floquet multiplier")["value"]["value"]
    halved = row(table, "a disturbance is halved in")["value"]["value"]
    assert radius**halved == pytest.approx(0.5)
    linear = written.data("linear")
    assert radius == pytest.approx(linear.attrs["spectral_radius"], rel=1e-6)


def test_the_error_budget(written):
    budget, table = written.data("budget"), written.document["chapters"]["how_sure"]["error_budget"]
    span = written.document["numbers"]["dte_peak_to_peak"]["value"]
    second = np.ptp(written.data("second_program")["dte"].to_numpy())
    samples = np.percentile(written.data("uncertainty")["dte_peak_to_peak"].to_numpy(), [5.0, 95.0])
    rows = dict(zip(budget["row"].to_numpy(), budget["dte"].to_numpy(), strict=True))
    assert rows["second"] == pytest.approx(abs(span - second), abs=0.01 * span)
    assert rows["inputs"] == pytest.approx(0.5 * np.ptp(samples), rel=1e-9)
    np.testing.assert_allclose(budget["share"], 100.0 * budget["dte"] / span, rtol=1e-12)
    for one, size in zip(table, budget["dte"].to_numpy(), strict=True):
        assert (one["dte"] is None) == (not np.isfinite(size))


def test_the_distance_to_a_hazard_is_that_of_the_chart_or_of_a_jump(written):
    hazard = written.document["numbers"]["hazard"]
    jumps = written.document["chapters"]["contact_loss"].get("jumps", [])
    speed = written.parameters["operating"]["pinion_speed"]
    places = [one["speed"]["value"] for one in jumps]
    if not places:
        assert hazard["value"] is None
        return
    nearest = min(places, key=lambda place: abs(place - speed))
    assert hazard["value"] == pytest.approx(nearest - speed, abs=1e-6)
    way = next(one["way"] for one in jumps if one["speed"]["value"] == nearest)
    assert f"running {way}" in hazard["note"]
