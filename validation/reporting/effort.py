"""How finely a report samples: the full report and the quick report."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effort:
    """How finely the report samples.

    Attributes
    ----------
    samples : samples of the uncertain inputs; 0: the inputs are not varied
    band_samples : samples of each range over speed, of teeth and beside a record
    band_speeds : speeds of the range over speed
    sweep_speeds : speeds of the linear motion over speed
    chart_speeds, chart_dampings : nodes of the stability chart
    orders_speeds : speeds of the map of orders
    jump_seconds : processor time of the search for jumps [s]
    jump_seeds : speeds an octave at which runs settle, to find isolated motions, beats and chaos
    name : name in sentences, "full report" or "quick report"
    sample_seconds : processor time of the samples [s]
    band_seconds : processor time of each range from ``band_samples`` [s]
    explain_seconds : processor time of the search for what a record that contradicts is compatible with [s]
    drawn_machines : machines with teeth drawn of an assumed class, where the file states no tooth errors; 0:
        the teeth are perfect in all results
    drawn_seconds : processor time of these machines [s]
    """

    samples: int
    band_samples: int
    band_speeds: int
    sweep_speeds: int
    chart_speeds: int
    chart_dampings: int
    orders_speeds: int
    jump_seconds: float
    jump_seeds: int
    name: str
    sample_seconds: float = 30.0
    band_seconds: float = 10.0
    explain_seconds: float = 20.0
    drawn_machines: int = 0
    drawn_seconds: float = 15.0


FULL = Effort(128, 32, 41, 160, 1601, 101, 61, 30.0, 8, "full report", drawn_machines=8)
QUICK = Effort(
    0, 0, 0, 96, 401, 41, 25, 5.0, 0, "quick report", explain_seconds=5.0, drawn_machines=4, drawn_seconds=4.0
)
