"""Does the vocabulary agree with the published REXS database, and do written values keep its ranges?

Set REXS_PUBLISHED to a folder with the published ``rexs_schema_<version>.xml`` (of the REXS API of the FVA).
They are not part of this repository, so these tests are skipped without them.
"""

import os
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import pytest

from validation.exchange.rexs.exporting import rexs_document
from validation.exchange.rexs.model import model_of
from validation.exchange.rexs.vocabulary import ATTRIBUTES, KINDS, NOT_TAKEN, VERSIONS, WRITTEN

FOLDER = Path(os.environ.get("REXS_PUBLISHED", "no such folder"))
if not FOLDER.is_dir():
    pytest.skip(
        "REXS_PUBLISHED names no folder with the published schemas, which are not ours to ship",
        allow_module_level=True,
    )


@cache
def database(version):
    root = ET.parse(FOLDER / f"rexs_schema_{version}.xml").getroot()
    units = {u.get("id"): u.get("name") for u in root.find("units")}
    kinds = {v.get("id"): v.get("name") for v in root.find("valueTypes")}
    attributes = {}
    for a in root.find("attributes"):
        unit = a.get("unit")
        attributes[a.get("attributeId")] = (units.get(unit, unit), kinds[a.get("valueType")], a)
    owners = {}
    for mapping in root.find("componentAttributeMappings"):
        owners.setdefault(mapping.get("componentId"), set()).add(mapping.get("attributeId"))
    components = {c.get("componentId") for c in root.find("components")}
    relations = {
        r.get("relationId"): (
            r.get("orderRequired") == "true",
            [
                {(x.get("roleId"), x.get("componentId")) for x in combination}
                for combination in r.find("allowedCombinations")
            ],
        )
        for r in root.find("relations")
    }
    return attributes, owners, components, relations


def test_every_attribute_of_the_vocabulary_is_in_the_database():
    found = set()
    for version in VERSIONS:
        attributes, _, components, _ = database(version)
        assert set(NOT_TAKEN) <= components
        for key in attributes.keys() & ATTRIBUTES.keys():
            unit, kind, _ = attributes[key]
            assert kind == KINDS.get(key, "floating_point")
            assert unit == ATTRIBUTES[key] or (version, unit) == ("2.0.0", "MPa")
            found.add(key)
    assert found == set(ATTRIBUTES)


@pytest.mark.parametrize("version", WRITTEN)
def test_what_is_written_keeps_the_ranges_choices_and_relations_of_the_database(preset, version):
    attributes, owners, _, relations = database(version)
    oil = {"iso_vg": 100, "temperature": 60}
    document = rexs_document(preset.with_(lubricant__viscosity_law=oil), version)
    model = model_of(document, "")
    for component in model.components.values():
        assert set(component.attributes) <= owners.get(component.type, set())
        for key, attribute in component.attributes.items():
            node = attributes[key][2]
            choices = [c.get("value") for c in node.iter("enumValue")]
            assert not choices or attribute.value in choices
            if isinstance(attribute.value, float | int):
                low, high = (float(node.get(k, s)) for k, s in (("rangeMin", "-inf"), ("rangeMax", "inf")))
                assert low < attribute.value < high or (
                    attribute.value == low and node.get("rangeMinIntervalOpen") == "false"
                ), key
    for relation in document["model"]["relations"]:
        ordered, allowed = relations[relation["type"]]
        assert ("order" in relation) == ordered
        assert {(ref["role"], ref["hint"]) for ref in relation["refs"]} in allowed
