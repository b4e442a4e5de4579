"""The reports that the tests of this folder read, written once."""

import pytest

from tests.validation.reporting.written import PAIRS, Written, write_report


@pytest.fixture(scope="session", params=list(PAIRS))
def written(request, tmp_path_factory) -> Written:
    """The report of each pair."""
    return write_report(request.param, tmp_path_factory.mktemp(request.param) / "report")
