"""The paper's statements as rules: which number, which criterion.

The criteria put numbers on words such as "much", "negligible" or "abrupt" that the paper does not quantify;
they are stated with every claim, and its number beside them, so that a reader with other criteria can judge
anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from lumped.model.steady import UNSTABLE
from validation.paper.records import Statement
from validation.validity.flags import LOAD_NOISE

Numbers = Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class ClaimRule(Statement):
    """One statement of the paper, how its number is computed and when it holds.

    Attributes
    ----------
    value : number from the claim numbers of ``numbers.measure``
    holds : whether the criterion is met
    details : further numbers, name -> (function, unit)
    remark, otherwise : on the outcome where the criterion is met, and why where it is not
    figure : "4" or "7" where the number is of the motion in that figure, which must then be stable and in
        contact; "" where it is of the laws alone
    unpublished : why the claim cannot be judged from what was published; "" where it can
    """

    value: Callable[[Numbers], float]
    holds: Callable[[Numbers], bool]
    details: Mapping[str, tuple[Callable[[Numbers], float], str]] = field(default_factory=dict)
    remark: str = ""
    otherwise: str = ""
    figure: Literal["", "4", "7"] = ""
    unpublished: str = ""

    def unusable(self, numbers: Numbers) -> str:
        """Why the motion that the number is of does not count; "" where it does or none is needed."""
        if not self.figure:
            return ""
        radius, load = numbers[f"radius_{self.figure}"], numbers[f"min_load_{self.figure}"]
        if radius > UNSTABLE:
            return (
                f"The periodic motion of Fig. {self.figure} is unstable here (largest multiplier "
                f"{radius:.3g}): a gear pair would leave it."
            )
        if load < -LOAD_NOISE:
            return (
                f"The teeth separate in the motion of Fig. {self.figure} here (smallest load {load:.2g} of "
                "the static load), so the lumped model does not hold."
            )
        return ""


def _key(name: str, factor: float = 1.0) -> Callable[[Numbers], float]:
    return lambda n: factor * n[name]


def _fig5_mean(n: Numbers) -> float:
    return 50.0 * (n["mean_absolute_x_p"] + n["mean_absolute_y_p"])


RULES: tuple[ClaimRule, ...] = (
    ClaimRule(
        name="mean of II above III",
        statement="The mean friction coefficient of law II is much higher than that of law III.",
        definition="mean of |mu| from A to D, law II over law III, 22.6 N m and 1000 rpm (Fig. 2a); the "
        "smaller ratio of the 28/28 and the 25/31 pair",
        unit="times",
        criterion="at least 2 times",
        value=_key("mean_ratio"),
        holds=lambda n: n["mean_ratio"] >= 2.0,
        otherwise="Law II falls with speed and viscosity (14), law III grows with roughness (18): "
        "with this oil and these flanks they come closer.",
    ),
    ClaimRule(
        name="pitch point",
        statement="At the pitch point law III is near zero and law II is largest.",
        definition="largest |mu| of III within 0.01 mesh cycles of the pitch point over the mean of III; and "
        "that of II over its largest value elsewhere",
        unit="of the mean",
        criterion="III at most 0.2 of its mean there, II larger there than anywhere else",
        value=_key("iii_at_pitch"),
        holds=lambda n: n["iii_at_pitch"] <= 0.2 and n["ii_at_pitch"] > 1.0,
        details={"II at the pitch point over its largest value elsewhere": (_key("ii_at_pitch"), "times")},
        remark="Both follow from the laws' form: III goes with |SR|^1.04, II with the logarithm of 1/v_s up "
        "to its bound.",
        otherwise="Law II meets its upper bound away from the pitch point too, or law III changes its sign "
        "over more than 0.01 mesh cycles: the further numbers say which.",
    ),
    ClaimRule(
        name="abrupt regime change",
        statement="The mean friction coefficient of the composite law changes abruptly over speed.",
        definition="range of speeds over which the middle 80 % of the path of contact changes from II to III "
        "at 22.6 N m (Fig. 2b), over the speed at which half has changed",
        unit="% of the speed",
        criterion="at most 20 % of the speed, and mean of II at least 1.2 times mean of III there",
        value=_key("switch_width", 100.0),
        holds=lambda n: n["switch_width"] <= 0.2 and n["switch_drop"] >= 1.2,
        details={"mean of II over mean of III there": (_key("switch_drop"), "times")},
        otherwise="The change is as narrow as the film parameter is even along the path, and as deep as the "
        "two laws differ at that speed: the further numbers say which is missing.",
    ),
    ClaimRule(
        name="speed of the regime change",
        statement="The regime changes near 2500 rpm.",
        definition="speed at which half of the path of contact has changed from II to III at 22.6 N m (Fig. "
        "2b)",
        unit="rpm",
        criterion="2000 to 3000 rpm",
        value=_key("switch_speed"),
        holds=lambda n: 2000.0 <= n["switch_speed"] <= 3000.0,
        unpublished="Composite roughness and viscosity decide the speed, and the paper gives neither. The "
        "28/28 preset is calibrated to meet 2500 rpm, so its agreement is no evidence.",
    ),
    ClaimRule(
        name="jumps",
        statement="Friction jumps at the pitch point under laws I and II and is smooth under laws III and "
        "IV.",
        definition="jump of mu at the pitch point over the peak to peak of mu, the smaller one of laws I and "
        "II, at 56.5 N m and 4875 rpm",
        unit="of the peak to peak",
        criterion="at least 0.5 for I and II, at most 0.01 for III and IV",
        value=lambda n: min(n["jump_coulomb"], n["jump_benedict_kelley"]),
        holds=lambda n: (
            min(n["jump_coulomb"], n["jump_benedict_kelley"]) >= 0.5
            and max(abs(n["jump_xu_kahraman"]), abs(n["jump_smoothed_coulomb"])) <= 0.01
        ),
        details={
            "jump of III": (_key("jump_xu_kahraman"), "of the peak to peak"),
            "jump of IV": (_key("jump_smoothed_coulomb"), "of the peak to peak"),
        },
        remark="Where a tooth pair takes up its stiffness at once, the friction force of every law also "
        "jumps as pairs enter and leave; the claim is about the pitch point.",
        otherwise="The bound of law II makes its jump smaller, or the sharpness of law IV makes its change "
        "a jump: the further numbers say which.",
    ),
    ClaimRule(
        name="normal load",
        statement="The friction law has a negligible effect on the normal load.",
        definition="spread of the total normal load between laws I to IV, largest over the mesh cycle, over "
        "the mean load; 56.5 N m and 4875 rpm (Fig. 4)",
        unit="% of the mean load",
        criterion="at most 5 %",
        value=_key("load_spread", 100.0),
        holds=lambda n: n["load_spread"] <= 0.05,
        details={"rms over the mesh cycle": (_key("load_spread_rms", 100.0), "% of the mean load")},
        otherwise="Friction enters the mesh stiffness with mu tan(alpha); near a resonance that is enough to "
        "change the load by more.",
        figure="4",
    ),
    ClaimRule(
        name="LOA motion and DTE",
        statement="The friction law has a small effect on the motions: along the line of action and DTE.",
        definition="largest rms difference between two of laws I to IV over the mean peak to peak, the "
        "larger of x_p and DTE; 56.5 N m and 4875 rpm (Figs. 5, 6)",
        unit="% of the peak to peak",
        criterion="at most 5 %",
        value=lambda n: 100.0 * max(n["rms_x_p"], n["rms_dte"]),
        holds=lambda n: max(n["rms_x_p"], n["rms_dte"]) <= 0.05,
        details={
            "x_p": (_key("rms_x_p", 100.0), "% of the peak to peak"),
            "DTE": (_key("rms_dte", 100.0), "% of the peak to peak"),
        },
        otherwise="Friction enters the mesh stiffness with mu tan(alpha); near a resonance that is enough to "
        "change the motion by more.",
        figure="4",
    ),
    ClaimRule(
        name="OLOA motion",
        statement="The friction law has a small effect on the motions: off the line of action.",
        definition="largest rms difference between two of laws I to IV over the mean peak to peak of y_p; "
        "56.5 N m and 4875 rpm (Fig. 5)",
        unit="% of the peak to peak",
        criterion="at most 5 %",
        value=_key("rms_y_p", 100.0),
        holds=lambda n: n["rms_y_p"] <= 0.05,
        otherwise="Off the line of action friction is the only excitation, so the motion is as large as the "
        "coefficient, and the laws' coefficients differ several times.",
        figure="4",
    ),
    ClaimRule(
        name="second harmonic",
        statement="The motions vary most between the laws at the second mesh harmonic.",
        definition="mesh order 1 to 10 at which the amplitudes of y_p under laws I to IV are spread most "
        "(largest - smallest, in m); 56.5 N m and 4875 rpm (Fig. 5)",
        unit="mesh order",
        criterion="order 2",
        value=_key("order_y_p"),
        holds=lambda n: n["order_y_p"] == 2.0,
        details={
            "x_p": (_key("order_x_p"), "mesh order"),
            "DTE": (_key("order_dte"), "mesh order"),
            "y_p, spread over mean amplitude": (_key("relative_order_y_p"), "mesh order"),
            "x_p, spread over mean amplitude": (_key("relative_order_x_p"), "mesh order"),
            "DTE, spread over mean amplitude": (_key("relative_order_dte"), "mesh order"),
        },
        otherwise="The spread follows the amplitudes, which are largest at another mesh order: the laws "
        "differ by a factor of friction, not by an order of their own.",
        figure="4",
    ),
    ClaimRule(
        name="8 % discrepancy",
        statement="The curves of Fig. 5 differ by 8 % in the mean.",
        definition="mean over time and over the six pairs of laws I to IV of the absolute difference, over "
        "the mean peak to peak, averaged over x_p and y_p",
        unit="% of the peak to peak",
        criterion="6 to 10 %",
        value=_fig5_mean,
        holds=lambda n: 6.0 <= _fig5_mean(n) <= 10.0,
        details={
            "x_p alone": (_key("mean_absolute_x_p", 100.0), "% of the peak to peak"),
            "y_p alone": (_key("mean_absolute_y_p", 100.0), "% of the peak to peak"),
        },
        figure="4",
        unpublished="The paper says neither between which curves nor relative to what the 8 % are; readings "
        "that are equally natural differ by an order of magnitude.",
    ),
    ClaimRule(
        name="identified mu",
        statement="A friction coefficient of about 0.004 is identified from the measurements.",
        definition="mean of |mu| of law III at 79.1 N m and 800 rpm (Fig. 7), which an identified constant "
        "should resemble",
        unit="1",
        criterion="0.003 to 0.005",
        value=_key("mean_iii_slow"),
        holds=lambda n: 0.003 <= n["mean_iii_slow"] <= 0.005,
        details={
            "the same at 4000 rpm": (_key("mean_iii_fast"), "1"),
            # b8 = -0.390958 of equation 18: the unit of R that the print leaves open
            "the same at 800 rpm with R in millimetres": (_key("mean_iii_slow", 1000.0**-0.390958), "1"),
        },
        unpublished="The measured forces are not published as numbers, so nothing can be identified from "
        "them. What law III predicts with R in metres (value) and in millimetres (further numbers) stands "
        "beside the 0.004.",
    ),
    ClaimRule(
        name="3 % error",
        statement="Predicted and measured forces differ by 3 % at most.",
        definition="largest friction force of a tooth pair under law III at 79.1 N m and 4000 rpm (Fig. 7): "
        "what a 3 % error would have to be measured against",
        unit="N",
        criterion="within 3 % of the value at the stated assumptions",
        value=_key("peak_friction"),
        holds=lambda n: True,
        details={"largest normal load of a pair": (_key("peak_normal"), "N")},
        figure="7",
        unpublished="The measured forces are not published as numbers. The assumptions alone move the "
        "predicted friction by more than 3 %: see its 5 and 95 % values.",
    ),
)
