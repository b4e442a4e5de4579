"""spurcheck measurement: a measured record beside its prediction, and the friction found from it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.terminal import guarded, stderr, stdout, table

if TYPE_CHECKING:
    from validation.measurements import Evaluation


@guarded
def measurement(
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="Description of the record (TOML).")],
    pair: opt.PairArgument = None,
    output: Annotated[
        Path | None, opt.output("Folder for overlay, metrics and figure, new or empty.")
    ] = None,
    identify: Annotated[
        list[str] | None,
        typer.Option(
            "--identify",
            metavar="WHAT",
            help="Identify friction: mu (constant coefficient) or the name of a law (scale on it); as often "
            "as needed.",
        ),
    ] = None,
    shift: Annotated[
        float | None,
        typer.Option("--shift", help="Known mesh phase in mesh cycles; default: found from the record."),
    ] = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    example: Annotated[
        bool,
        typer.Option(
            "--example",
            help="Write an example into the new folder RECORD instead: computed forces with noise.",
        ),
    ] = False,
    force: opt.ForceFolder = False,
) -> None:
    """Lay a measured record over its prediction and identify the friction coefficient.

    RECORD names the CSV file, its columns with their units, the sampling, speed and torque. The record is
    aligned by its mesh phase; every metric comes with a 95 % interval from resampled mesh cycles, the
    friction with a confidence interval that allows for correlated noise and noise on the normal load.

    [bold]Examples[/bold]

    spurcheck measurement tooth_forces --example

    spurcheck measurement tooth_forces/measurement.toml --identify mu --identify xu_kahraman -o evaluation
    """
    from validation.files.folder import MEASUREMENT, check_target, whole_folder
    from validation.measurements import evaluate, load_measurement

    if output is not None:
        check_target(output, force=force, kind=MEASUREMENT)
    gear_pair = opt.gear_pair(pair, None, None, law, settings)
    if example:
        _write_example(gear_pair, record, force=force)
        return
    measured = load_measurement(record)
    found = evaluate(measured, gear_pair, identify=identify or (), shift=shift)
    _show(found)
    if output is not None:
        with whole_folder(output, force=force, kind=MEASUREMENT) as folder:
            _write(found, folder)
        stderr().print(f"wrote {output}")


def _write_example(gear_pair: Any, record: Path, *, force: bool) -> None:
    """Write a computed record whose truth is stated."""
    from validation.files.folder import MEASUREMENT, check_target, whole_folder
    from validation.measurements import predict, synthetic_measurement, write_measurement

    check_target(record, force=force, kind=MEASUREMENT)
    truth = predict(gear_pair)
    made = synthetic_measurement(truth, seed=1, engagements=2, correlation=0.5, start=0.37)
    with whole_folder(record, force=force, kind=MEASUREMENT) as folder:
        write_measurement(made, folder)
        note = {"format": MEASUREMENT.format, "example_of": gear_pair.name, "law": gear_pair.friction.law}
        (folder / MEASUREMENT.file).write_text(json.dumps(note) + "\n", encoding="utf-8")
    stderr().print(
        f"wrote {record / 'measurement.toml'}: tooth forces of {gear_pair.name} computed with "
        f"{gear_pair.friction.law} friction, 2 % noise"
    )


def _show(found: Evaluation) -> None:
    from validation.files.formatting import number, quantity

    spec, console = found.measurement.spec, stdout()
    rpm = spec.pinion_speed * 30.0 / math.pi
    console.print(
        f"{spec.name}: {found.measurement.abscissa.size} samples at {rpm:.6g} rpm and "
        f"{spec.pinion_torque:.5g} N m; mesh phase {found.alignment.shift:.5f} "
        f"± {found.alignment.standard_error:.1g} mesh cycles, "
        f"{100 * found.alignment.share_explained:.1f} % of the variation explained"
    )
    rows = []
    for name in found.metrics["channel"].to_numpy():
        row = {str(key): float(value) for key, value in found.metrics.sel(channel=name).data_vars.items()}
        unit = str(found.points["units"].sel(channel=name).item())
        low, high = 100 * row["relative_rms_low"], 100 * row["relative_rms_high"]
        sizes = (quantity(row[key], unit, 3) for key in ("bias", "rms"))
        share, between = number(100 * row["relative_rms"], 3), f"{number(low, 3)} to {number(high, 3)}"
        rows.append((str(name), *sizes, share, between, number(row["correlation"], 4)))
    title = f"measured against {found.prediction.pair.name}, {found.prediction.pair.friction.law} friction"
    headings = (">bias", ">rms", ">rms/span [%]", ">95 % interval", ">correlation")
    console.print(table(title, "channel", *headings, rows=rows))
    for one in found.found:
        console.print(f"identified: {one.text}")
        console.print(
            f"  mean |mu| over the path of contact {one.mean_mu:.4g}; left over "
            f"{quantity(one.residual_rms, 'N', 3)} rms"
        )


def _write(found: Evaluation, folder: Path) -> None:
    from dataclasses import asdict

    import numpy as np

    from validation.files.folder import MEASUREMENT
    from validation.files.output import write_dataset
    from validation.plots.motion import overlay_figure
    from validation.plots.style import save

    write_dataset(found.points, folder / "overlay.nc")
    found.points.to_dataframe().reset_index().to_csv(
        folder / "overlay.csv", index=False, float_format="%.9g", lineterminator="\n"
    )
    picture = overlay_figure(found.points)
    for suffix in (".svg", ".png"):
        save(picture, folder / f"overlay{suffix}")
    metrics = found.metrics
    data = {
        "format": MEASUREMENT.format,
        "record": found.measurement.spec.name,
        "source": found.measurement.spec.source,
        "record_sha256": found.measurement.sha256,
        "gear_pair": found.prediction.pair.name,
        "law": found.prediction.pair.friction.law,
        "alignment": {
            "shift": found.alignment.shift,
            "standard_error": found.alignment.standard_error,
            "share_explained": found.alignment.share_explained,
        },
        "metrics": {
            str(name): {
                str(key): float(value) if np.isfinite(value) else None
                for key, value in metrics.sel(channel=name).data_vars.items()
            }
            for name in metrics["channel"].to_numpy()
        },
        "identified": [asdict(one) | {"text": one.text} for one in found.found],
        "parameters": found.prediction.pair.to_mapping(),
    }
    text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
    (folder / MEASUREMENT.file).write_text(text + "\n", encoding="utf-8")
