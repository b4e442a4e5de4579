"""What a sensor shows of teeth that differ: orders, time-synchronous averages, indicators, records."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
