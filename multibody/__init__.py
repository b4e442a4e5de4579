"""Independent multibody reference of a spur gear pair in exudyn, at two fidelities."""

from multibody.contact.effects import EFFECTS
from multibody.run.drive import Drive
from multibody.run.flow_map import FlowMap, monodromy, steady_state
from multibody.run.simulation import simulate
from multibody.run.sweep import speed_sweep
from multibody.study.balance import PowerBalance, power_balance
from multibody.study.blanks import Blank, blanks
from multibody.study.causes import attribution
from multibody.study.free_vibration import Decay, damping_check
from multibody.study.frozen_modes import frozen_modes
from multibody.study.reversal_convergence import reversal_convergence
from multibody.study.shaft_modes import shaft_modes
from multibody.study.shared import SHARED, Shared
from multibody.study.turning import TurningBuild, turning_build

__all__ = [
    "EFFECTS",
    "SHARED",
    "Blank",
    "Decay",
    "Drive",
    "FlowMap",
    "PowerBalance",
    "Shared",
    "TurningBuild",
    "attribution",
    "blanks",
    "damping_check",
    "frozen_modes",
    "monodromy",
    "power_balance",
    "reversal_convergence",
    "shaft_modes",
    "simulate",
    "speed_sweep",
    "steady_state",
    "turning_build",
]
