"""Is the company's model still right? Two tests: the model as it is, and what a mistake would say."""

import company_model
import pytest


@pytest.mark.spurcheck(pair="mypair.toml")
def test_the_model_agrees(spurcheck_reference):
    spurcheck_reference.check(company_model.simulate())


@pytest.mark.spurcheck(pair="mypair.toml", budget=20.0)
def test_what_friction_with_the_wrong_sign_would_say(spurcheck_reference):
    with pytest.raises(AssertionError, match=r"Your model differs: misfit .*, limit 5 %"):
        spurcheck_reference.check(company_model.simulate(mu=-company_model.MU))
