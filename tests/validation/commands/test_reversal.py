"""Does spurcheck reversal show the convergence where friction may hold the teeth?"""

from __future__ import annotations

from typer.testing import CliRunner

from validation.cli import app


def test_the_table_halves_the_velocity():
    shown = CliRunner().invoke(app, ["reversal", "--cycles", "1"], env={"COLUMNS": "200", "NO_COLOR": "1"})
    assert shown.exit_code == 0, shown.output
    rows = [line.split("│") for line in shown.stdout.splitlines() if line.startswith("│")]
    velocities = [float(row[1]) for row in rows]
    assert velocities == [8.0, 4.0, 2.0, 1.0, 0.5, 0.25]
    changes = [float(row[2].replace("\u00a0×\u00a010⁻⁴", "e-4")) for row in rows]
    assert changes == sorted(changes, reverse=True)
