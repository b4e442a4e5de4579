"""Motions of pairs, each computed once: the tests of this folder only read them."""

from functools import cache

from validation.check import reference
from validation.prediction import motion

lumped_motion = cache(reference.lumped_motion)
multibody_motion = cache(reference.multibody_motion)
predicted = cache(motion.predicted)
