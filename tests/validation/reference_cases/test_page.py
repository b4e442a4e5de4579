"""Does docs/reference_cases.md show every case, with its picture and its discrepancies?"""

import re
from pathlib import Path

from validation.reference_cases.case import reference_names

PAGE = Path(__file__).parents[3] / "docs" / "reference_cases.md"


def test_every_case_has_a_section_with_its_facts_and_its_picture():
    text = PAGE.read_text(encoding="utf-8")
    sections = re.findall(r"^`(\w+)`$", text, re.MULTILINE)
    assert tuple(sections) == reference_names()
    for name in reference_names():
        assert f"_generated/reference_{name}.md" in text
        assert f"_generated/reference_{name}.svg" in text
