"""The form of the contact in one sentence: how far it is off the exact one, and what is not paid for."""

from __future__ import annotations

from validation.reporting.formatting import number, quantity
from validation.reporting.results import Results


def contact_form(results: Results) -> str:
    """How far the form of the contact is off the exact one, and what the other form gives.

    Of prescribed contact also what nobody pays for. Empty where the exact contact has no motion.
    """
    forms = results.forms
    if isinstance(forms, str):
        return ""
    spans = forms.spans(results.geometry.mesh_period)
    off = {name: number(100 * value, 2) for name, value in forms.difference.items()}
    told = {name: quantity(value, "m", 3) for name, value in spans.items()}
    if forms.own == "loaded":
        return (
            "The contact follows the load: this form is off the exact contact by up to "
            f"{off['loaded']}\u00a0% of the transmission error's peak to peak, prescribed contact by "
            f"{off['prescribed']}\u00a0%."
        )
    powers = forms.powers["prescribed"]
    return (
        f"Exact contact, from gaps and an elastic energy, gives {told['exact']} peak to peak. The paper's "
        f"form, linear and with contact by decree, is off it by up to {off['prescribed']}\u00a0% of that and "
        f"leaves {quantity(powers.energy_residual, 'W', 3)} of losses unpaid "
        f"({quantity(powers.driving, 'W', 3)} put in); "
        f"loaded contact gives {told['loaded']} and is off by up to {off['loaded']}\u00a0%."
    )
