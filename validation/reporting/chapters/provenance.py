"""Versions and hashes: what made this report."""

from __future__ import annotations

import platform
from importlib import metadata

from lumped.labelling import parameters_hash
from validation.reporting.blocks import Content, Table, Text, facts
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.verification.evidence import source_hash

_PACKAGES = ("spurcheck", "numpy", "scipy", "numba", "exudyn", "control", "xarray", "matplotlib")


def write(results: Results) -> Content:
    """Write the chapter."""
    effort = results.effort
    made = facts(
        "made_from",
        ("parameters_sha256", "SHA-256 of the parameters", parameters_hash(results.pair)),
        ("source_sha256", "SHA-256 of the program's source", source_hash()),
        ("samples", "samples per mesh cycle", results.effort.samples),
        ("cycles", "mesh cycles of the cross-check", effort.cycles),
        ("sweep_speeds", "speeds of the response", effort.sweep_speeds),
        ("chart_nodes", "nodes of the stability chart", effort.chart_speeds * effort.chart_dampings),
        ("chart_rtol", "tolerance of the chart", effort.chart_rtol),
    )
    versions = Table(
        "versions",
        "Software.",
        {"name": "name", "version": "version"},
        (
            ("python", platform.python_version()),
            ("platform", f"{platform.system()} {platform.machine()}"),
            *((name, metadata.version(name)) for name in _PACKAGES),
        ),
    )
    text = Text(
        "The same parameters and software give the same report.json, byte for byte, apart from its "
        "timestamps block, on processors of one type with as many threads of BLAS (the command takes one); "
        "others may differ in the last digits. The folder beside this page holds every figure (figures/, "
        "SVG), the data behind them (data/, NetCDF) and the parameter file that reproduces the report "
        "(data/parameters.toml)."
    )
    return Content((text, made, versions))


CHAPTER = Chapter("provenance", "Versions and hashes", write)
