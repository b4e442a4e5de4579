"""Do the places agree that a new friction law, stiffness model or preset has to be entered in?"""

from __future__ import annotations

import inspect
import re
import typing
from importlib import metadata
from pathlib import Path

import pytest

from lumped.friction import LAWS
from lumped.schema.contact import FrictionLaw
from lumped.schema.files import load_gear_pair, preset_names
from lumped.schema.mesh import StiffnessModel
from lumped.stiffness import MODELS
from validation.commands.options import Law

ROOT = Path(__file__).parents[2]


def test_every_friction_law_can_be_named_in_a_file_and_on_the_command_line():
    assert set(typing.get_args(FrictionLaw)) == set(LAWS)
    text = typing.get_args(Law)[1].help
    assert [name for name in LAWS if name not in text] == []


def test_every_stiffness_model_can_be_named_in_a_file():
    union = typing.get_args(StiffnessModel)[0]
    named = {section.model_fields["model"].default for section in typing.get_args(union)}
    assert named == set(MODELS)


@pytest.mark.parametrize("name", preset_names())
def test_a_preset_is_named_as_its_file(name):
    assert load_gear_pair(name).name == name


def test_the_places_that_contributors_are_sent_to_exist():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!http)([^)]+)\)", text):
        assert (ROOT / target).exists(), target
    for path in re.findall(r"`((?:lumped|tests|validation)/[\w/]+\.\w+)`", text):
        assert (ROOT / path).exists(), path
    from lumped.friction import along_path, base

    assert inspect.isfunction(along_path.friction_settings)
    assert inspect.isclass(base.FrictionSettings)


def test_the_version_is_the_same_everywhere():
    version = metadata.version("spurcheck")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(rf"^version: {re.escape(version)}$", citation, re.MULTILINE)
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## {re.escape(version)}\b", changelog, re.MULTILINE)
