"""Independent multibody reference of a spur gear pair in exudyn, at two fidelities."""

from multibody.balance import PowerBalance, power_balance
from multibody.causes import attribution
from multibody.drive import Drive
from multibody.effects import EFFECTS
from multibody.flow_map import FlowMap, monodromy, steady_state
from multibody.reversal_convergence import reversal_convergence
from multibody.simulation import simulate
from multibody.sweep import speed_sweep

__all__ = [
    "EFFECTS",
    "Drive",
    "FlowMap",
    "PowerBalance",
    "attribution",
    "monodromy",
    "power_balance",
    "reversal_convergence",
    "simulate",
    "speed_sweep",
    "steady_state",
]
