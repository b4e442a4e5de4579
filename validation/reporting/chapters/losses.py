"""Losses of the mesh, the laws of friction side by side, and the lubricant film."""

from __future__ import annotations

import warnings

import numpy as np

from lumped import LawRangeWarning
from lumped.friction.registry import law_of
from lumped.labelling import labelled_dataset
from lumped.losses import iso_14179_mesh_loss, losses_of_laws
from lumped.path_of_contact import contact_path, friction_profile
from validation.files.formatting import number, quantity
from validation.plots.axes import losses_figure
from validation.prediction.motion import PLACES
from validation.reporting.blocks import Block, Content, Picture, Text, quantities
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.pair
    prediction = results.prediction
    power = prediction.input_power
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # laws are compared outside their ranges too
        laws = losses_of_laws(pair)
        profile = friction_profile(pair)
        path = contact_path(pair)
    loss = 100.0 * (1.0 - laws["mesh_efficiency"].to_numpy())
    names = [str(name) for name in laws["law"].to_numpy()]
    data = labelled_dataset(
        {"loss": ("law", loss, "%", "sliding loss over input power")},
        {"law": (names, "1", "friction law")},
        {
            "titles": [str(profile["law_title"].sel(law=name).item()) for name in names],
            "own": names.index(pair.friction.law) if pair.friction.law in names else -1,
        },
    )
    places = np.linspace(path.L_XA, path.L_XD, 201)
    film = path.film_thickness(places)
    other = path.film_thickness(places, "hamrock_dowson")
    parameter = profile["film_parameter"].to_numpy()
    parts = [(PLACES[place], lost, "W", "") for place, lost in prediction.losses.items()]
    table = quantities(
        "losses",
        "Losses at the operating point.",
        ("input power", power, "W"),
        ("loss, all places", prediction.loss, "W", "of the motion of page 1; the sum of the next rows"),
        *parts,
        ("mesh loss of ISO/TR 14179-2", iso_14179_mesh_loss(pair), "W", "for comparison"),
        ("smallest film thickness", float(film.min()), "m", str(profile["film_thickness"].attrs["note"])),
        ("the same by another formula", float(other.min()), "m", "central, Hamrock and Dowson (1977)"),
        ("smallest film parameter", float(parameter.min()), "1", "below 1 boundary, above 4 full film"),
    )
    blocks: list[Block] = [
        table,
        Picture(
            "losses_by_law",
            "Sliding loss of every friction law, quasi-static. Dark: the law of this pair.",
            data,
            losses_figure,
        ),
    ]
    title = law_of(pair.friction).title
    outside = [text for text in map(str, profile.attrs["range_warnings"]) if text.startswith(f"{title}:")]
    if outside:
        blocks.append(Text("The friction law is used outside its range:", tuple(outside)))
    result = (
        f"The pair loses {quantity(prediction.loss, 'W', 2)} of "
        f"{quantity(power, 'W', 3)}; sliding alone takes {number(loss.min(), 2)} to "
        f"{number(loss.max(), 2)} % by the different friction laws."
    )
    return Content(result, tuple(blocks))


CHAPTER = Chapter("losses", "Losses and film", write, seconds=0.3)
