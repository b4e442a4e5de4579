"""Is what each figure draws the saved result: values, units, names, marks; and the same in its CSV?"""

import re

import matplotlib.colors as colours
import numpy as np
import pytest

import lumped
from lumped.friction.registry import law_of
from lumped.losses import losses_of_laws
from lumped.model.averaged import modes
from tests.validation.reporting import recomputed
from tests.validation.reporting.test_numbers import pair_of
from tests.validation.reporting.written import plain

#: Figure -> columns of its CSV -> labels of its curves, all drawn over the first column.
_NAMES = {
    "transmission_error": {"dte": "dynamic transmission error"},
    "mesh_force": {"mesh_force": "all pairs"},
    "tooth_forces": {"mesh_force": "all pairs"}
    | {f"{kind}_{i}": f"pair {i}" for kind in ("load", "friction") for i in range(4)},
    "bearing_forces": {
        f"bearing_force_{axis}_{gear[0]}": f"{gear}, {line}"
        for gear in ("pinion", "gear")
        for axis, line in (("x", "along the line of action"), ("y", "off it"))
    },
    "overlay": {
        "prediction": "prediction", "second": "second program", "difference": "second program less prediction"
    },
    "over_speed": {"linear": "as given"},
    "motions_over_speed": {"linear": "as given"},
}  # fmt: skip


def axis(label):
    """Words, base unit and factor of an axis label "words [unit]"."""
    words, unit = re.fullmatch(r"(.*) \[(.*)\]", label, flags=re.DOTALL).groups()
    return words, *recomputed.unit_factor(unit)


def column(data, name):
    """A column of a CSV and its unit."""
    title = next(c for c in data.columns if c == name or c.startswith(f"{name} ["))
    return data[title].to_numpy(), title[len(name) + 2 : -1] or "1"


def close(actual, expected, rel=1e-9):
    values = np.abs(np.asarray(expected, dtype=float))
    largest = float(values[np.isfinite(values)].max(initial=1e-300))
    np.testing.assert_allclose(actual, expected, rtol=rel, atol=1e-9 * largest)


def lines_of(ax):
    """Curves by label; the vertical and horizontal marks have none."""
    return {line.get_label(): line for line in ax.lines if not line.get_label().startswith("_")}


def upright(ax):
    """Places of the vertical lines."""
    return [
        line.get_xdata()[0]
        for line in ax.lines
        if len(line.get_xdata()) == 2 and np.ptp(line.get_xdata()) == 0
    ]


def curves_and_their_names(written, name):
    if name not in written.figures:
        return
    data = written.curves(name)
    seen = set()
    bottom = written.figures[name].axes[-1]
    x = data.iloc[:, 0].to_numpy()
    for ax in written.figures[name].axes:
        words, unit, factor = axis(ax.get_ylabel())
        for line in ax.lines:
            if (key := line.get_gid()) is None or key not in _NAMES[name]:
                continue
            values, csv_unit = column(data, key)
            assert csv_unit == unit, key
            close(line.get_ydata() * factor, values)
            close(line.get_xdata(), x)
            assert line.get_label() == _NAMES[name][key]
            if name == "mesh_force":
                assert words == "mesh force"
            if name == "tooth_forces":
                assert words == ("friction force" if key.startswith("friction") else "normal load")
            seen.add(key)
    assert seen == set(_NAMES[name]) & {c.partition(" [")[0] for c in data.columns}
    if data.columns[0] == "cycles":
        assert bottom.get_xlabel() == "time [mesh cycles]"
        assert bottom.get_xlim() == (x[0], x[-1])
    elif data.columns[0] == "speed_rpm":
        assert bottom.get_xlabel() == "pinion speed [rpm]"


def test_every_curve_is_its_column(written):
    for name in _NAMES:
        curves_and_their_names(written, name)


def test_csv_of_the_curves_over_a_cycle(written):
    cycle = written.data("prediction")
    frequency = recomputed.mesh_frequency(written.parameters)
    for name in ("transmission_error", "tooth_forces", "bearing_forces"):
        close(written.curves(name)["cycles"], cycle["time"].to_numpy() * frequency)
    close(written.curves("transmission_error")["dte [m]"], cycle["dte"])
    forces = written.curves("tooth_forces")
    close(forces["mesh_force [N]"], cycle["normal_load"].sum("pair"))
    for i in range(cycle.sizes["pair"]):
        if f"load_{i} [N]" in forces:
            close(forces[f"load_{i} [N]"], cycle["normal_load"][i])
            close(forces[f"friction_{i} [N]"], cycle["friction_force"][i])
        else:
            assert float(cycle["normal_load"][i].max()) <= 0.0
    bearings = written.curves("bearing_forces")
    for name in (c for c in bearings.columns if c != "cycles"):
        force = cycle[name.removesuffix(" [N]")].to_numpy()
        close(bearings[name], force - force.mean())
    overlay = written.curves("overlay")
    second = written.data("second_program")
    dte = cycle[
        "dte"
    ].to_numpy()  # 512 samples of a cycle, of which every second is drawn, and the first again
    close(overlay["prediction [m]"], np.append(dte[::2], dte[0]))
    turning = second["dte"].to_numpy()
    assert (overlay["second [m]"].max(), overlay["second [m]"].min()) == (
        pytest.approx(turning.max(), rel=5e-3), pytest.approx(turning.min(), rel=5e-3),
    )  # fmt: skip
    close(overlay["difference [m]"], overlay["second [m]"] - overlay["prediction [m]"])
    assert np.abs(overlay["difference [m]"]).max() > 1e-9, "curves of two models differ"


def test_the_transmission_error_over_speed(written):
    sweep = written.data("sweep")
    operating = written.parameters["operating"]["pinion_speed"]
    names = [n for n in ("over_speed", "motions_over_speed") if n in written.figures]
    assert ("motions_over_speed" in names) == (written.document["gear_pair"] == "lost")
    for name in names:
        data = written.curves(name)
        ax = written.figures[name].axes[0]
        size = sweep["dte_peak_to_peak"].to_numpy()
        stable = sweep["spectral_radius"].to_numpy() <= 1.0
        pushes = sweep["normal_load_min"].to_numpy() > 0.0
        close(data["speed_rpm"], sweep["speed"])
        close(data["linear [m]"], np.where(stable & pushes, size, np.nan))
        close(data["pulling [m]"], np.where(stable & ~pushes, size, np.nan))
        assert (data["low [m]"] < data["high [m]"]).all()
        _, unit, factor = axis(ax.get_ylabel())
        band = ax.collections[0].get_paths()[0].vertices[:, 1] * factor
        assert (band.min(), band.max()) == (
            pytest.approx(data["low [m]"].min()),
            pytest.approx(data["high [m]"].max()),
        )
        assert (unit, upright(ax)) == ("m", [operating])
        assert f"{operating:g} rpm" in [text.get_text() for text in ax.texts]
        if written.document["gear_pair"] != "lost":
            continue
        motions = written.data("motions")
        drawn = written.curves(name, 2)
        jumps = written.curves(name, 3)
        close(np.sort(drawn["motion_speed_rpm"]), np.sort(motions["speed_rpm"]))
        close(np.sort(drawn["motion [m]"]), np.sort(motions["dte_peak_to_peak"]))
        assert drawn["motion_stable"].sum() == float(motions["stable"].sum())
        stable = drawn["motion_stable"].to_numpy() > 0
        curves = lines_of(ax)
        for label, chosen in (("unilateral contact", stable), ("unstable", ~stable)):
            close(curves[label].get_xdata(), drawn["motion_speed_rpm"][chosen])
            close(curves[label].get_ydata() * factor, drawn["motion [m]"][chosen])
        close(jumps["jump_speed_rpm"], motions["jump_speed_rpm"][np.isfinite(motions["jump_dte_rms_after"])])
        ends = motions.isel(jump=np.flatnonzero(np.isfinite(motions["jump_dte_rms_after"])))
        close(jumps["jump_from [m]"], ends["jump_dte_peak_to_peak"])
        close(jumps["jump_to [m]"], ends["jump_dte_peak_to_peak_after"])
        arrows = [text for text in ax.texts if getattr(text, "arrow_patch", None) is not None]
        ends = [(*text.xyann, *text.xy) for text in arrows]
        assert len(ends) == len(jumps)
        for (x, start, jump_rpm, end), (_, row) in zip(ends, jumps.iterrows(), strict=True):
            assert x == jump_rpm == pytest.approx(row["jump_speed_rpm"])
            assert (start * factor, end * factor) == (
                pytest.approx(row["jump_from [m]"]),
                pytest.approx(row["jump_to [m]"]),
            )


def test_the_range_over_speed_is_about_the_curve(written):
    """The curve as given lies in the range of the samples nearly everywhere; both are of one pair."""
    data = written.curves("over_speed")
    size = written.data("sweep")["dte_peak_to_peak"].to_numpy()
    inside = (size > 0.5 * data["low [m]"].to_numpy()) & (size < 2.0 * data["high [m]"].to_numpy())
    assert inside.mean() > 0.9


def test_the_orders_of_the_bearing_force(written):
    cycle = written.data("prediction")
    samples = written.data("uncertainty")
    size = np.hypot(*(recomputed.amplitudes(cycle[f"bearing_force_{line}_p"].to_numpy()) for line in "xy"))[
        :8
    ]
    data = written.curves("bearing_orders")
    ax = written.figures["bearing_orders"].axes[0]
    close(data["amplitude [N]"], size)
    assert list(data["order"]) == list(range(1, 9))
    for order in range(1, 9):
        low, high = np.percentile(samples[f"bearing_order_{order}"].to_numpy(), [5.0, 95.0])
        assert data["low [N]"][order - 1] == pytest.approx(low)
        assert data["high [N]"][order - 1] == pytest.approx(high)
    words, unit, factor = axis(ax.get_ylabel())
    assert (words, unit) == ("force on the pinion bearings", "N")
    close([bar.get_height() * factor for bar in ax.patches], size)
    close([bar.get_x() + 0.5 * bar.get_width() for bar in ax.patches], np.arange(1, 9))
    ends = np.array([segment[:, 1] * factor for segment in ax.collections[0].get_segments()])
    close(ends, data[["low [N]", "high [N]"]].to_numpy())
    frequency = re.fullmatch(r"mesh order \[-\]; 1 is (.*) Hz", ax.get_xlabel())[1]
    assert float(frequency) == pytest.approx(recomputed.mesh_frequency(written.parameters), rel=1e-3)


def test_the_swings(written):
    if "swings" not in written.figures:
        return
    samples = written.data("uncertainty")
    ax = written.figures["swings"].axes[0]
    swing = np.sort(samples["dte_peak_to_peak_swing"].to_numpy(), axis=1)
    largest = np.argsort(-(swing[:, 1] - swing[:, 0]), kind="stable")[:6]
    data = written.curves("swings")
    close(data[["low [m]", "high [m]"]].to_numpy(), swing[largest])
    assert list(data["input"]) == [str(samples["input"].to_numpy()[j]) for j in largest]
    _, unit, factor = axis(ax.get_xlabel())
    bars = sorted(ax.patches, key=lambda bar: -bar.get_y())
    close([(bar.get_x() * factor, (bar.get_x() + bar.get_width()) * factor) for bar in bars], swing[largest])
    peak_to_peak = written.document["numbers"]["dte_peak_to_peak"]["value"]
    assert (unit, [x * factor for x in upright(ax)]) == ("m", [pytest.approx(peak_to_peak)])
    labels = dict(zip(ax.get_yticks(), (plain(t.get_text()) for t in ax.get_yticklabels()), strict=True))
    words = [labels[round(bar.get_y() + 0.5 * bar.get_height())] for bar in bars]
    for field, text in zip(data["input"], words, strict=True):
        for part in ("pinion", "gear", "friction", "mesh", "roughness", "torque"):
            assert (part in text) == (part in field.replace("loa_", "").replace("mesh.backlash", "")), (
                field,
                text,
            )
        if "bearings" in field:
            assert ("off-line" in text) == ("oloa" in field)


def test_the_bars_of_the_error_budget(written):
    table = written.table("error_budget")
    ax = written.figures["error_budget"].axes[0]
    shares = np.array([np.nan if one["share"] is None else one["share"] for one in table])
    close(written.curves("error_budget")["share [%]"], shares)
    labels = dict(zip(ax.get_yticks(), (t.get_text() for t in ax.get_yticklabels()), strict=True))
    bars = sorted(ax.patches, key=lambda bar: -bar.get_y())
    assert [labels[round(b.get_y() + 0.5 * b.get_height())] for b in bars] == [one["error"] for one in table]
    words = sorted(ax.texts, key=lambda text: -text.xy[1])
    red = [colours.same_color(bar.get_facecolor(), "#D55E00") for bar in bars]
    for share, bar, text in zip(shares, bars, words, strict=True):
        if not np.isfinite(share):
            assert text.get_text() == "not known"
        elif share > 0.0:
            assert bar.get_width() == pytest.approx(share)
            recomputed.assert_printed(plain(text.get_text()).removesuffix(" %"), share, "1", 2)
    poorer = ("linear model, for charts", "form of the contact", "springs in place of shafts")
    errors = [np.nan if one["error"] in poorer else one["share"] for one in table]
    assert np.flatnonzero(red).tolist() == [int(np.nanargmax(np.array(errors, dtype=float)))]


def test_the_losses_by_law(written):
    pair = pair_of(written)
    ax = written.figures["losses_by_law"].axes[0]
    laws = losses_of_laws(pair)
    expected = dict(zip(laws["law_title"].to_numpy(), 1.0 - laws["mesh_efficiency"].to_numpy(), strict=True))
    data = written.curves("losses_by_law")
    close(data["loss [%]"], 100.0 * np.array(list(expected.values())))
    assert axis(ax.get_xlabel())[1] == "%"
    labels = dict(zip(ax.get_yticks(), (t.get_text() for t in ax.get_yticklabels()), strict=True))
    shown = {labels[round(b.get_y() + 0.5 * b.get_height())]: b for b in ax.patches}
    assert {name: bar.get_width() for name, bar in shown.items()} == {
        name: pytest.approx(100.0 * loss) for name, loss in expected.items()
    }
    dark = [name for name, bar in shown.items() if colours.same_color(bar.get_facecolor(), "#0072B2")]
    assert dark == [law_of(pair.friction).title]


def test_the_map_of_orders(written):
    pair = pair_of(written)
    data = written.curves("orders_over_speed")
    table = data.pivot(index="order", columns="speed_rpm", values="amplitude [N]")
    _, _, _, speed, *_ = table.columns
    cycle = lumped.steady_state(pair.with_({"operating.pinion_speed": float(speed)}), samples_per_cycle=128)
    size = np.hypot(*(recomputed.amplitudes(cycle[f"bearing_force_{line}_p"].to_numpy()) for line in "xy"))
    close(table[speed], size, 1e-6)
    operating = written.parameters["operating"]["pinion_speed"]
    close(table.columns.to_numpy(), np.linspace(0.1 * operating, 2.0 * operating, 9))
    ax, bar = written.figures["orders_over_speed"].axes
    words, unit, factor = axis(bar.get_ylabel())
    assert (words, unit, ax.get_xlabel()) == ("force on the pinion bearings", "N", "pinion speed [rpm]")
    mesh = ax.collections[0]
    close(np.asarray(mesh.get_array()).reshape(table.shape) * factor, table.to_numpy())
    edges = np.asarray(mesh.get_coordinates())[0, :, 0]
    assert (np.diff(edges) > 0.0).all()
    assert (edges[0] < operating * 0.1 < edges[1], upright(ax)[-1:]) == (True, [operating])
    drawn = [line for line in ax.lines if line.get_xdata()[0] != operating]
    resonances = [
        60.0 * mode.natural_frequency / written.parameters["pinion"]["teeth"] for mode in modes(pair)
    ]
    points = {round(float(x * o), 3) for line in drawn for x, o in zip(*line.get_data(), strict=True)}
    assert points <= {round(one, 3) for one in resonances}
    inside = {round(r, 3) for r in resonances if edges[0] <= r / 10.0 and r <= edges[-1]}
    assert inside <= points


def test_the_stability_chart(written):
    """Growth ln(rho) times the mesh frequency, at most 0, at its nodes; operating point; regions."""
    chart = written.data("stability")
    ax = written.figures["stability_chart"].axes[0]
    radius = chart["spectral_radius"].transpose("damping_ratio", "speed_rpm").to_numpy()
    speed = chart["speed_rpm"].to_numpy()
    damping = chart["damping_ratio"].to_numpy()
    rate = np.log(radius) * speed / 60.0 * written.parameters["pinion"]["teeth"]
    drawn = (*ax.images, *(one for one in ax.collections if hasattr(one, "get_coordinates")))[0]
    close(np.asarray(drawn.get_array()).reshape(radius.shape), np.minimum(rate, 0.0), 1e-6)
    assert (ax.get_xlim(), ax.get_ylim()) == ((speed[0], speed[-1]), (damping[0], damping[-1]))
    assert "[1/s]" in written.figures["stability_chart"].axes[1].get_ylabel()
    mark = next(line for line in ax.lines if line.get_marker() == "o" and len(line.get_xdata()) == 1)
    operating = written.parameters["operating"]["pinion_speed"], written.parameters["mesh"]["damping_ratio"]
    assert (mark.get_xdata()[0], mark.get_ydata()[0]) == operating
    regions = written.curves("stability_chart")
    for name in ("radius", "nodes", "width", "speed_rpm", "damping_ratio"):
        close(column(regions, name)[0].astype(float), chart[f"region_{name}"])
