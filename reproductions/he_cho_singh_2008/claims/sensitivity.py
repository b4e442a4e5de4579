"""How much the claims depend on what the paper does not give: a Latin hypercube over the assumptions."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np

from lumped import GearPair, LawRangeWarning, NumericalError, ParameterError, bodies
from lumped.arguments import whole_number
from lumped.typing import FloatArray, Progress
from reproductions.he_cho_singh_2008.claims.numbers import measure

#: Of the hypercube.
SEED = 2008


@dataclass(frozen=True)
class Assumption:
    """One assumed parameter and its range.

    Attributes
    ----------
    name, unit : for the table
    low, high : ends of the range
    logarithmic : whether equal ratios are equally likely, not equal differences
    meaning : of the range in words, where the number only chooses
    """

    name: str
    unit: str
    low: float
    high: float
    logarithmic: bool = True
    meaning: str = ""

    def value(self, quantile: float) -> float:
        """Value at a quantile, 0 to 1."""
        if self.logarithmic:
            return float(self.low * (self.high / self.low) ** quantile)
        return self.low + (self.high - self.low) * quantile

    def __str__(self) -> str:
        if self.meaning:
            return self.meaning
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.low:g} to {self.high:g}{unit}" + (", logarithmic" if self.logarithmic else "")


#: Ranges wide enough for a gear rig of this size and any common oil; the preset's values lie inside.
ASSUMPTIONS = (
    Assumption("inertia, factor on both gears", "", 0.5, 2.0),
    Assumption("mass, factor on both gears", "", 0.5, 3.0),
    Assumption("bearing stiffness, LOA", "N/m", 3e7, 3e8),
    Assumption("bearing stiffness, OLOA over LOA", "", 0.5, 2.0),
    Assumption("bearing damping ratio", "", 0.01, 0.1),
    Assumption("mesh damping ratio", "", 0.02, 0.1),
    Assumption("average roughness of each flank", "µm", 0.05, 0.6),
    Assumption("viscosity at the contact inlet", "mPa s", 4.0, 50.0),
    Assumption("upper bound of law II", "", 0.1, 0.3, logarithmic=False),
    Assumption("sharpness of law IV", "1/mm", 20.0, 200.0),
    Assumption(
        "tooth-pair stiffness",
        "",
        0.0,
        1.0,
        False,
        "rectangular, or parabolic with ramps of 0.5 mm: half each",
    ),
)


def vary(pair: GearPair, values: FloatArray) -> GearPair:
    """Return the pair with other assumptions. ``values``: in the order and units of ``ASSUMPTIONS``."""
    inertia, mass, k_loa, ratio, zeta_b, zeta_m, roughness, viscosity, bound, sharpness, form = map(
        float, values
    )
    nominal = bodies(pair)
    changes: dict[str, object] = {
        "pinion.inertia": inertia * nominal.inertia_pinion,
        "gear.inertia": inertia * nominal.inertia_gear,
        "pinion.mass": mass * nominal.mass_pinion,
        "gear.mass": mass * nominal.mass_gear,
        "mesh.damping_ratio": zeta_m,
        "pinion.roughness": roughness,
        "gear.roughness": roughness,
        "friction.composite_roughness": None,
        "friction.maximum": bound,
        "friction.sharpness": sharpness,
        "lubricant": {
            "viscosity": viscosity,
            "pressure_viscosity_k": pair.lubricant.pressure_viscosity_k,
            "pressure_viscosity_s": pair.lubricant.pressure_viscosity_s,
        },
    }
    for side in ("pinion", "gear"):
        changes |= {
            f"bearings.{side}.loa_stiffness": k_loa,
            f"bearings.{side}.oloa_stiffness": ratio * k_loa,
            f"bearings.{side}.loa_damping_ratio": zeta_b,
            f"bearings.{side}.oloa_damping_ratio": zeta_b,
        }
    if form > 0.5:
        changes["mesh.stiffness"] = {"model": "parabolic", "ramp_length": 0.5}
    else:
        changes["mesh.stiffness"] = {"model": "rectangular"}
    return pair.with_(changes)


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """Claim numbers over samples of the assumptions.

    Attributes
    ----------
    numbers : of each sample that gave some, name as in ``measure`` -> value
    samples : the assumptions of these (samples, len(ASSUMPTIONS))
    failed : samples without periodic motion or refused by the schema
    """

    numbers: list[dict[str, float]]
    samples: FloatArray
    failed: int


def sample_assumptions(
    pair: GearPair, samples: int = 100, *, seed: int = SEED, progress: Progress | None = None
) -> Sensitivity:
    """Work out the claim numbers over a Latin hypercube of the assumptions.

    Parameters
    ----------
    pair : the gear pair; its teeth, geometry and materials are kept
    samples : of the hypercube, 8 to 100000
    seed : of the hypercube
    progress : called with the finished fraction

    Raises
    ------
    ParameterError : samples out of range
    NumericalError : fewer than half of the samples have a periodic motion
    """
    samples = whole_number("samples", samples, 8, 100_000, "Use 100 for shares to 5 %.")
    seed = whole_number("seed", seed, 0, 2**63 - 1)
    from scipy.stats import qmc  # half a second that only this needs

    quantiles = qmc.LatinHypercube(len(ASSUMPTIONS), rng=np.random.default_rng(seed)).random(samples)
    rows: list[dict[str, float]] = []
    kept: list[FloatArray] = []
    failed = 0
    for done, row in enumerate(quantiles, 1):
        values = np.array([a.value(float(q)) for a, q in zip(ASSUMPTIONS, row, strict=True)])
        with warnings.catch_warnings():
            # The ranges go beyond those of the laws on purpose; one warning per sample would say less.
            warnings.simplefilter("ignore", LawRangeWarning)
            try:
                rows.append(measure(vary(pair, values)))
                kept.append(values)
            except (NumericalError, ParameterError):
                failed += 1
        if progress is not None:
            progress(done / samples)
    if len(rows) < samples / 2:
        raise NumericalError(
            f"{failed} of {samples} samples of the assumptions have no periodic motion: check the pair's "
            "speed and stiffness."
        )
    return Sensitivity(rows, np.array(kept), failed)
