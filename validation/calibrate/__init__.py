"""What records of a rig say about the assumed inputs of a pair."""

from validation.calibrate.calibrate import calibrate
from validation.calibrate.posterior import Posterior

__all__ = ["Posterior", "calibrate"]
