"""Forms of the model that a fit enumerates, and the inputs that it varies in each of them.

A form is one choice of stiffness model, form of contact and friction law. The numeric inputs are those of
``uncertain_inputs``, as standard normal scores z: the share Phi(z) of the distribution lies below the value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.special import ndtr, ndtri

from lumped.errors import ParameterError
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.prediction.inputs import uncertain_inputs
from validation.prediction.uncertain_input import Input
from validation.prediction.uncertainty import varied

_LAW = "friction.law"
_STIFFNESS = "mesh.stiffness"
_CONTACT = "mesh.contact"
#: Prior probability of the form of contact that the pair does not have.
OTHER_CONTACT = 0.2
#: Largest size of a normal score.
LIMIT = 3.5
#: Step of a slope in normal scores.
_STEP = 0.1


@dataclass(frozen=True)
class Form:
    """One form of the model.

    Attributes
    ----------
    fields : field -> chosen name, as pairs: what the form changes in the pair
    prior : probability before the records
    """

    fields: tuple[tuple[str, str], ...]
    prior: float

    @property
    def law(self) -> str | None:
        """Friction law of the form; None: the pair's own."""
        return dict(self.fields).get(_LAW)

    @property
    def mesh(self) -> tuple[tuple[str, str], ...]:
        """The form without its friction law."""
        return tuple(one for one in self.fields if one[0] != _LAW)


def forms_of(pair: GearPair) -> tuple[Form, ...]:
    """Return the forms of a pair; the form of the pair as given is first.

    Uncertain choices of stiffness model and friction law are equally probable. The other form of contact has
    the probability ``OTHER_CONTACT``, where the form of contact is assumed.
    """
    axes: list[list[tuple[str, str, float]]] = []
    for one in uncertain_inputs(pair):
        if one.choices:
            own = pair.mesh.stiffness.model if one.field == _STIFFNESS else pair.friction.law
            names = sorted(one.choices, key=lambda name: name != own)
            axes.append([(one.field, name, 1.0 / len(names)) for name in names])
    if not pair.mesh.stiffness.whole_mesh and _CONTACT in pair.assumed:
        own = pair.mesh.contact
        other = "prescribed" if own == "loaded" else "loaded"
        axes.append([(_CONTACT, own, 1.0 - OTHER_CONTACT), (_CONTACT, other, OTHER_CONTACT)])
    forms = []
    for chosen in product(*axes):
        fields = tuple((field, name) for field, name, _ in chosen)
        try:
            pair_of(pair, Form(fields, 1.0))
        except ParameterError:  # a form that the pair cannot have
            continue
        forms.append(Form(fields, float(np.prod([share for _, _, share in chosen]))))
    return tuple(forms)


def pair_of(pair: GearPair, form: Form) -> GearPair:
    """Return the pair in a form, with its inputs as given."""
    changes: dict[str, object] = {}
    for field, name in form.fields:
        if field == _STIFFNESS:
            if name != pair.mesh.stiffness.model:
                changes[_STIFFNESS] = {"model": name}
        else:
            changes[field] = name
    return pair.with_(changes) if changes else pair


def numeric_inputs(pair: GearPair) -> tuple[Input, ...]:
    """Return the inputs that are numbers. The seed of random teeth is none: no record of means knows it."""
    return tuple(one for one in uncertain_inputs(pair) if not one.choices and not one.field.endswith(".seed"))


def machine(pair: GearPair, inputs: Sequence[Input], z: FloatArray) -> GearPair:
    """Return the pair with its inputs at normal scores z (input,).

    Raises
    ------
    ParameterError : values that no pair can have together
    """
    return varied(pair, [(one, float(u)) for one, u in zip(inputs, ndtr(z), strict=True)]).healthy


def beside(one: Input, score: float) -> float:
    """Return a normal score at a small distance, towards the middle of the range.

    An input with levels moves to the middle of the next level.
    """
    levels = one.parts[0].levels
    down = score > 0.0
    if not levels:
        return score + (-_STEP if down else _STEP)
    level = min(int(ndtr(score) * levels), levels - 1)
    return float(ndtri((level + (-0.5 if down else 1.5)) / levels))


def level_score(one: Input, score: float) -> float:
    """Return the normal score of the value that an input has: with levels that of the middle of its level."""
    levels = one.parts[0].levels
    if not levels:
        return score
    return float(ndtri((min(int(ndtr(score) * levels), levels - 1) + 0.5) / levels))
