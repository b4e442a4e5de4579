"""Spur gear pairs with sliding friction: schema, kinematics, stiffness, friction laws and the LTV model.

Names are imported on first use, so that ``spurcheck presets`` answers at once; ``__init__.pyi`` lists them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
