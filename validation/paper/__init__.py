"""Reproduction of the paper: figures 2 to 7, claims with verdicts, errata by computation."""

from validation.paper.claims.judge import claims
from validation.paper.errata.catalogue import errata_chapter
from validation.paper.figures.law_figures import law_runs
from validation.paper.plots import draw_errata
from validation.paper.records import PAPER, Claim, ClaimsTable, ErrataChapter, Erratum, Evidence, FigureRecord
from validation.paper.reproduction import DRAW, figure_records

__all__ = [
    "DRAW",
    "PAPER",
    "Claim",
    "ClaimsTable",
    "ErrataChapter",
    "Erratum",
    "Evidence",
    "FigureRecord",
    "claims",
    "draw_errata",
    "errata_chapter",
    "figure_records",
    "law_runs",
]
