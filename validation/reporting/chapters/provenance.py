"""Versions and hashes: what made this report."""

from __future__ import annotations

import platform
from importlib import metadata

from lumped.results import parameters_hash
from validation.reporting.blocks import Chapter, Column, Fact, Facts, Table, Text
from validation.reporting.results import Results

_PACKAGES = ("spurcheck", "numpy", "scipy", "numba", "exudyn", "control", "xarray", "matplotlib")


def provenance(results: Results) -> Chapter:
    """Write the chapter."""
    effort = results.effort
    facts = Facts(
        "made_from",
        (
            Fact("parameters_sha256", "SHA-256 of the parameters", parameters_hash(results.pair)),
            Fact("samples", "samples per mesh cycle", effort.samples),
            Fact("cycles", "mesh cycles of the cross-check", effort.cycles),
            Fact("sweep_speeds", "speeds of the response", effort.sweep_speeds),
            Fact("chart_nodes", "nodes of the stability chart", effort.chart_speeds * effort.chart_dampings),
            Fact("chart_rtol", "tolerance of the chart", effort.chart_rtol),
        ),
    )
    versions = Table(
        "versions",
        "Software.",
        (Column("name", "name"), Column("version", "version")),
        (
            ("python", platform.python_version()),
            *((name, metadata.version(name)) for name in _PACKAGES),
        ),
    )
    text = Text(
        "The same parameters and software give the same report.json, byte for byte, apart from its "
        "timestamps block. The folder beside this page holds every figure (figures/, PNG and SVG), the data "
        "behind them (data/, NetCDF) and the parameter file that reproduces the report "
        "(data/parameters.toml)."
    )
    return Chapter("provenance", "Versions and hashes", (text, facts, versions))
