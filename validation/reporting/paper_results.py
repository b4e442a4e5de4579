"""What the report's paper chapters are written from."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

from lumped import GearPair, LawRangeWarning
from lumped.typing import Progress
from validation.paper.records import ClaimsTable, ErrataChapter, FigureRecord


@dataclass(frozen=True, eq=False)
class PaperResults:
    """The paper with this gear pair: figures 2 to 7, claims with verdicts, errata by computation."""

    figures: tuple[FigureRecord, ...]
    claims: ClaimsTable
    errata: ErrataChapter


def paper_results(pair: GearPair, samples: int, progress: Progress) -> PaperResults:
    """Compute everything that the paper chapters show.

    Parameters
    ----------
    pair : the gear pair; speeds, torques and laws are the paper's, those of the errata's effects the pair's
    samples : of the Latin hypercube over what the paper does not give
    progress : called with the finished fraction

    Raises
    ------
    NumericalError : a model fails at an operating point of the paper
    """
    from validation.paper import claims, errata_chapter, figure_records, law_runs  # most reports do without

    with warnings.catch_warnings():
        # Laws are taken to the paper's operating points whether they suit them or not: that is what it did.
        warnings.simplefilter("ignore", LawRangeWarning)
        runs = law_runs(pair)
        figures = figure_records(pair, runs=runs, progress=lambda f, _="": progress(0.4 * f))
        shown = errata_chapter(pair)
        progress(0.5)
        table = claims(pair, samples=samples, runs=runs, progress=lambda f, _="": progress(0.5 + 0.5 * f))
    return PaperResults(figures, table, shown)
