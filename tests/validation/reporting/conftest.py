"""The reports that the tests of this folder read, written once."""

from collections.abc import Iterator

import pytest

from tests.validation.reporting.written import PAIRS, Written, known, without_variant, write_report


@pytest.fixture(scope="session", params=list(PAIRS))
def written(request, tmp_path_factory) -> Written:
    """The report of each pair, of the results that other tests ask for too."""
    folder = tmp_path_factory.mktemp(request.param) / "report"
    return write_report(request.param, folder, results=known(request.param))


@pytest.fixture(autouse=True, scope="module")
def no_variant() -> Iterator[None]:
    """Results that tests ask for later than the report of ``written`` leave the same out."""
    with pytest.MonkeyPatch.context() as patch:
        without_variant(patch)
        yield
