"""Losses of the mesh by friction law and along the path of contact, and the film between the teeth."""

from __future__ import annotations

import numpy as np

from lumped import GearPair
from lumped.lubrication.viscosity import ZERO_CELSIUS
from lumped.path_of_contact import contact_path
from validation.plots.efficiency import efficiency_figure, film_figure, sliding_power_figure
from validation.reporting.blocks import Block, Chapter, Fact, Facts, Picture, Quantity, Rows, Table, Text
from validation.reporting.chapters.steady_state import unstable_warning
from validation.reporting.results import Results


def losses(results: Results) -> Chapter:
    """Write the chapter."""
    return Chapter(
        "losses", "Losses and film", (*unstable_warning(results), *_losses(results), *_film(results))
    )


def _losses(results: Results) -> list[Block]:
    pair, g, found = results.pair, results.geometry, results.mesh
    by_law, numbers = found.losses, found.numbers
    blocks: list[Block] = []
    if by_law.sizes["law"]:
        chosen = pair.friction.law
        rows: Rows = []
        for name in by_law["law"].to_numpy():
            row = by_law.sel(law=name)
            dynamic = float(row["mesh_efficiency_dynamic"])
            rows.append(
                (
                    str(row["law_title"].item()),
                    float(row["path_coefficient"]),
                    float(row["mean_coefficient"]),
                    Quantity(float(row["power_loss"]), "W"),
                    float(row["mesh_efficiency_closed_form"]),
                    float(row["mesh_efficiency"]),
                    None if np.isnan(dynamic) else dynamic,
                )
            )
        own = [i for i, name in enumerate(by_law["law"].to_numpy()) if str(name) == chosen]
        blocks += [
            Picture(
                "efficiency_by_law",
                "Loss of the mesh by friction law: mean |µ| times Ohlendorf's closed loss factor, the "
                "quasi-static integral, and the periodic motion.",
                lambda: efficiency_figure(by_law, chosen),
            ),
            Table(
                "efficiency_by_law",
                "Mesh efficiency by friction law, sliding losses only.",
                {
                    "law": "law",
                    "path_coefficient": "mean |µ| over the path",
                    "mean_coefficient": "µ weighted by the loss",
                    "power_loss": "sliding loss, quasi-static",
                    "closed_form": "efficiency, closed form",
                    "quasi_static": "efficiency, quasi-static",
                    "dynamic": "efficiency, periodic motion",
                },
                tuple(rows),
                frozenset(own),
            ),
        ]
    if by_law.attrs["left_out"]:
        blocks.append(Text("Laws that this pair does not allow:", tuple(by_law.attrs["left_out"])))
    blocks += [
        Picture(
            "sliding_power",
            "Left: sliding power of one tooth pair along the path of contact. Right: instantaneous mesh "
            "efficiency over the mesh cycle. Law of this report, without and with vibration.",
            lambda: sliding_power_figure(
                g, found.quasi_static, found.periodic, (found.instants, found.instants_periodic)
            ),
        ),
        Facts(
            "losses",
            (
                Fact("input_power", "input power", Quantity(numbers.input_power, "W")),
                Fact("ohlendorf", "loss factor, Ohlendorf's closed form", numbers.ohlendorf),
                Fact("uniform", "loss factor, integrated, equal load sharing", numbers.uniform),
                Fact("stiffness", "loss factor, load shared by stiffness", numbers.stiffness),
                Fact("loaded", "loss factor, with the flanks' relief under load", numbers.loaded),
                Fact("iso_coefficient", "mean µ of ISO/TR 14179-2", numbers.iso_coefficient),
                Fact("iso_loss", "mesh loss of ISO/TR 14179-2", Quantity(numbers.iso_loss, "W")),
                Fact(
                    "anderson_loewenthal",
                    "sliding loss of Anderson and Loewenthal",
                    Quantity(numbers.anderson_loewenthal, "W"),
                ),
            ),
        ),
    ]
    return blocks


def _film(results: Results) -> list[Block]:
    pair, g, profile = results.pair, results.geometry, results.profile
    names = str(profile["regime"].attrs["flag_meanings"]).split(", ")
    xi, regime = profile["xi"].to_numpy(), profile["regime"].to_numpy()
    # Share of the length of the path: each position stands for half the way to its neighbours.
    weight = np.gradient(xi)
    shares = [float(weight[regime == index].sum() / weight.sum()) for index in range(len(names))]
    return [
        Picture(
            "film",
            "Central film thickness and film parameter over the path of contact; shaded: the regimes of the "
            "pair's thresholds.",
            lambda: film_figure(g, profile, tuple(pair.friction.thresholds)),
        ),
        Facts("lubricant", _lubricant(pair)),
        Table(
            "film_regimes",
            "Lubrication regimes along the path of contact.",
            {"regime": "regime", "share": "share of the path"},
            tuple(zip(names, shares, strict=True)),
        ),
    ]


def _lubricant(pair: GearPair) -> tuple[Fact, ...]:
    path, law = contact_path(pair), pair.lubricant.viscosity_law
    note = "given" if law is None else f"at {law.temperature - ZERO_CELSIUS:.4g} °C, by its viscosity law"
    return (
        Fact("viscosity", "dynamic viscosity", Quantity(pair.lubricant.dynamic_viscosity, "Pa s"), note),
        Fact("mean_roughness", "mean roughness Ra", Quantity(path.roughness, "m")),
        Fact("composite_roughness", "composite roughness", Quantity(path.composite_roughness, "m")),
    )
