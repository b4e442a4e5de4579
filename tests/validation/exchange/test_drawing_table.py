"""Do `spurcheck init` and the report show the pair as its drawing states it, and what of it is assumed?"""

from typer.testing import CliRunner

from validation.cli import app
from validation.exchange.drawing_table import HEADINGS, drawing_rows
from validation.exchange.new_pair_file import new_pair
from validation.reporting.chapters import inputs
from validation.reporting.effort import QUICK
from validation.reporting.results import Results

#: 12/24 of module 3 with shifts 0.6 and 0.36, as printed by the manufacturer's worked example.
PRINTED = {
    "tip diameter": ("44.840", "79.400"), "root diameter": ("32.100", "66.660"),
    "profile shift coefficient": ("0.6000", "0.3600"), "centre distance": ("56.500", ""),
}  # fmt: skip
SHIFTS = {"pinion.profile_shift": 0.6, "gear.profile_shift": 0.36}


def rows_of(pair):
    return {row[0]: dict(zip(HEADINGS, row, strict=True)) for row in drawing_rows(pair)}


def test_the_rows_are_those_of_the_worked_example_and_say_what_is_assumed():
    pair = new_pair("12/24", 3.0, 20.0, 1000.0, 30.0, SHIFTS)
    rows = rows_of(pair)
    for quantity, values in PRINTED.items():
        assert (rows[quantity]["pinion"], rows[quantity]["gear"]) == values
    assert rows["tip diameter"]["assumed"] == "both"
    assert rows["normal backlash"]["assumed"] == "yes"
    assert rows["profile shift coefficient"]["assumed"] == rows["module"]["assumed"] == ""
    rows_by_word = rows_of(pair.with_({"gear.tip_diameter": 79.4}))
    assert rows_by_word["tip diameter"]["assumed"] == "pinion"


def test_init_prints_them_beside_the_file(tmp_path):
    changes = [part for path, value in SHIFTS.items() for part in ("--set", f"{path}={value}")]
    drawing = ["--teeth", "12/24", "--module", "3", "--face-width", "20", "--speed", "1000", "--torque", "30"]
    file = tmp_path / "pair.toml"
    result = CliRunner().invoke(app, ["init", *drawing, *changes, "-o", str(file)], env={"COLUMNS": "160"})
    assert result.exit_code == 0, result.output
    lines = [" ".join(line.replace("│", " ").split()) for line in result.output.splitlines()]
    assert "tip diameter d_a mm 44.840 79.400 both" in lines
    assert "transverse contact ratio epsilon_alpha 1.2021" in lines
    assert file.exists()


def test_the_report_has_the_same_rows():
    pair = new_pair("12/24", 3.0, 20.0, 1000.0, 30.0, SHIFTS | {"mesh.stiffness": "energy"})
    table = next(one for one in inputs.write(Results(pair, QUICK)).blocks if one.key == "gears")
    assert list(table.rows) == drawing_rows(pair)
