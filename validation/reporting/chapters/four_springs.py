"""Are four springs enough? The model of the report beside the same pair on its shafts."""

from __future__ import annotations

from functools import partial

import numpy as np

from validation.plots.models import four_springs_figure
from validation.plots.shafts import shafts_figure
from validation.reporting.blocks import Badge, Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.formatting import number
from validation.reporting.results import Results
from validation.validity.four_springs import LIMITS, MODELS, FourSprings

_STATES = ("confirmed", "warning", "violated")
#: Modes listed: those up to this many mesh frequencies.
_MESH_FREQUENCIES = 3.0


def write(results: Results) -> Content | None:
    """Write the chapter; nothing for a pair without shafts."""
    found = results.four_springs
    if found is None:
        return None
    if isinstance(found, str):
        return Content((Text(f"The pair on its shafts cannot be computed: {found}"),), Badge("undecided"))
    blocks: list[Block] = [
        Text(f"{_answer(found)} {_reference(results)}"),
        Picture(
            "four_springs",
            "The pair on four springs, on its shafts, and as a machine, over speed.",
            partial(four_springs_figure, found, results.operating_rpm),
        ),
        table_of(
            "four_springs_models",
            "The operating point with each support.",
            list(MODELS),
            {
                "model": ("supports", MODELS.__getitem__),
                "dte": ("transmission error, peak to peak", lambda m: _here(found, m, "dte", "m")),
                "force_p": (
                    "bearing forces of the pinion, peak to peak",
                    lambda m: _here(found, m, "force_p", "N"),
                ),
                "force_g": ("of the gear", lambda m: _here(found, m, "force_g", "N")),
                "radius": ("largest multiplier", lambda m: _radius(found, m)),
                "off": ("largest difference", lambda m: None if m == "shafts" else found.off_here(m)),
                "holds": ("holds", lambda m: _badge(found, m)),
            },
            note=f"Differences are over the model on shafts; above {LIMITS[0]:.0%} a warning, above "
            f"{LIMITS[1]:.0%} four springs do not hold. Its own contact makes the machine differ.",
        ),
    ]
    blocks += [
        Picture(
            "shafts",
            "Both shafts to scale: bearings (crossed boxes), gears, motor and load.",
            partial(shafts_figure, found.pair),
        ),
        _modes(results, found),
    ]
    return Content(
        tuple(blocks),
        Badge(_state(results, found)),
        {"four_springs": found.over_speed, "shaft_modes": found.modes},
    )


def _answer(found: FourSprings) -> str:
    """Whether springs stand for the shafts, where they do not, and which modes are missing."""
    off, better = found.off_here("springs"), found.off_here("condensed")
    low, high = (f"{rpm:.0f}" for rpm in found.over_speed["speed"].to_numpy()[[0, -1]])
    here = ("are enough", "are a rough picture", "are not enough")[
        int(off > LIMITS[0]) + int(off > LIMITS[1])
    ]
    told = f"Four springs {here} here: off by {_differs(off)}"
    told += f", with springs condensed from the shafts by {_differs(better)}."
    good = [f"{a:.0f} to {b:.0f}" for a, b in found.ranges(hold=True)]
    if not found.ranges(hold=False):
        return f"{told} They hold at all speeds from {low} to {high} rpm."
    where = f"at {', '.join(good)} rpm" if good else "nowhere in the range"
    return f"{told} Within {LIMITS[1]:.0%} they hold {where}; the figure shows which modes are missing."


def _differs(off: float) -> str:
    return f"{number(100 * off, 2)}\u00a0%" if np.isfinite(off) else "the stability of the motion"


def _state(results: Results, found: FourSprings) -> str:
    if not all(check.passes for check in results.on_shafts):
        return "not confirmed"
    off = found.off_here("springs")
    return _STATES[int(off > LIMITS[0]) + int(off > LIMITS[1])]


def _badge(found: FourSprings, model: str) -> Badge | None:
    if model in ("shafts", "machine"):
        return None
    off = found.off_here(model)
    return Badge(_STATES[int(off > LIMITS[0]) + int(off > LIMITS[1])])


def _reference(results: Results) -> str:
    if not results.on_shafts:
        return "The model on shafts is not compared with the machine: it has too many modes."
    found = results.on_shafts[0]
    verb = "has" if found.passes else "does not have"
    return (
        f"With a mesh as linear the machine in exudyn, whose beams are its own, {verb} the motion of the "
        f"model on shafts: off by {number(found.value, 2)} of a span (limit {number(found.limit, 2)})."
    )


def _here(found: FourSprings, model: str, name: str, unit: str) -> Quantity | None:
    value = found.here(model, name)
    return Quantity(value, unit) if np.isfinite(value) else None


def _radius(found: FourSprings, model: str) -> float | None:
    value = found.here(model, "spectral_radius")
    return value if np.isfinite(value) else None


def _modes(results: Results, found: FourSprings) -> Block:
    modes, springs = found.modes, np.array([mode.natural_frequency for mode in results.modes])

    def nearest(j: int) -> Quantity | None:
        frequency = float(modes["natural_frequency"][j])
        return Quantity(float(min(springs, key=lambda f: abs(f - frequency))), "Hz") if springs.size else None

    highest = _MESH_FREQUENCIES / found.pair.geometry.mesh_period
    numbers = [j for j, f in enumerate(modes["natural_frequency"].to_numpy()) if f <= highest]
    return table_of(
        "shaft_modes",
        "Modes of the pair on its shafts, mean mesh stiffness, up to three mesh frequencies.",
        numbers,
        {
            "name": ("mode", lambda j: str(modes["name"].to_numpy()[j])),
            "frequency": (
                "natural frequency",
                lambda j: Quantity(float(modes["natural_frequency"][j]), "Hz"),
            ),
            "springs": ("nearest one on four springs", nearest),
            "damping": ("damping ratio", lambda j: float(modes["damping_ratio"][j])),
            "speed": (
                "met by the mesh frequency at",
                lambda j: Quantity(
                    60.0 * float(modes["natural_frequency"][j]) / found.pair.pinion.teeth, "rpm"
                ),
            ),
        },
    )


CHAPTER = Chapter(
    "four_springs",
    "Are four springs enough?",
    write,
    front=("four_springs", "four_springs_models"),
    seconds=10,
)
