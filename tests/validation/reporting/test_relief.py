"""Does page 1 say that given relief is left out?"""

import lumped
from validation.reporting.words import ignored_relief

NASA = lumped.load_gear_pair("nasa_28_28")


def test_relief_that_is_given_acts_unless_page_1_says_otherwise():
    assert NASA.mesh.relief == "static"
    assert ignored_relief(NASA) == ""
    assert "given but ignored" in ignored_relief(NASA.with_(mesh__relief="ignored"))
    bare = {"mesh.relief": "ignored", "pinion.tip_relief": None, "gear.tip_relief": None}
    assert ignored_relief(NASA.with_(bare)) == ""
    root = {"amount": 5.0, "start_roll_angle": 14.0}
    assert "given but ignored" in ignored_relief(NASA.with_(bare | {"gear.root_relief": root}))
