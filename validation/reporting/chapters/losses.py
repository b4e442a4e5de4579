"""Losses of the mesh by friction law and along the path of contact, and the film between the teeth."""

from __future__ import annotations

import warnings
from functools import partial

import numpy as np
import xarray as xr

from lumped import GearPair, LawRangeWarning, NumericalError, ParameterError
from lumped.losses import (
    anderson_loewenthal_sliding_loss,
    dynamic_losses,
    iso_14179_mesh_loss,
    iso_14179_of,
    loss_factor,
    losses_of_laws,
    ohlendorf_of,
    quasi_static_losses,
    sliding_power_along_path,
)
from lumped.lubrication.viscosity import ZERO_CELSIUS
from lumped.path_of_contact import contact_path
from validation.plots.mesh import efficiency_figure, sliding_power_figure
from validation.reporting.blocks import (
    Badge,
    Block,
    Content,
    FactRow,
    Picture,
    Quantity,
    Table,
    Text,
    facts,
    table_of,
)
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.words import cautions, objections


def write(results: Results) -> Content:
    """Write the chapter."""
    results.stage("losses")
    with warnings.catch_warnings():
        # The chapter compares laws outside their ranges too, and says which.
        warnings.simplefilter("ignore", LawRangeWarning)
        by_law = losses_by_law(results.pair, results.motion, results.profile, quick=not results.effort.full)
        blocks = (*cautions(results), *_losses(results, by_law), *_film(results))
    badge = Badge("violated", "not reliable") if objections(results) else None
    return Content(blocks, badge, {"losses_by_law": by_law})


def _losses(results: Results, by_law: xr.Dataset) -> list[Block]:
    pair, g, motion = results.pair, results.geometry, results.motion
    still = quasi_static_losses(pair)
    blocks: list[Block] = []
    if by_law.sizes["law"]:
        chosen = pair.friction.law
        blocks += [
            Picture(
                "efficiency_by_law",
                "Loss of the mesh by friction law: mean |µ| times Ohlendorf's closed loss factor, the "
                "quasi-static integral, and the periodic motion.",
                lambda: efficiency_figure(by_law, chosen),
            ),
            _table_by_law(by_law, chosen),
        ]
    if by_law.attrs["left_out"]:
        blocks.append(Text("Laws that this pair does not allow:", tuple(by_law.attrs["left_out"])))
    blocks += [
        Picture(
            "sliding_power",
            "Left: sliding power of one tooth pair along the path of contact. Right: instantaneous mesh "
            "efficiency over the mesh cycle. Law of this report, without and with vibration.",
            partial(
                sliding_power_figure,
                g,
                sliding_power_along_path(still),
                sliding_power_along_path(motion),
                (still, dynamic_losses(pair, motion)),
            ),
        ),
        facts("losses", *_numbers(pair)),
    ]
    return blocks


def _table_by_law(by_law: xr.Dataset, chosen: str) -> Table:
    return table_of(
        "efficiency_by_law",
        "Mesh efficiency by friction law, sliding losses only.",
        [by_law.sel(law=name) for name in by_law["law"].to_numpy()],
        {
            "law": ("law", lambda one: str(one["law_title"].item())),
            "path_coefficient": ("mean |µ| over the path", lambda one: float(one["path_coefficient"])),
            "mean_coefficient": ("µ weighted by the loss", lambda one: float(one["mean_coefficient"])),
            "power_loss": ("sliding loss, quasi-static", lambda one: Quantity(float(one["power_loss"]), "W")),
            "closed_form": ("efficiency, closed form", lambda one: float(one["mesh_efficiency_closed_form"])),
            "quasi_static": ("efficiency, quasi-static", lambda one: float(one["mesh_efficiency"])),
            "dynamic": ("efficiency, periodic motion", lambda one: _known(one["mesh_efficiency_dynamic"])),
        },
        marked=lambda one: str(one["law"].item()) == chosen,
    )


def _known(value: xr.DataArray) -> float | None:
    return float(value) if np.isfinite(value) else None


def _numbers(pair: GearPair) -> tuple[FactRow, ...]:
    try:
        loaded = loss_factor(pair, "loaded")
    except (ParameterError, NumericalError):  # the chapter on mesh physics says why
        loaded = None
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    anderson = anderson_loewenthal_sliding_loss(pair)
    return (
        ("input_power", "input power", power, "W"),
        ("ohlendorf", "loss factor, Ohlendorf's closed form", ohlendorf_of(pair)),
        ("uniform", "loss factor, integrated, equal load sharing", loss_factor(pair, "uniform")),
        ("stiffness", "loss factor, load shared by stiffness", loss_factor(pair, "stiffness")),
        ("loaded", "loss factor, with the flanks' relief under load", loaded),
        ("iso_coefficient", "mean µ of ISO/TR 14179-2", iso_14179_of(pair)),
        ("iso_loss", "mesh loss of ISO/TR 14179-2", iso_14179_mesh_loss(pair), "W"),
        ("anderson_loewenthal", "sliding loss of Anderson and Loewenthal", anderson, "W"),
    )


def _film(results: Results) -> list[Block]:
    profile = results.profile
    names = str(profile["regime"].attrs["flag_meanings"]).split(", ")
    xi, regime = profile["xi"].to_numpy(), profile["regime"].to_numpy()
    # Share of the length of the path: each position stands for half the way to its neighbours.
    weight = np.gradient(xi)
    shares = [float(weight[regime == index].sum() / weight.sum()) for index in range(len(names))]
    return [
        facts("lubricant", *_lubricant(results.pair)),
        Table(
            "film_regimes",
            "Lubrication regimes along the path of contact.",
            {"regime": "regime", "share": "share of the path"},
            tuple(zip(names, shares, strict=True)),
        ),
    ]


def _lubricant(pair: GearPair) -> tuple[FactRow, ...]:
    path, law = contact_path(pair), pair.lubricant.viscosity_law
    note = "given" if law is None else f"at {law.temperature - ZERO_CELSIUS:.4g} °C, by its viscosity law"
    return (
        ("viscosity", "dynamic viscosity", pair.lubricant.dynamic_viscosity, "Pa s", note),
        ("mean_roughness", "mean roughness Ra", path.roughness, "m"),
        ("composite_roughness", "composite roughness", path.composite_roughness, "m"),
    )


def losses_by_law(pair: GearPair, motion: xr.Dataset, profile: xr.Dataset, *, quick: bool) -> xr.Dataset:
    """Efficiency of the mesh by friction law: closed form, quasi-static, and of the periodic motion.

    Parameters
    ----------
    pair : a validated gear pair
    motion : its periodic motion, of ``lumped.steady_state``
    profile : its friction laws along the path, of ``lumped.path_of_contact.friction_profile``
    quick : the periodic motion of the pair's own law alone
    """
    table = losses_of_laws(pair, dynamic=not quick)
    own = pair.friction.law
    if quick:
        dynamic = [
            float(motion.attrs["mesh_efficiency"]) if law == own else np.nan for law in table["law"].values
        ]
        attrs = {"units": "1", "long_name": "mesh efficiency of the periodic motion"}
        table["mesh_efficiency_dynamic"] = ("law", np.array(dynamic), attrs)
    mean = profile["mean_mu"].sel(law=table["law"])
    table["path_coefficient"] = ("law", mean.to_numpy(), mean.attrs)
    table["mesh_efficiency_closed_form"] = (
        "law",
        1.0 - mean.to_numpy() * ohlendorf_of(pair),
        {"units": "1", "long_name": "1 - mean |mu| times Ohlendorf's loss factor"},
    )
    return table


CHAPTER = Chapter("losses", "Losses and film", write, front=("efficiency_by_law", "losses"), seconds=2)
