"""What a sensor shows of teeth that differ: orders, time-synchronous averages, indicators, records."""

from lumped.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
