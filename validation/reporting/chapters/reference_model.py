"""The multibody model checked: what it shares with the lumped model, and what else speaks for it."""

from __future__ import annotations

import math

from validation.reporting.blocks import Badge, Block, Content, Facts, Quantity, Text, facts, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.checks import check_table
from validation.reporting.results import Results
from validation.verification.reference_model import ReferenceModel


def write(results: Results) -> Content:
    """Write the chapter."""
    found = results.reference
    passed = sum(check.passes for check in found.checks)
    blocks: list[Block] = [
        Text(
            "The multibody model judges the lumped model in the next chapter. Here the multibody model is "
            "checked itself, by evidence that does not come from comparing the two: "
            f"{passed} of {len(found.checks)} checks pass."
        ),
        check_table("checks", "The multibody model against other evidence.", found.checks),
        *(Text("Not computed for this pair:", found.refused) for _ in found.refused[:1]),
        _shared(found),
        _published(found),
        *_decays(found),
        *_bodies(found),
        *_build(found),
        *_modes(found),
    ]
    return Content(tuple(blocks), Badge("confirmed" if found.passes else "not confirmed"))


def _shared(found: ReferenceModel) -> Block:
    return table_of(
        "shared",
        "What both models take from the same place. Their agreement says nothing about it, other evidence "
        "does.",
        found.shared,
        {
            "what": ("shared", lambda s: s.what),
            "why": ("why", lambda s: s.why),
            "evidence": ("evidence from elsewhere", lambda s: s.evidence),
            "where": ("where", lambda s: ", ".join(s.where)),
        },
    )


def _published(found: ReferenceModel) -> Block:
    return table_of(
        "published",
        "Published formulas at published numbers, or at numbers worked out by hand, on this installation.",
        found.published,
        {
            "formula": ("formula", lambda v: v.formula),
            "published": ("stated", lambda v: v.published),
            "lumped": ("lumped", lambda v: v.lumped),
            "multibody": ("multibody", lambda v: v.multibody),
            "verdict": ("verdict", lambda v: Badge("within" if v.passes else "outside")),
        },
        note="Arguments are in the units of the publication. Within: both models meet the digits stated. "
        "An empty cell: the multibody model does not use this formula by itself.",
    )


def _decays(found: ReferenceModel) -> tuple[Block, ...]:
    if found.decays is None:
        return ()
    table = table_of(
        "decays",
        "Free vibration of the multibody model without friction and torque.",
        found.decays,
        {
            "motion": ("motion", lambda d: d.motion),
            "frequency": ("natural frequency", lambda d: Quantity(d.frequency, "Hz")),
            "decrement": ("logarithmic decrement", lambda d: _finite(d.decrement)),
            "wanted": ("that of the damping ratio given", lambda d: _finite(_decrement(d.given))),
            "measured": ("damping ratio of the decay", lambda d: d.measured),
            "given": ("damping ratio given", lambda d: d.given),
        },
        note="Mesh: a tooth pair is frozen in the middle of the path of contact and the gear centres are "
        "held. Where several pairs touch, the ratio given is that of their sum. From critical damping on "
        "there is no decrement.",
    )
    return (table,)


def _decrement(ratio: float) -> float:
    return 2.0 * math.pi * ratio / math.sqrt(1.0 - ratio**2) if ratio < 1.0 else math.inf


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _bodies(found: ReferenceModel) -> tuple[Block, ...]:
    if found.blanks is None:
        return ()
    table = table_of(
        "bodies",
        "Mass and polar inertia of the gears by integrating their outlines, and as both models take them: "
        "given in the parameter file, or of a disc of the reference diameter.",
        list(zip(("pinion", "gear"), found.blanks, strict=True)),
        {
            "gear": ("gear", lambda one: one[0]),
            "outline_mass": ("mass, outline", lambda one: Quantity(one[1].mass, "kg")),
            "mass": ("mass taken", lambda one: Quantity(one[1].taken_mass, "kg")),
            "mass_difference": ("difference", lambda one: Quantity(100 * one[1].mass_difference, "%")),
            "outline_inertia": ("inertia, outline", lambda one: Quantity(one[1].inertia, "kg m²")),
            "inertia": ("inertia taken", lambda one: Quantity(one[1].taken_inertia, "kg m²")),
            "inertia_difference": ("difference", lambda one: Quantity(100 * one[1].inertia_difference, "%")),
        },
        note="The difference is what the choice of a disc costs. Where it matters, state mass and inertia in "
        "the parameter file.",
    )
    return (table,)


def _build(found: ReferenceModel) -> tuple[Facts, ...]:
    if found.build is None:
        return ()
    turning, usual = found.build.evaluations
    return (
        facts(
            "third_build",
            (
                "cycles",
                "mesh cycles of the third build",
                found.build.cycles,
                "",
                "its bodies turn through their own angle in exudyn's nodes; the usual build integrates "
                "deviations from the nominal rotation",
            ),
            ("turned", "angle of the pinion at the end", math.degrees(found.build.turned), "°"),
            (
                "cost",
                "cost of the third build",
                f"{turning:.0f} force evaluations a mesh cycle",
                "",
                f"the usual build: {usual:.0f}, because it is sharper and stops wherever a tooth force jumps",
            ),
        ),
    )


_SOURCES = {
    "exudyn linear": "exudyn, linear",
    "lumped frozen": "lumped A(t)",
    "exudyn exact": "exudyn, exact",
    "lumped turned line": "lumped, turned line",
    "lumped averaged": "lumped, mean of A(t)",
}


def _modes(found: ReferenceModel) -> tuple[Block, ...]:
    modes = found.modes
    if modes is None:
        return ()
    load = float(modes.attrs["normal_load"])
    return (
        table_of(
            "frozen_modes",
            "Natural frequencies [Hz] and damping ratios of the machine with its mesh frozen at 0.3 of the "
            "mesh cycle.",
            modes["mode"].to_numpy().tolist(),
            {
                "mode": ("mode", lambda mode: mode),
                **{
                    f"{short}_{source.replace(' ', '_')}": (
                        f"{word}{words}",
                        lambda mode, name=name, source=source: float(  # type: ignore[misc]
                            modes[name].sel(mode=mode, source=source)
                        ),
                    )
                    for short, name, word in (
                        ("frequency", "natural_frequency", ""),
                        ("damping", "damping_ratio", "damping ratio, "),
                    )
                    for source, words in _SOURCES.items()
                },
            },
            note="The program exudyn linearises its own assembled machine. In the exact model the line of "
            f"action turns with the gear centres, so the normal load of {load:.4g} N acts as a spring "
            "−N/L_XY off the line of action; lumped, turned line: the lumped A(t) with it. The mean of A(t) "
            "by python-control is another machine, with the mean stiffness of the mesh cycle: the natural "
            "frequencies of this report.",
        ),
    )


CHAPTER = Chapter("reference_model", "The multibody model checked", write, seconds=0.5)
