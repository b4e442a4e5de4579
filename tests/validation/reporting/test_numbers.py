"""Every number of page 1 and of every table, computed again from the saved data and the parameter file.

Results that the report only shows (natural frequencies, K_v, losses of a law) are asked for again from the
parameter file, past the report; everything else is ``recomputed``.
"""

import math
import tomllib

import numpy as np
import pytest

import lumped
from lumped.losses import iso_14179_mesh_loss
from lumped.model.averaged import modes
from lumped.model.dynamic_factor import iso_dynamic_factor
from tests.validation.reporting import recomputed
from tests.validation.reporting.columns import NAMED_NUMBERS, recomputes


def pair_of(written):
    return lumped.load_gear_pair(
        tomllib.loads(written.result.folder.joinpath("data/parameters.toml").read_text("utf-8"))
    )


def close(value, rel=1e-9):
    return pytest.approx(value, rel=rel, abs=1e-12)


def assert_rows(written, name, expected):
    """A table of named numbers has these rows, in this order: name -> value, unit and part of the note."""
    table = written.table(name)
    assert [one["name"] for one in table] == list(expected)
    for one in table:
        value, unit, note = (*expected[one["name"]], "")[:3]
        assert one["value"] == {"value": close(value, 1e-6), "unit": unit}, one
        assert note in one["note"].replace("\u00a0", " "), one


def of_motion(written, name):
    """The five numbers of a saved motion, but for the efficiency."""
    cycle = written.data(name)
    total = cycle["normal_load"].sum("pair").to_numpy()
    force = total.mean()
    x, y = (cycle[f"bearing_force_{line}_p"].to_numpy() for line in "xy")
    return {
        "dte_peak_to_peak": np.ptp(cycle["dte"].to_numpy()),
        "dynamic_factor": total.max() / force,
        "tooth_load": cycle["normal_load"].max().item() / force,
        "least_force": max(total.min() / force, 0.0),
        "bearing_rms": math.hypot(x.std(), y.std()),
    }


def motions_of(written):
    """Names of the saved motions beyond contact loss, one for each window of speeds."""
    names = {path.stem for path in (written.folder / "data").iterdir()}
    return sorted(name for name in names if name.startswith("motions"))


def nearest_hazard(written):
    """Speed and way of the nearest jump; these pairs have no unstable speed."""
    operating_speed = written.parameters["operating"]["pinion_speed"]
    jumps = [
        (float(speed), "up" if rising else "down")
        for motions in map(written.data, motions_of(written))
        for speed, rising in zip(
            motions["jump_speed_rpm"].to_numpy(), motions["jump_rising"].to_numpy(), strict=True
        )
    ]
    return min(jumps, key=lambda jump: abs(jump[0] - operating_speed), default=None)


def test_numbers_of_page_1(written):
    numbers = written.document["numbers"]
    lost = written.parameters["name"] == "lost"
    keys = ["dte_peak_to_peak", "dynamic_factor", "tooth_load", "least_force" if lost else "bearing_rms"]
    assert list(numbers) == [
        *keys,
        "efficiency",
        "resonance",
        "hazard",
        *(["trouble"] if "trouble" in numbers else []),
    ]
    first = of_motion(written, "prediction")
    second = of_motion(written, "second_program")
    samples = written.data("uncertainty")
    for key in keys:
        # Peaks lie between samples: at most 1 % above them.
        exact = 0.01 if key == "dte_peak_to_peak" else 1e-9
        assert numbers[key]["value"] == close(first[key], exact), key
        assert numbers[key]["value"] == close(samples.attrs[f"given_{key}"]), key
        assert numbers[key]["second"] == close(second[key], exact), key
        assert numbers[key]["unit"] == samples[key].attrs["units"]
        if key != "least_force":
            low, high = np.percentile(samples[key].to_numpy(), [5.0, 95.0])
            assert (numbers[key]["low"], numbers[key]["high"]) == (close(low), close(high)), key
    assert (first["least_force"] == 0.0) == lost == (written.document["verdict"]["kind"] == "DO_NOT_RUN")
    assert abs(second["dynamic_factor"] - first["dynamic_factor"]) > 1e-6, "two programs are never equal"


def balanced_loss(written):
    """Driving power less braking power of the second program's saved motion [W]."""
    attributes = written.data("second_program").attrs
    parameters = written.parameters
    omega = parameters["operating"]["pinion_speed"] * math.pi / 30.0
    ratio = parameters["pinion"]["teeth"] / parameters["gear"]["teeth"]
    return omega * (attributes["pinion_torque"] - ratio * attributes["brake_torque"])


def test_the_efficiency_is_that_of_the_power_balance_of_the_second_program(written):
    """Finite motions, which the prediction leaves out, change the loss by less than 1 % on these pairs."""
    number = written.document["numbers"]["efficiency"]
    samples = written.data("uncertainty")
    assert number["unit"] == "%"  # a share, printed times 100
    loss = (1.0 - number["value"]) * recomputed.power(written.parameters)
    assert loss == pytest.approx(balanced_loss(written), rel=0.01)
    low, high = np.percentile(samples["efficiency"].to_numpy(), [5.0, 95.0])
    assert (number["low"], number["high"]) == (close(low), close(high))


def test_the_efficiency_of_the_second_program_is_that_of_its_own_power_balance(written):
    power = recomputed.power(written.parameters)
    loss = (1.0 - written.document["numbers"]["efficiency"]["second"]) * power
    # Integration at 1e-8 over the ten steps or so of a vibration leaves 1e-7 of the driving power.
    assert loss == pytest.approx(balanced_loss(written), abs=1e-7 * power)


PROOF = "the linear motion is proven stable from (.*) to (.*)"


def test_the_distance_to_a_hazard_is_that_of_the_nearest_jump(written):
    number = written.document["numbers"]["hazard"]
    hazard = nearest_hazard(written)
    speed = written.parameters["operating"]["pinion_speed"]
    proven = (0.1 * speed, "1"), (2.0 * speed, "rpm")  # no node of the chart is unstable in this range
    assert number["unit"] == "rpm"
    if hazard is None:
        assert number["value"] is None
        recomputed.assert_says(
            number["note"],
            rf"none found from (.*) to (.*) rpm; {PROOF}",
            (0.1 * speed, "1"),
            (2.0 * speed, "1"),
            *proven,
            digits=5,
        )
        return
    assert number["value"] == close(hazard[0] - speed)
    recomputed.assert_says(
        number["note"],
        rf"jump, running (\w+) at (.*); {PROOF}",
        hazard[1],
        (hazard[0], "rpm"),
        *proven,
        digits=5,
    )


def test_the_loudest_orders_of_page_1(written):
    number = written.document["numbers"].get("bearing_rms")
    if number is None:
        pytest.skip("where contact is lost another number takes its place")
    cycle = written.data("prediction")
    frequency = recomputed.mesh_frequency(written.parameters)
    size = np.hypot(*(recomputed.amplitudes(cycle[f"bearing_force_{line}_p"].to_numpy()) for line in "xy"))
    one, two = sorted(np.argsort(size)[-2:] + 1)
    recomputed.assert_says(
        number["note"].replace("\u00a0", " "),
        r"largest orders (\d+) and (\d+) × mesh \((.*) and (.*)\): (.*) and (.*)",
        *(str(one), str(two)),
        *((order * frequency, "Hz") for order in (one, two)),
        *((size[order - 1], "N") for order in (one, two)),
        digits=2,
    )


@recomputes("motion", **NAMED_NUMBERS)
def test_the_table_of_the_motion(written):
    cycle = written.data("prediction")
    iso = iso_dynamic_factor(pair_of(written))
    numbers = written.document["numbers"]
    note = f"{iso.zone}, N = {iso.resonance_ratio:.2f}, tolerances of class {iso.tolerance_class}"
    assert_rows(
        written,
        "motion",
        {
            "transmission error, peak to peak": (numbers["dte_peak_to_peak"]["value"], "m"),
            "transmission error, mean": (cycle["dte"].mean().item(), "m"),
            "dynamic factor": (numbers["dynamic_factor"]["value"], "1"),
            "K_v of ISO 6336-1, method B": (iso.factor, "1", note),
            "mesh frequency": (recomputed.mesh_frequency(written.parameters), "Hz"),
        },
    )


@recomputes(
    "orders", order="order", frequency="frequency", dte="transmission error", bearing="pinion bearings"
)
def test_the_table_of_orders(written):
    cycle = written.data("prediction")
    table = written.table("orders")
    dte = recomputed.amplitudes(cycle["dte"].to_numpy())
    bearing = np.hypot(*(recomputed.amplitudes(cycle[f"bearing_force_{line}_p"].to_numpy()) for line in "xy"))
    assert [one["order"] for one in table] == list(range(1, 11))
    for one, a, b in zip(table, dte, bearing, strict=True):
        assert one["dte"] == {"value": close(a), "unit": "m"}
        assert one["bearing"] == {"value": close(b), "unit": "N"}
        frequency = one["order"] * recomputed.mesh_frequency(written.parameters)
        assert one["frequency"] == {"value": close(frequency), "unit": "Hz"}


@recomputes("modes", frequency="frequency", damping="damping ratio", speed="speed at which order 1 meets it")
def test_the_table_of_modes(written):
    mode_list = modes(pair_of(written))
    assert len(mode_list) == len(written.table("modes"))
    for one, mode in zip(written.table("modes"), mode_list, strict=True):
        assert one["frequency"] == {"value": close(mode.natural_frequency), "unit": "Hz"}
        assert one["damping"] == close(mode.damping_ratio)
        speed = 60.0 * mode.natural_frequency / written.parameters["pinion"]["teeth"]
        assert one["speed"] == {"value": close(speed), "unit": "rpm"}


@recomputes("forces", **NAMED_NUMBERS)
def test_the_table_of_forces(written):
    cycle = written.data("prediction")
    parameters = written.parameters
    total = cycle["normal_load"].sum("pair").to_numpy()
    xi = cycle["position"].to_numpy()
    load = cycle["normal_load"].to_numpy()
    start, _, end, _ = recomputed.path_of_contact(parameters)
    modulus, radius, _, _ = recomputed.contact(parameters, np.clip(xi, start, end))
    width = 1e-3 * min(parameters[gear]["face_width"] for gear in ("pinion", "gear"))
    pressure = np.sqrt(np.maximum(load, 0.0) * modulus / (2.0 * math.pi * width * radius)).max()
    expected = {
        "static mesh force": (recomputed.static_force(parameters), "N"),
        "mean mesh force": (total.mean(), "N", "static less what friction carries"),
        "largest mesh force": (total.max(), "N"),
        "smallest mesh force": (max(total.min(), 0.0), "N", "0 is contact loss"),
        "largest load of one tooth pair": (load.max(), "N"),
        "largest Hertzian pressure": (pressure, "Pa"),
    }
    assert_rows(
        written,
        "forces",
        expected
        | {
            f"bearing force, {gear}, {line}, mean": (
                cycle[f"bearing_force_{axis}_{gear[0]}"].mean().item(),
                "N",
            )
            for gear in ("pinion", "gear")
            for axis, line in (("x", "along the line of action"), ("y", "off it"))
        },
    )
    for one in written.table("forces")[6:]:
        _, gear, line, _ = one["name"].split(", ")
        force = cycle[f"bearing_force_{'x' if line.startswith('along') else 'y'}_{gear[0]}"].to_numpy()
        recomputed.assert_says(one["note"].replace("\u00a0", " "), r"rms about it (.*)", (force.std(), "N"))


@recomputes(
    "jumps",
    speed="speed",
    way="running",
    before="transmission error before, rms",
    after="after, rms",
    load="largest tooth load after",
    motion="motion after",
)
def test_the_table_of_jumps(written):
    hazard = nearest_hazard(written)
    if hazard is None:
        assert "jumps" not in written.document["chapters"]["contact_loss"]
        return
    motions = written.data("motions")
    table = written.table("jumps")
    assert len(table) == motions.sizes["jump"] > 0
    for place, one in enumerate(table):
        columns = {
            "speed": "speed_rpm", "before": "dte_rms", "after": "dte_rms_after", "load": "largest_load_after",
        }  # fmt: skip
        for column, name in columns.items():
            jump = motions[f"jump_{name}"]
            unit = jump.attrs["units"]
            value = float(jump[place]) if np.isfinite(jump[place]) else None
            assert one[column] == {"value": value if value is None else close(value), "unit": unit}, name
        assert one["motion"] == str(motions["jump_after"].to_numpy()[place])
        assert one["way"] == ("up" if motions["jump_rising"].to_numpy()[place] else "down")
        # Rising, a motion cannot end below the speeds that were looked at.
        assert motions.attrs["speed_low_rpm"] <= one["speed"]["value"] <= motions.attrs["speed_high_rpm"]


@recomputes("stability", **NAMED_NUMBERS)
def test_the_table_of_stability(written):
    linear = written.data("linear")
    chart = written.data("stability")
    hazard = nearest_hazard(written)
    radius = linear.attrs["spectral_radius"]
    expected = {
        "largest Floquet multiplier": (radius, "1", "stable"),
        "a disturbance is halved in": (math.log(0.5) / math.log(radius), "1", "mesh cycles"),
        "mesh damping ratio": (written.parameters["mesh"]["damping_ratio"], "1"),
    }
    assert math.isnan(chart.attrs["nearest_edge_damping_ratio"])
    if hazard is not None:
        expected["nearest hazard"] = (hazard[0], "rpm", f"jump, running {hazard[1]}")
    share = float((chart["spectral_radius"].to_numpy() > 1.0).mean())
    caption = written.document["chapters"]["stability"]["captions"]["stability_chart"]
    recomputed.assert_says(
        caption, r".*instability\. (.*) % of the nodes.*", (100.0 * chart["known"].mean().item(), "1")
    )
    expected["unstable share of the chart"] = (share, "1")
    if chart.sizes["region"]:
        expected["thinnest tongue"] = (float(chart["region_width"].min()), "rpm", "at its widest")
    assert_rows(written, "stability", expected)


LOSS_PARTS = ["sliding", "tooth damping", "bearing damping"]


@recomputes("losses", **NAMED_NUMBERS)
def test_the_table_of_losses(written):
    parameters = written.parameters
    start, _, end, _ = recomputed.path_of_contact(parameters)
    film, other, parameter = recomputed.films(parameters, np.linspace(start, end, 201))
    supply = recomputed.power(parameters)
    share = written.document["numbers"]["efficiency"]["value"]
    parts = {one["name"]: (one["value"]["value"], "W") for one in written.table("losses")[2:5]}
    assert list(parts) == LOSS_PARTS  # their values: the next test
    assert_rows(
        written,
        "losses",
        {
            "input power": (supply, "W"),
            "loss, all places": ((1.0 - share) * supply, "W", "of the motion of page 1"),
            **parts,
            "mesh loss of ISO/TR 14179-2": (iso_14179_mesh_loss(pair_of(written)), "W"),
            "smallest film thickness": (film.min(), "m", f"gives {(other / film).min():.2f} to "),
            "the same by another formula": (other.min(), "m"),
            "smallest film parameter": (parameter.min(), "1", "below 1 boundary"),
        },
    )


def test_the_parts_of_the_loss_add_up_to_it(written):
    rows = {one["name"]: one["value"]["value"] for one in written.table("losses")}
    sliding = -written.data("prediction")["friction_power"].sum("pair").mean().item()
    assert rows["sliding"] == pytest.approx(sliding, rel=2e-3)  # a jump of friction between two samples
    assert sum(rows[name] for name in LOSS_PARTS) == pytest.approx(rows["loss, all places"], rel=1e-6)
