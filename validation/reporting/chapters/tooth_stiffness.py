"""Tooth stiffness: every way to k beside plane elasticity of the same gears."""

from __future__ import annotations

from functools import partial

from validation.plots.mesh import tooth_stiffness_figure
from validation.reporting.blocks import Badge, Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.verification.tooth_stiffness import ToothStiffness


def write(results: Results) -> Content:
    """Write the chapter."""
    found = results.tooth_stiffness
    if isinstance(found, str):
        text = f"The stiffness of the teeth cannot be compared with plane elasticity for this pair: {found}"
        return Content((Text(text),), Badge("undecided"))
    passed = sum(check.passes for check in found.checks)
    blocks: list[Block] = [
        Text(
            "Both models take the stiffness of the teeth from one place, so their agreement says nothing "
            "about it. Plane finite elements of both whole gears share the outline of the teeth with the "
            f"other ways and no formula. {passed} of {len(found.checks)} checks pass. {_own(found)}"
        ),
        table_of(
            "checks",
            "Formulas for the tooth stiffness against plane elasticity.",
            found.checks,
            {
                "key": ("check", lambda c: c.key),
                "subject": ("what is checked", lambda c: c.subject),
                "exact": ("what it must equal", lambda c: c.exact),
                "value": ("error", lambda c: c.value),
                "limit": ("limit", lambda c: c.limit),
                "verdict": ("verdict", lambda c: Badge("within" if c.passes else "outside")),
            },
            note="Why these limits: " + "; ".join(f"{c.key}: {c.reason}" for c in found.checks) + ".",
        ),
        Picture(
            "tooth_stiffness",
            "Stiffness of a tooth pair alone over the path of contact, by plane elasticity and by formulas.",
            partial(tooth_stiffness_figure, results.geometry, found.curves),
        ),
        table_of(
            "ways",
            "Stiffness of the teeth by every way.",
            found.ways,
            {
                "name": ("way", lambda w: w.name),
                "counted": ("deflections count from", lambda w: w.counted),
                "largest": ("largest of a pair", lambda w: Quantity(w.largest, "N/m")),
                "mean": ("mean of the mesh", lambda w: Quantity(w.mean, "N/m")),
                "single_ratio": ("largest over c' b", lambda w: w.single_ratio),
                "mean_ratio": ("mean over c_γ b", lambda w: w.mean_ratio),
                "elastic_ratio": ("mean over elastic, ring", lambda w: w.elastic_ratio),
            },
            marked=lambda w: w.counted == "",
            note=f"Error of the finite elements, from two meshes: {100.0 * found.error:.2g} %. Bodies are in "
            "plane stress; in plane strain k is 3 to 6 % larger.",
        ),
    ]
    if found.warnings:
        blocks.append(Text("Rims for which the support decides, not k of a free gear:", found.warnings))
    badge = "not confirmed" if not found.passes else "warning" if found.off else "confirmed"
    return Content(tuple(blocks), Badge(badge), {"tooth_stiffness": found.curves})


def _own(found: ToothStiffness) -> str:
    if found.allowed is None:
        return f"That of this report is {found.own:.2f} times the elastic one on the energy method's ring."
    own = found.ways[-1].mean
    low, high = (value / own for value in found.allowed)
    text = f"Plane elasticity of free gears allows {low:.2f} to {high:.2f} times the stiffness of this report"
    if not found.off:
        return f"{text}, over states of stress and, of a thin rim, what holds it."
    side = "above" if found.off > 0.0 else "below"
    iso, ring = (f"{way.mean / own:.2f}" for way in (found.ways[4], found.ways[0]))
    return (
        f"{text}: it is {100.0 * abs(found.off):.0f} % {side} all of it. This is a doubt, not a failure: "
        "measured teeth, crowned or misaligned leads, webs, or a computation that holds the bore may explain "
        f"it. ISO 6336-1 gives {iso} times, gears held at the bore of the energy method's ring {ring}."
    )


CHAPTER = Chapter("tooth_stiffness", "Tooth stiffness", write, seconds=1)
