"""spurcheck compare: in which share of all possible machines one variant is better than another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from validation.commands import options as opt
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
    supports: opt.Supports = None,
    as_json: opt.Json = False,
) -> None:
    r"""Say in how many of 100 possible machines one variant of a gear pair is better than another.

    Every sample is a machine in which all variants run: an input that they share has the same value in all of
    them. Inputs vary as in 'spurcheck uncertainty'. --speed, --torque, --law and --set change all variants.
    Smaller results are better, of the efficiency a larger one.

    [bold]Examples[/bold]
    spurcheck compare mypair.toml other.toml
    spurcheck compare mypair.toml --variant bearings.stiffness=3e8 --variant 'oil=vg220; temperature=60'
    spurcheck compare mypair.toml --variant torque=60 --samples 512 -o machines.nc -o differences.png

    Parameters
    ----------
    seed : Of the sampled points.
    """
    from validation.prediction.compare import compare as run

    names, given = _variants(pairs, variant, speed=speed, torque=torque, law=law, settings=settings)
    limits = opt.limits_of_samples(samples, seconds)
    with progress_bar("possible machines") as tell:
        found = run(*given, names=names, seed=seed, supports=supports, progress=tell, **limits)
    if as_json:
        print_json(_as_json(found))
    else:
        _show(found)
    for remark in found.attrs["remarks"]:
        note(f"{remark}.")
    files.write(found)


def _variants(
    pairs: Sequence[str] | None, changes: Sequence[str] | None, **options: Any
) -> tuple[list[str], list[GearPair]]:
    """What each variant is called, and the variants; refused are several pairs beside changes."""
    from lumped.errors import refuse

    if changes is None:
        if len(pairs or ()) < 2:
            action = "Name two files, or one with --variant FIELD=VALUE."
            raise refuse("PAIR", ", ".join(pairs or ["none"]), "two pairs or more", action)
        return list(pairs or ()), [opt.gear_pair(one, **options) for one in pairs or ()]
    if len(pairs or ()) > 1:
        raise refuse("--variant", changes[0], "one pair, which it changes", "Leave the other pairs out.")
    base = pairs[0] if pairs else None
    made = [opt.gear_pair(base, variant=one, **options) for one in (None, *changes)]
    return [base or opt.DEFAULT_PAIR, *changes], made


def _show(found: xr.Dataset) -> None:
    """Print a sentence, the variants, one table, and how to read it."""
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

    letters = [str(one) for one in found["variant"].to_numpy()]
    console = stdout()
    console.print(str(found["sentence"][0].item()))
    for letter, name in zip(letters, found["name"].to_numpy(), strict=True):
        console.print(f"{letter}  {name}")
    two = len(letters) == 2
    rows = []
    for one in found["result"].to_numpy():
        of = found.sel(result=one)
        given = found[f"{one}_given"].to_numpy()
        cells, unit = as_read(one, given)
        better = ", larger is better" if one in LARGER else ""
        text = f"{(RESULTS | OF_TEETH)[str(one)]}{better}" + (f" [{unit.strip()}]" if unit else "")
        if two:
            ends = found[f"{one}_difference"].sel(variant="B", other="A", percentile=[5.0, 95.0])
            (low, high), _ = as_read(one, ends.to_numpy(), 2, given)
            other = f"{low} to {high}"
        else:
            best = of["best"].to_numpy()
            other = f"{letters[int(best.argmax())]} in {of_hundred(float(best.max()))}"
        least, most = (of_hundred(float(end)) for end in of["holds_interval"])
        holds = f"{of_hundred(float(of['holds']))} ({least} to {most})"
        order = ranking(of["place"].to_numpy().tolist(), letters)
        rows.append((text, *cells, other, order, holds))
    for name, text in FLAGS.items():
        if found[name].any() or name == "contact_lost":
            shares = [str(of_hundred(float(share))) for share in found[name]]
            rows.append((f"{text} [of 100]", *shares, "", "", ""))
    values = "".join(f" | >{letter}" for letter in letters)
    show("", f"result{values} | >{'B less A' if two else 'best'} | as given | >holds in, of 100", rows)
    refused = f", {found.attrs['refused']} left out without a prediction" if found.attrs["refused"] else ""
    taken = found.attrs["taken"]
    asked = found.attrs["asked"]
    begun = f"{taken} of {asked}" if taken < asked else f"{taken}"
    end = f"; {opt.time_words(found)}" if taken < asked else ""
    console.print(f"{begun} possible machines, seed {found.attrs['seed']}{refused}{end}")
    if two:
        console.print("B less A: 5 to 95 % of the difference in the same machine")
    else:
        console.print("best: the variant that is best most often, and in how many of 100 machines")
    console.print("A, B and as given: values of the files, and their order from the best to the worst")
    console.print(f"holds in: machines in which the order is this one, and the {100 * SURE:.0f} % interval")


def _as_json(found: xr.Dataset) -> dict[str, Any]:
    """The table in SI; shares of the machines from 0 to 1."""
    from validation.prediction.compare import FLAGS

    letters = [str(one) for one in found["variant"].to_numpy()]

    def by_letter(values: xr.DataArray) -> dict[str, Any]:
        return dict(zip(letters, values.to_numpy().tolist(), strict=True))

    results = {}
    for one in map(str, found["result"].to_numpy()):
        of = found.sel(result=one)
        results[one] = {
            "unit": found[one].attrs["units"],
            "given": by_letter(found[f"{one}_given"]),
            "place": by_letter(of["place"]),
            "holds": float(of["holds"]),
            "holds_interval": of["holds_interval"].to_numpy().tolist(),
            "best": by_letter(of["best"]),
            "better": {a: by_letter(of["better"].sel(variant=a)) for a in letters},
            "difference": {
                a: {
                    b: found[f"{one}_difference"].sel(variant=a, other=b).to_numpy().tolist()
                    for b in letters
                    if b != a
                }
                for a in letters
            },
            "sentence": str(of["sentence"].item()),
        }
    flags = {name: by_letter(found[name]) for name in FLAGS}
    names = dict(zip(letters, map(str, found["name"].to_numpy()), strict=True))
    kept = {key: found.attrs[key] for key in ("supports", "seed", "taken", "asked", "refused", "remarks")}
    return {"variants": names, "samples": found.sizes["sample"]} | kept | {"results": results} | flags
