"""Calibrations that several tests look at."""

import pytest

from tests.validation.calibrate.rig import TRUTH, rig_pair, rig_record
from validation.calibrate import calibrate


@pytest.fixture(scope="session")
def truth():
    return rig_pair().with_(TRUTH)


@pytest.fixture(scope="session")
def one_run(truth):
    """A posterior of one record, with a discrepancy of the model."""
    return calibrate(rig_pair(), rig_record(truth), machines=32, progress=False)


@pytest.fixture(scope="session")
def exact(truth):
    """The same without a discrepancy."""
    return calibrate(rig_pair(), rig_record(truth), False, machines=64, progress=False)
