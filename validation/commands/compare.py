"""spurcheck compare: in which share of all possible machines one variant is better than another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
from validation.commands.cluster import cluster_of
from validation.commands.terminal import guarded, note, print_json, progress_bar, show, stdout

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr

    from lumped import GearPair

Pairs = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="PAIR...",
        help="Presets or parameter files (TOML): the variants A, B, ...; with --variant one pair alone.",
        show_default=opt.DEFAULT_PAIR,
    ),
]
Variants = Annotated[
    list[str] | None,
    typer.Option(
        "--variant",
        metavar="FIELD=VALUE",
        help="A variant of the pair, as often as needed; several changes stand between semicolons: "
        "--variant 'torque=60; oil=vg220'.",
    ),
]


@guarded
def compare(
    files: opt.ResultFiles,
    pairs: Pairs = None,
    variant: Variants = None,
    speed: opt.Speed = None,
    torque: opt.Torque = None,
    law: opt.Law = None,
    settings: opt.Settings = None,
    samples: opt.Samples = None,
    seed: int = 1,
    seconds: opt.Seconds = None,
    cluster: opt.Cluster = None,
    wait_seconds: opt.WaitSeconds = None,
    supports: opt.Supports = None,
    as_json: opt.Json = False,
) -> None:
    r"""Say in how many of 100 possible machines one variant of a gear pair is better than another.

    Every sample is a machine in which all variants run. A shared input has the same value in all variants.
    Inputs vary as in 'spurcheck uncertainty'. --speed, --torque, --law and --set change all variants.
    A smaller result is better, but for the efficiency a larger value is better. Without tooth errors in the
    file the teeth are perfect here: only the report draws teeth of an assumed class.

    [bold]Examples[/bold]
    spurcheck compare mypair.toml other.toml
    spurcheck compare mypair.toml --variant bearings.stiffness=3e8 --variant 'oil=vg220; temperature=60'
    spurcheck compare mypair.toml --variant torque=60 --samples 512 -o machines.nc -o differences.png
    spurcheck compare mypair.toml other.toml --samples 4096 --cluster tcp://head:8786

    Parameters
    ----------
    seed : Start of the random numbers: the same seed gives the same possible machines.
    """
    from validation.prediction.compare import compare as run

    names, gear_pairs = _variants(pairs, variant, speed=speed, torque=torque, law=law, settings=settings)
    limits = opt.limits_of_samples(samples, seconds, cluster)
    options: dict[str, Any] = {"names": names, "seed": seed, "supports": supports, **limits}
    with cluster_of(cluster, wait_seconds) as executor, progress_bar("possible machines") as tell:
        comparison = run(*gear_pairs, executor=executor, progress=tell, **options)
    if as_json:
        print_json(_as_json(comparison))
    else:
        _show(comparison)
    for remark in comparison.attrs["remarks"]:
        note(f"{remark}.")
    files.write(comparison)


def _variants(
    pairs: Sequence[str] | None, changes: Sequence[str] | None, **options: Any
) -> tuple[list[str], list[GearPair]]:
    """Return the names of the variants and the variants. Several pairs together with changes are refused."""
    from lumped.errors import refuse

    if changes is None:
        if len(pairs or ()) < 2:
            action = "Name two files, or one with --variant FIELD=VALUE."
            raise refuse("PAIR", ", ".join(pairs or ["none"]), "two pairs or more", action)
        return list(pairs or ()), [opt.gear_pair(one, **options) for one in pairs or ()]
    if len(pairs or ()) > 1:
        raise refuse("--variant", changes[0], "one pair, which it changes", "Leave the other pairs out.")
    base = pairs[0] if pairs else None
    variants = [opt.gear_pair(base, variant=one, **options) for one in (None, *changes)]
    return [base or opt.DEFAULT_PAIR, *changes], variants


def _show(comparison: xr.Dataset) -> None:
    """Print one sentence, the list of variants, one table, and how to read the table."""
    from validation.prediction.compare import (
        FLAGS,
        LARGER,
        OF_TEETH,
        RESULTS,
        SURE,
        as_read,
        of_hundred,
        ranking,
    )

    letters = [str(result) for result in comparison["variant"].to_numpy()]
    console = stdout()
    console.print(str(comparison["sentence"][0].item()))
    for letter, name in zip(letters, comparison["name"].to_numpy(), strict=True):
        console.print(f"{letter}  {name}")
    two_variants = len(letters) == 2
    rows = []
    for result in comparison["result"].to_numpy():
        of_result = comparison.sel(result=result)
        values_as_given = comparison[f"{result}_given"].to_numpy()
        cells, unit = as_read(result, values_as_given)
        better = ", larger is better" if result in LARGER else ""
        text = f"{(RESULTS | OF_TEETH)[str(result)]}{better}" + (f" [{unit.strip()}]" if unit else "")
        if two_variants:
            ends = comparison[f"{result}_difference"].sel(variant="B", other="A", percentile=[5.0, 95.0])
            (low, high), _ = as_read(result, ends.to_numpy(), 2, values_as_given)
            last_column = f"{low} to {high}"
        else:
            best = of_result["best"].to_numpy()
            last_column = f"{letters[int(best.argmax())]} in {of_hundred(float(best.max()))}"
        least, most = (of_hundred(float(end_words)) for end_words in of_result["holds_interval"])
        holds = f"{of_hundred(float(of_result['holds']))} ({least} to {most})"
        order = ranking(of_result["place"].to_numpy().tolist(), letters)
        rows.append((text, *cells, last_column, order, holds))
    for name, text in FLAGS.items():
        if comparison[name].any() or name == "contact_lost":
            shares = [str(of_hundred(float(share))) for share in comparison[name]]
            rows.append((f"{text} [of 100]", *shares, "", "", ""))
    values = "".join(f" | >{letter}" for letter in letters)
    show(
        "", f"result{values} | >{'B less A' if two_variants else 'best'} | as given | >holds in, of 100", rows
    )
    refused = (
        f", {comparison.attrs['refused']} left out without a prediction"
        if comparison.attrs["refused"]
        else ""
    )
    samples_taken = comparison.attrs["taken"]
    samples_wanted = comparison.attrs["asked"]
    count_words = (
        f"{samples_taken} of {samples_wanted}" if samples_taken < samples_wanted else f"{samples_taken}"
    )
    end_words = f"; {opt.time_words(comparison)}" if samples_taken < samples_wanted else ""
    console.print(f"{count_words} possible machines, seed {comparison.attrs['seed']}{refused}{end_words}")
    if two_variants:
        console.print("B less A: 5 to 95 % of the difference in the same machine")
    else:
        console.print("best: the variant that is best most often, and in how many of 100 machines")
    console.print("A, B and as given: values of the files, and their order from the best to the worst")
    console.print(f"holds in: machines in which the order is this one, and the {100 * SURE:.0f} % interval")


def _as_json(comparison: xr.Dataset) -> dict[str, Any]:
    """Return the table as JSON data: numbers in SI, shares of the machines from 0 to 1."""
    from validation.prediction.compare import FLAGS

    letters = [str(result) for result in comparison["variant"].to_numpy()]

    def by_letter(values: xr.DataArray) -> dict[str, Any]:
        return dict(zip(letters, values.to_numpy().tolist(), strict=True))

    results = {}
    for result in map(str, comparison["result"].to_numpy()):
        of_result = comparison.sel(result=result)
        results[result] = {
            "unit": comparison[result].attrs["units"],
            "given": by_letter(comparison[f"{result}_given"]),
            "place": by_letter(of_result["place"]),
            "holds": float(of_result["holds"]),
            "holds_interval": of_result["holds_interval"].to_numpy().tolist(),
            "best": by_letter(of_result["best"]),
            "better": {a: by_letter(of_result["better"].sel(variant=a)) for a in letters},
            "difference": {
                a: {
                    b: comparison[f"{result}_difference"].sel(variant=a, other=b).to_numpy().tolist()
                    for b in letters
                    if b != a
                }
                for a in letters
            },
            "sentence": str(of_result["sentence"].item()),
        }
    flags = {name: by_letter(comparison[name]) for name in FLAGS}
    names = dict(zip(letters, map(str, comparison["name"].to_numpy()), strict=True))
    settings = {
        key: comparison.attrs[key] for key in ("supports", "seed", "taken", "asked", "refused", "remarks")
    }
    return (
        {"variants": names, "samples": comparison.sizes["sample"]} | settings | {"results": results} | flags
    )
