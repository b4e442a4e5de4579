"""Spur gear pairs with sliding friction: schema, kinematics, stiffness, friction laws and the LTV model.

Names are imported on first use, so that ``spurcheck presets`` answers at once; ``__init__.pyi`` lists them.
"""

from lumped.public_names import public_names

__getattr__, __dir__, __all__ = public_names(__name__, __file__)
