"""Independent multibody reference of a spur gear pair in exudyn, at two fidelities.

What the multibody model reads from ``lumped``, and what else checks each entry, is the table of decision 1 in
docs/contributing/decisions.md; ``tests/docs/test_decisions.py`` compares the table with the imports.
"""

from multibody.run.effects import EFFECTS
from multibody.run.flow_map import FlowMap, monodromy, steady_state
from multibody.run.simulation import simulate, speed_sweep
from multibody.study.balance import PowerBalance, motion_balance, power_balance
from multibody.study.causes import attribution

__all__ = [
    "EFFECTS",
    "FlowMap",
    "PowerBalance",
    "attribution",
    "monodromy",
    "motion_balance",
    "power_balance",
    "simulate",
    "speed_sweep",
    "steady_state",
]
