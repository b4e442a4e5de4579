"""What the pair does where the linear motion would need teeth that pull."""

from __future__ import annotations

from validation.reporting.blocks import Content, Quantity, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.formatting import number, quantity
from validation.reporting.results import Results
from validation.reporting.words import parted


def write(results: Results) -> Content | None:
    """Write the chapter; nothing where all teeth that the linear model holds together push."""
    found = results.parting
    if found is None:
        return None
    if isinstance(found, str):
        return Content((Text(f"Teeth that may part have no periodic motion that was found: {found}"),))
    orbit, linear, exact = found.orbit, results.motion, found.exact
    loads = linear["normal_load"].where(linear["contact"] > 0)
    rows: dict[str, tuple[float, float, float]] = {
        "linear model, teeth may pull": (
            float(linear.attrs["dte_peak_to_peak"]), float(loads.max()), float(loads.min())
        ),
        "same equations, teeth push only": (
            orbit.dte_range[1] - orbit.dte_range[0], orbit.largest_load, 0.0
        ),
        "multibody model": (found.exact_peak_to_peak, float(exact["normal_load"].max()), 0.0),
    }  # fmt: skip
    stable = "a disturbance of it fades" if orbit.stable else "it is unstable: a pair leaves it"
    blocks = (
        Text(
            "The motion of the linear model needs tooth pairs that pull by up to "
            f"{quantity(abs(float(loads.min())), 'N', 3)}. {parted(results)} Between losing and finding "
            "contact the motion is exact, and its multipliers say that "
            f"{stable} (largest {number(orbit.spectral_radius, 3)} per mesh cycle). At which speeds the pair "
            "jumps from one motion to another is told by the command spurcheck response."
        ),
        table_of(
            "contact_loss",
            "The motion at the operating point with and without teeth that pull.",
            list(rows),
            {
                "model": ("model", str),
                "dte": ("transmission error, peak to peak", lambda name: Quantity(rows[name][0], "m")),
                "largest_load": ("largest load of a pair", lambda name: Quantity(rows[name][1], "N")),
                "smallest_load": ("smallest load of a pair", lambda name: Quantity(rows[name][2], "N")),
            },
        ),
    )
    return Content(blocks)


CHAPTER = Chapter("contact_loss", "Where teeth part", write, front=("contact_loss",), seconds=1)
