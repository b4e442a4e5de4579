"""Losses of the mesh, the laws of friction side by side, and the lubricant film."""

from __future__ import annotations

import warnings

import numpy as np
import xarray as xr

from lumped import LawRangeWarning
from lumped.friction.base import ContactPath
from lumped.friction.registry import law_of
from lumped.labelling import labelled_dataset
from lumped.losses import iso_14179_mesh_loss, losses_of_laws
from lumped.path_of_contact import contact_path, friction_profile
from validation.files.formatting import number, quantity
from validation.plots.axes import losses_figure
from validation.prediction.motion import PLACES
from validation.reporting.blocks import Block, Content, NamedNumber, Picture, Table, Text, named_numbers
from validation.reporting.chapter import Chapter
from validation.reporting.results import Results


def write(results: Results) -> Content:
    """Write the chapter."""
    pair = results.pair
    prediction = results.prediction
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LawRangeWarning)  # laws are compared outside their ranges too
        laws = losses_of_laws(pair)
        profile = friction_profile(pair)
        path = contact_path(pair)
    loss = 100.0 * (1.0 - laws["mesh_efficiency"].to_numpy())
    names = [str(name) for name in laws["law"].to_numpy()]
    losses_by_law = labelled_dataset(
        {"loss": ("law", loss, "%", "sliding loss over input power")},
        {"law": (names, "1", "friction law")},
        {
            "titles": [str(profile["law_title"].sel(law=name).item()) for name in names],
            "own": names.index(pair.friction.law) if pair.friction.law in names else -1,
        },
    )
    blocks: list[Block] = [
        _losses_table(results, path, profile),
        Picture(
            "losses_by_law",
            "Sliding loss of every friction law, quasi-static. Dark: the law of this pair.",
            losses_by_law,
            losses_figure,
        ),
    ]
    title = law_of(pair.friction).title
    outside = [text for text in map(str, profile.attrs["range_warnings"]) if text.startswith(f"{title}:")]
    if outside:
        blocks.append(Text("The friction law is used outside its range:", tuple(outside)))
    result = (
        f"The pair loses {quantity(prediction.loss, 'W', 2)} of "
        f"{quantity(prediction.input_power, 'W', 3)}; sliding alone takes {number(loss.min(), 2)} to "
        f"{number(loss.max(), 2)} % by the different friction laws."
    )
    return Content(result, tuple(blocks))


def _losses_table(results: Results, path: ContactPath, profile: xr.Dataset) -> Table:
    """Table of the losses by place and of the film. ``profile``: friction and film over ``path``."""
    prediction = results.prediction
    power = prediction.input_power
    positions = np.linspace(path.L_XA, path.L_XD, 201)
    film = path.film_thickness(positions)
    film_hamrock = path.film_thickness(positions, "hamrock_dowson")
    film_parameter = profile["film_parameter"].to_numpy()
    source = str(profile["film_thickness"].attrs["note"])
    parts = [NamedNumber(PLACES[place], loss, "W") for place, loss in prediction.losses.items()]
    all_places = "of the motion of page 1; the sum of the next rows"
    other_source = "central, Hamrock and Dowson (1977)"
    regimes = "below 1 boundary, above 4 full film"
    return named_numbers(
        "losses",
        "Losses at the operating point.",
        (
            NamedNumber("input power", power, "W"),
            NamedNumber("loss, all places", prediction.loss, "W", all_places),
            *parts,
            NamedNumber(
                "mesh loss of ISO/TR 14179-2", iso_14179_mesh_loss(results.pair), "W", "for comparison"
            ),
            NamedNumber("smallest film thickness", float(film.min()), "m", source),
            NamedNumber("the same by another formula", float(film_hamrock.min()), "m", other_source),
            NamedNumber("smallest film parameter", float(film_parameter.min()), "1", regimes),
        ),
    )


CHAPTER = Chapter("losses", "Losses and film", write, seconds=0.3)
