"""Every number of the tables that say how sure a report is, computed again.

The tables of the motion, and helpers, are in ``test_numbers.py``.
"""

import hashlib
import json
import math
import re
from importlib import resources

import numpy as np
import pytest

import lumped
from floquet import gear_pair_multipliers
from lumped.labelling import source_hash
from lumped.path_of_contact import pair_stiffness
from tests.validation.reporting import recomputed
from tests.validation.reporting.columns import NAMED_NUMBERS, recomputes
from tests.validation.reporting.test_numbers import (
    LOSS_PARTS,
    assert_rows,
    balanced_loss,
    close,
    of_motion,
    pair_of,
)
from tests.validation.reporting.written import known
from validation.cross_check.conservation import worst_of_each
from validation.exchange.drawing_table import HEADINGS, drawing_rows
from validation.prediction.motion import predicted
from validation.validity.flags import validity_flags

_UNITS = {
    "module": "mm", "face_width": "mm", "bore": "mm", "backlash": "mm", "film_length": "mm",
    "tip_alteration": "mm",
    "pressure_angle": "°", "density": "kg/m³", "youngs_modulus": "GPa", "roughness": "µm",
    "sharpness": "1/mm",
    "loa_stiffness": "N/m", "oloa_stiffness": "N/m", "viscosity": "mPa s",
    "pinion_speed": "rpm", "pinion_torque": "N m", "size": "mm", "contact_angle": "°",
}  # fmt: skip
#: Row of the error budget -> its name.
_ERRORS = {
    "numerics": "numerical error", "programs": "same equations in two programs",
    "linear": "linear model, for charts", "contact": "form of the contact",
    "second": "exact contact and finite motions", "supports": "springs in place of shafts",
    "stiffness": "tooth stiffness by finite elements", "inputs": "inputs, 5 to 95 %",
    "measurement": "measurement",
}  # fmt: skip


@recomputes(
    "error_budget",
    error="error",
    dte="transmission error",
    share="% of peak to peak",
    tooth_force="tooth load",
    bearing_force="bearing force, rms",
    note="",
)
def test_the_error_budget(written):
    budget = written.data("budget")
    table = written.table("error_budget")
    numbers = written.document["numbers"]
    span = numbers["dte_peak_to_peak"]["value"]
    linear = written.data("linear").attrs
    samples = np.percentile(written.data("uncertainty")["dte_peak_to_peak"].to_numpy(), [5.0, 95.0])
    rows = dict(zip(budget["row"].to_numpy(), budget["dte"].to_numpy(), strict=True))
    assert rows["second"] == pytest.approx(abs(span - numbers["dte_peak_to_peak"]["second"]), rel=1e-9)
    assert rows["inputs"] == pytest.approx(0.5 * np.ptp(samples), rel=1e-9)
    other = {
        "mesh.contact": {"loaded": "prescribed", "prescribed": "loaded"}[
            written.parameters["mesh"]["contact"]
        ]
    }
    assert rows["contact"] == close(abs(span - predicted(pair_of(written).with_(other)).peak_to_peak))
    assert rows["linear"] == pytest.approx(abs(span - linear["dte_peak_to_peak"]), rel=1e-3)
    estimate = (linear | written.data("prediction").attrs)["error_estimate"]
    assert rows["numerics"] == pytest.approx(estimate * span, rel=1e-9)
    assert [one["error"] for one in table] == [_ERRORS[key] for key in rows]
    assert "; ".join(one["note"] for one in table) == budget.attrs["notes"]
    force = written.data("prediction")["normal_load"].sum("pair").mean().item()
    second = of_motion(written, "second_program")
    first = of_motion(written, "prediction")
    row = list(rows).index("second")
    assert table[row]["tooth_force"]["value"] == close(
        abs(first["tooth_load"] - second["tooth_load"]) * force
    )
    assert table[row]["bearing_force"]["value"] == close(abs(first["bearing_rms"] - second["bearing_rms"]))
    for place, one in enumerate(table):
        for column, unit in (("dte", "m"), ("tooth_force", "N"), ("bearing_force", "N")):
            size = float(budget[column][place])
            assert one[column] == ({"value": close(size), "unit": unit} if np.isfinite(size) else None)
        share = 100.0 * float(budget["dte"][place]) / span
        assert one["share"] == (close(share) if np.isfinite(share) else None)


@recomputes("ranges", result="result", given="as given", low="5 %", middle="50 %", high="95 %")
def test_the_table_of_ranges(written):
    samples = written.data("uncertainty")
    names = [
        n for n in samples.data_vars if samples[n].dims == ("sample",) and not n.startswith("bearing_order")
    ]
    assert [samples[n].attrs["long_name"] for n in names] == [
        one["result"] for one in written.table("ranges")
    ]
    for name, one in zip(names, written.table("ranges"), strict=True):
        values = [samples.attrs[f"given_{name}"], *np.percentile(samples[name].to_numpy(), [5.0, 50.0, 95.0])]
        unit, times = ("%", 100.0) if name == "efficiency" else (samples[name].attrs["units"], 1.0)
        for key, value in zip(("given", "low", "middle", "high"), values, strict=True):
            assert one[key] == {"value": close(times * value), "unit": unit}, (name, key)


@recomputes(
    "inputs_varied",
    field="input",
    spread="range",
    low="smallest",
    high="largest",
    correlation="rank corr.",
    reason="why this range",
)
def test_the_table_of_the_inputs_that_are_varied(written):
    samples = written.data("uncertainty")
    swing = samples["dte_peak_to_peak_swing"].to_numpy()
    width = np.abs(swing[:, 1] - swing[:, 0])
    table = written.table("inputs_varied")
    inputs = list(map(str, samples["input"].to_numpy()))
    places = [inputs.index(one["field"]) for one in table]
    assert sorted(places) == list(range(len(inputs)))
    assert (np.diff(width[places]) <= 0.0).all(), "the largest effect first"
    for j, one in zip(places, table, strict=True):
        assert one["low"] == {"value": close(swing[j].min()), "unit": "m"}
        assert one["high"] == {"value": close(swing[j].max()), "unit": "m"}
        rank = float(samples["dte_peak_to_peak_rank_correlation"][j])
        assert one["correlation"] == pytest.approx(rank, abs=0.00501)
    in_order = [table[places.index(j)] for j in range(len(inputs))]
    assert "; ".join(one["reason"] for one in in_order) == samples.attrs["reason"]
    for one, spread in zip(in_order, samples.attrs["written"].split("; "), strict=True):
        shown = one["spread"].replace("±", "+- ").replace("×", "* ").replace("÷", "/ ")
        assert shown.replace(" to ", " .. ").replace("\u00a0", "_") == spread
    damping = samples["value"].sel(input="mesh.damping_ratio").to_numpy()
    order = np.corrcoef(np.argsort(np.argsort(damping)), np.argsort(np.argsort(samples["dte_peak_to_peak"])))
    correlation = next(one for one in table if one["field"] == "mesh.damping_ratio")["correlation"]
    assert correlation == pytest.approx(order[0, 1], abs=0.00501)


@recomputes(
    "agreement",
    quantity="quantity",
    fidelity="second program",
    difference="difference",
    limit="limit",
    state="",
)
def test_the_table_of_agreement(written):
    first = written.data("prediction")
    second = written.data("second_program")
    limits = {("same equations", False): 1e-6, ("same equations", True): 1e-5}
    limits |= {("exact contact, finite motions", False): 0.05, ("exact contact, finite motions", True): 0.2}
    for one in written.table("agreement"):
        across = "off the line" in one["quantity"]
        assert one["limit"] == limits[one["fidelity"], across], one
        assert one["state"]["text"] == ("ok" if one["difference"] <= one["limit"] else "differs"), one
    differences = {
        (one["quantity"], one["fidelity"]): one["difference"] for one in written.table("agreement")
    }
    assert len(differences) == 14
    period = 1.0 / recomputed.mesh_frequency(written.parameters)
    curve = np.interp(second["time"] % period, first["time"], first["dte"], period=period)
    size = np.abs(second["dte"].to_numpy() - curve).max() / np.ptp(first["dte"].to_numpy())
    # Samples of the prediction lie between those of the second program.
    name = "dynamic transmission error"
    assert differences[name, "exact contact, finite motions"] == pytest.approx(size, rel=0.25)
    assert differences[name, "same equations"] < 1e-6
    again = known(written.document["gear_pair"]).check.agreements  # tests of the cross-check compute them
    assert [one["quantity"] for one in written.table("agreement")] == [one.long_name for one in again]
    assert list(differences.values()) == [close(one.difference) for one in again]


@recomputes("conservation", check="check", value="residual", limit="limit", state="")
def test_the_table_of_conservation_laws(written):
    """One row a law: the check that uses most of its limit. Tests of the cross-check compute residuals."""
    worst = worst_of_each(known(written.document["gear_pair"]).check.conservation)
    assert [(one["check"], one["value"], one["limit"]) for one in written.table("conservation")] == [
        (law.check, close(law.value), close(law.limit)) for law in worst
    ]
    for one in written.table("conservation"):
        assert one["state"]["text"] == ("ok" if one["value"] <= one["limit"] else "failed"), one
        assert one["state"]["state"] == one["state"]["text"]


@recomputes(
    "elasticity",
    quantity="quantity",
    source="second value",
    difference="difference",
    limit="limit",
    state="",
)
def test_the_table_of_the_stiffness_beside_second_values(written):
    """Tests of the cross-check compute the differences: tests/validation/cross_check/test_stiffness.py."""
    agreements = known(written.document["gear_pair"]).check.stiffness
    rows = written.table("elasticity")
    assert [(one["quantity"], one["source"], one["difference"], one["limit"]) for one in rows] == [
        (agreement.long_name, agreement.source, close(agreement.difference), close(agreement.limit))
        for agreement in agreements
    ]
    for one, agreement in zip(rows, agreements, strict=True):
        passes = one["difference"] <= one["limit"]
        assert one["state"]["state"] == ("ok" if passes else "failed"), one
        small = passes and 0.0 < agreement.size <= agreement.limit
        assert one["state"]["text"] == ("ok, smaller than the limit" if small else one["state"]["state"]), one


@recomputes("losses_of_both", place="place", lumped="lumped model", second="second program")
def test_the_table_of_the_losses_of_both_programs(written):
    """The lumped losses are those of page 1, the sum of the second program is its power balance."""
    rows = {one["place"]: one for one in written.table("losses_of_both")}
    assert list(rows) == [*LOSS_PARTS, "all places"]
    page_1 = {one["name"]: one["value"]["value"] for one in written.table("losses")}
    loss = known(written.document["gear_pair"]).check.loss
    for column, total in (("lumped", page_1["loss, all places"]), ("second", balanced_loss(written))):
        assert {one[column]["unit"] for one in rows.values()} == {"W"}
        parts = [rows[name][column]["value"] for name in LOSS_PARTS]
        assert sum(parts) == close(rows["all places"][column]["value"])
        assert rows["all places"][column]["value"] == pytest.approx(total, rel=2e-2)
    assert [one["second"]["value"] for one in rows.values()][:3] == [
        close(loss.multibody[place]) for place in loss.lumped
    ]


@recomputes("gears", **{heading: heading for heading in HEADINGS})
def test_the_table_of_both_gears(written):
    rows = [tuple(one.values()) for one in written.table("gears")]
    assert rows == drawing_rows(pair_of(written))  # tests of the drawing's table compute them
    teeth = next(one for one in written.table("gears") if one["symbol"] == "z")
    assert [teeth[gear] for gear in ("pinion", "gear")] == [
        str(written.parameters[gear]["teeth"]) for gear in ("pinion", "gear")
    ]


@recomputes("derived", **NAMED_NUMBERS)
def test_the_table_of_derived_quantities(written):
    parameters = written.parameters
    pair = pair_of(written)
    start, _, end, _ = recomputed.path_of_contact(parameters)
    rack = parameters["basic_rack"]
    pitch = 1e-3 * math.pi * rack["module"] * math.cos(math.radians(rack["pressure_angle"]))
    # Of the operating pitch circles, of which a pitch is longer than the base pitch by 1/cos of the angle.
    velocity = (
        recomputed.mesh_frequency(parameters) * pitch / math.cos(recomputed.operating_angle(parameters))
    )
    ratio = (end - start) / pitch
    assert_rows(
        written,
        "derived",
        {
            "contact ratio": (ratio, "1"),
            "base pitch": (pitch, "m"),
            "operating pressure angle": (math.degrees(recomputed.operating_angle(parameters)), "°"),
            "path of contact, A to D": (end - start, "m"),
            "mesh frequency": (recomputed.mesh_frequency(parameters), "Hz"),
            "pitch line velocity": (velocity, "m/s"),
            "mean mesh stiffness": (pair_stiffness(pair).mean() * ratio, "N/m", pair.stiffness_words),
            "effective mass": (lumped.bodies(pair).effective_mass, "kg", "of both gears"),
        },
    )


@recomputes("parameters", field="field", value="value", unit="unit", source="source", range="range", state="")
def test_the_table_of_parameters(written):
    parameters = written.parameters
    sources = parameters["sources"]
    spreads = written.data("uncertainty")
    written_as = dict(
        zip(map(str, spreads["input"].to_numpy()), spreads.attrs["written"].split("; "), strict=True)
    )
    for gear in ("pinion", "gear"):  # both directions of a bearing are one input
        for direction in ("loa", "oloa"):
            written_as[f"bearings.{gear}.{direction}_damping_ratio"] = written_as[
                f"bearings.{gear}.damping_ratio"
            ]
    table = written.table("parameters")
    for one in table:
        section, _, name = one["field"].rpartition(".")
        value = parameters
        if follows := name == "tip_alteration" and name not in parameters[section]:
            value = pytest.approx(recomputed.tip_alteration(parameters), abs=1e-9)
        else:
            for part in one["field"].split("."):
                value = value[part]
        shown = ", ".join(f"{v:g}" for v in value) if isinstance(value, list) else value
        assert one["value"] == shown, one
        assert one["unit"] == _UNITS.get(name, ""), one
        source = next((sources[key] for key in (one["field"], section) if key in sources), None)
        if source is not None:
            assert one["source"] == source
        if one["state"] != "not read":
            assert (one["state"]["text"] if one["state"] else "") == (
                "assumed" if follows or one["field"] in parameters["assumed"] else ""
            ), one
        assert one["range"] == written_as.get(one["field"], ""), one
    states = [one["state"] for one in table]
    known_count = states.count("")
    unread_count = states.count("not read")
    assumed_count = len(table) - known_count - unread_count
    # Of friction what the laws do not read between which it varies; the backlash where contact is kept.
    not_read = {one["field"] for one in table if one["state"] == "not read"}
    assert {"friction.sharpness", "friction.thresholds"} <= not_read
    assert ("mesh.backlash" in not_read) == ("least_force" not in written.document["numbers"])
    caption = written.document["chapters"]["inputs"]["tables"]["parameters"]["caption"]
    assert caption == (
        f"All values: {known_count} known, {assumed_count} assumed, "
        f"{unread_count} that the chosen laws and models do not read."
    )
    assert (
        written.sentences["inputs"] == f"{assumed_count} of {known_count + assumed_count} values are assumed."
    )


@recomputes("evidence", kind="kind", checks="checks", use="largest error / limit", state="")
def test_the_table_of_evidence(written):
    stored = json.loads(resources.files("validation").joinpath("evidence.json").read_text("utf-8"))
    assert [one["kind"] for one in written.table("evidence")] == [kind["title"] for kind in stored["kinds"]]
    for one, kind in zip(written.table("evidence"), stored["kinds"], strict=True):
        shares = [abs(c["value"] - c.get("theory", 0.0)) / c["limit"] for c in kind["checks"] if c["limit"]]
        assert (one["checks"], one["use"]) == (len(kind["checks"]), close(max(shares)))
        assert one["state"]["text"] == ("ok" if max(shares) <= 1.0 else "failed")
    chapter = written.document["chapters"]["evidence"]
    faults = stored["faults"]
    note = (
        f"Of {faults['all']} faults put into the program, {faults.get('missed', 0)} are missed by all checks."
    )
    assert chapter["tables"]["evidence"]["note"] == note
    assert ("They were made with this version." in chapter["text"][1][0]) == (
        stored["source_sha256"] == source_hash()
    )


@recomputes("assumptions", name="assumption", state="", detail="found", action="what to do")
def test_the_table_of_assumptions(written):
    flags = validity_flags(pair_of(written), written.data("linear"), gear_pair_multipliers(pair_of(written)))
    assert [(one["name"], one["detail"], one["action"]) for one in written.table("assumptions")] == [
        (flag.name, flag.detail, flag.action) for flag in flags
    ]
    assert [one["state"]["state"] for one in written.table("assumptions")] == [flag.state for flag in flags]
    states = {one["name"]: one["state"]["text"] for one in written.table("assumptions")}
    total = written.data("linear")["normal_load"].sum("pair").min().item()
    assert states["Teeth stay in contact"] == ("ok" if total > 0.0 else "violated")


@recomputes("relations", relation="", state="")
def test_the_table_of_relations(written):
    assert written.table("relations") == [{"relation": "all hold", "state": {"state": "ok", "text": "ok"}}]


@recomputes("made_from", name="", value="")
def test_the_table_of_the_origin_of_the_report(written):
    text = (written.folder / "data" / "parameters.toml").read_bytes()
    made = {one["name"]: one["value"] for one in written.table("made_from")}
    assert made["parameters, SHA-256"] == hashlib.sha256(text).hexdigest()
    assert re.match(r"python \d+\.\d+", made["versions"])
