"""How far prescribed and loaded contact are off the exact contact for the same pair."""

from __future__ import annotations

from functools import partial

from validation.plots.models import contact_forms_figure
from validation.reporting.blocks import Block, Content, Picture, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results
from validation.reporting.words import contact_form
from validation.validity.contact_forms import FORMS, PLACES


def write(results: Results) -> Content:
    """Write the chapter."""
    found = results.forms
    if isinstance(found, str):
        return Content((Text(f"The exact contact has no motion to compare with: {found}"),))
    spans, motions, off = found.spans(results.geometry.mesh_period), dict(found.motions), found.difference
    names = FORMS | {"exact": "exact contact", "pushing": "loaded contact, unilateral"}
    if (pushing := results.lifting) is not None:
        motions["pushing"], off["pushing"] = pushing, found.off(pushing)
        spans["pushing"] = pushing.attrs["dte_peak_to_peak"]
    statics = "contact is prescribed from A to D, with a stiffness independent of the load"
    blocks: list[Block] = [
        Text(
            f"{contact_form(results)} With prescribed contact {statics}; the exact contact follows from gaps "
            "of flanks and tip corners and from an elastic energy. Loaded contact is linear about the "
            "motion under the static load, in contact where that load closes the gap, beyond A and D too."
        ),
        Picture(
            "contact_forms",
            "Transmission error over one mesh cycle: both forms of the lumped model, and the exact contact "
            "with all effects.",
            partial(contact_forms_figure, results.pair, found),
        ),
        table_of(
            "contact_forms",
            "The same gear pair in both forms and with the exact contact.",
            list(motions),
            {
                "form": ("model", names.get),
                "difference": ("largest difference from exact / peak to peak", off.get),
                "dte": (
                    "transmission error, peak to peak",
                    lambda form: Quantity(spans[form], "m"),
                ),
                "largest_load": (
                    "largest load of a pair",
                    lambda form: Quantity(float(motions[form]["normal_load"].max()), "N"),
                ),
                "brake_torque": (
                    "brake torque",
                    lambda form: Quantity(float(motions[form].attrs["brake_torque"]), "N m"),
                ),
            },
            marked=lambda form: form == found.own,
        ),
        table_of(
            "losses_by_place",
            "Mean power lost by place.",
            list(found.powers),
            {
                "form": ("model", FORMS.__getitem__),
                **{
                    place: (
                        words,
                        lambda form, place=place: (
                            None  # type: ignore[misc]
                            if place == "energy_residual" and form == "loaded"
                            else Quantity(float(getattr(found.powers[form], place)), "W")
                        ),
                    )
                    for place, words in PLACES.items()
                },
                "lost": (
                    "all, of the input",
                    lambda form: 1.0 - found.powers[form].efficiency,
                ),
            },
            marked=lambda form: form == found.own,
            note="With prescribed contact the brake torque balances moments, so the sliding loss alone. The "
            "losses of bearings and tooth dampers are its energy residual: a force N = k(ξ) δ has no "
            "potential (Oh, Grosh and Barber 2005). Loaded contact satisfies the power balance.",
        ),
    ]
    data = {f"contact_{name}": motion for name, motion in found.motions.items()}
    return Content(tuple(blocks), data=data)


CHAPTER = Chapter("contact_forms", "The form of the contact", write, front=("contact_forms",), seconds=4)
