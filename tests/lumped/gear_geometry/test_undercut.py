"""Undercut and small gears: where contact ends, what the mate's tip cuts into, and what would mesh."""

import math
import re

import numpy as np
import pytest
from scipy.optimize import fsolve

import lumped
import multibody
from lumped import ParameterError
from lumped.gear_geometry.geometry import existence_problems
from lumped.gear_geometry.interference import tip_clearance
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.mesh.statics import flank_end_gaps, tips_minus_edges
from lumped.model.mesh_cycle import MeshCycle
from lumped.quasi_static.elements import at_rest
from lumped.quasi_static.loaded import StaticMesh, loaded_contact
from lumped.quasi_static.tooth_error import corner_gap, relief_error
from multibody.contact import kinematics as kn
from multibody.gears.circles import circles, reliefs
from spurcheck import new_pair

ANGLE = math.radians(20.0)
STOCK = {"module": 1.0, "face_width": 8.0, "speed": 1000.0, "torque": 1.0}


def stock(teeth, **changes):
    """Stock gears of module 1 mm without profile shift, where nothing else is said."""
    return new_pair(teeth, **STOCK, **changes)


def test_a_stock_pair_15_40_by_hand():
    """Lengths in mm. The edge is where the trochoid of the rack's tip meets the involute, both by hand.

    Rack of ISO 53: centre of the rounding 0.38 at the depth 1.25 - 0.38 = 0.87, and off the centre of its
    tooth by pi/4 - 0.87 tan 20 - 0.38/cos 20 = 0.06436. At the roll phi the cut lies on the line from the
    pitch point through that centre, 0.38 behind it.
    """
    r = 7.5
    base = 7.5 * math.cos(ANGLE)
    centre_offset = math.pi / 4 - 0.87 * math.tan(ANGLE) - 0.38 / math.cos(ANGLE)

    def apart(unknown):
        roll, length = unknown
        along = centre_offset - r * roll
        down = 0.87
        stretch = 1.0 + 0.38 / math.hypot(along, down)
        x, y = along * stretch, r - down * stretch
        # Half the space: pi/(2 z), wider towards the tip by inv(angle there) - inv(20 degrees).
        space = math.pi / 30 - (math.tan(ANGLE) - ANGLE) + length / base - math.atan(length / base)
        return math.hypot(x, y) - math.hypot(base, length), math.atan2(x, y) + roll - space

    _, edge = fsolve(apart, (-0.3, 0.2), xtol=1e-13)
    line = 27.5 * math.sin(ANGLE)
    tip_pinion = math.sqrt(8.5**2 - base**2)
    tip_gear = math.sqrt(21.0**2 - (20.0 * math.cos(ANGLE)) ** 2)
    assert edge == pytest.approx(0.171309, abs=1e-6)
    # Contact down to a diameter of 14.1 mm: undercut costs 4 um of it.
    diameters = [2.0 * math.hypot(base, length) for length in (line - tip_gear, edge)]
    assert diameters == pytest.approx([14.0956, 14.0995], abs=1e-4)
    g = stock("15/40").geometry
    assert 1e3 * g.centre_distance == pytest.approx(27.5, rel=1e-12)
    assert pytest.approx(edge, rel=1e-9) == 1e3 * g.L_XA
    assert pytest.approx(tip_pinion, rel=1e-9) == 1e3 * g.L_XD
    pitch = math.pi * math.cos(ANGLE)
    assert g.contact_ratio == pytest.approx((tip_pinion - edge) / pitch, rel=1e-9)
    assert g.tip_contact_ratio == pytest.approx((tip_pinion + tip_gear - line) / pitch, rel=1e-9)
    (note,) = g.notes
    assert note == "undercut shortens contact by 0.135 mm at its start: contact ratio 1.552 instead of 1.597"


def test_the_driven_gear_may_be_the_undercut_one():
    g = stock("15/40").geometry
    swapped_geometry = stock("40/15").geometry
    assert pytest.approx(swapped_geometry.L_XY - g.L_XA, rel=1e-12) == swapped_geometry.L_XD
    assert swapped_geometry.contact_ratio == pytest.approx(g.contact_ratio, rel=1e-12)
    assert "at its end" in swapped_geometry.notes[0]


def test_17_teeth_are_the_limit_of_undercut_and_14_that_of_usual_tolerance():
    """z = 2 h/sin^2(20 degrees): 17.097 for a rack that reaches h = 1 module straight, 14.25 for h = 5/6.

    The joint of flank and trochoid then lies on the tangent point; with fewer teeth it is cut off.
    """
    for reach, limit in ((1.0, 17.097), (5.0 / 6.0, 14.248)):
        assert 2.0 * reach / math.sin(ANGLE) ** 2 == pytest.approx(limit, abs=1e-3)
        dedendum = reach + 0.38 * (1.0 - math.sin(ANGLE))
        cut = [ToothProfile(z, 1.0, ANGLE, 0.0, dedendum, 0.38).undercut_length for z in range(10, 25)]
        assert [length > 0.0 for length in cut] == [z < limit for z in range(10, 25)]
    # What 14 teeth lose to a rack that reaches 1 module: a fortieth of the flank's height of 2 modules.
    tooth = ToothProfile(14, 1.0, ANGLE, 0.0, 1.25, 0.38)
    assert 0.0 < math.hypot(tooth.base_radius, tooth.form_length) - tooth.base_radius < 0.05


# ---- brute force: the rack cuts polygons, and the corner of the mate's tip runs through the space ----------


class Cut:
    """Half the space of a gear over the radius, as the points of a rack's tooth leave it; module 1."""

    STEP = 5e-4

    def __init__(self, z, shift, dedendum, fillet, tip):
        centre = math.pi / 4 - (dedendum - fillet) * math.tan(ANGLE) - fillet / math.cos(ANGLE)
        rounding = np.linspace(0.0, 0.5 * math.pi - ANGLE, 200)  # from the bottom to the straight flank
        x = centre + fillet * np.sin(rounding)
        y = fillet - dedendum - fillet * np.cos(rounding)
        straight = np.linspace(y[-1], 2.0, 2000)
        x = np.append(x, x[-1] + (straight - y[-1]) * math.tan(ANGLE))
        y = np.append(y, straight)
        radius = 0.5 * z
        self.z = z
        self.tip = tip
        self.root = radius - dedendum + shift
        self.half = np.zeros(int((tip - self.root) / self.STEP) + 2)
        for roll in np.linspace(-12.0, 12.0, 5001) / z:
            along = x - radius * roll
            out = radius + shift + y
            far = np.hypot(along, out)
            place = ((far - self.root) / self.STEP).astype(int)
            inside = (place >= 0) & (place < self.half.size)
            np.maximum.at(self.half, place[inside], np.arctan2(along, out)[inside] + roll)

    def space(self, radius):
        """Half the space at radii (n,) as an angle."""
        return np.interp(radius, self.root + (np.arange(self.half.size) + 0.5) * self.STEP, self.half)

    @property
    def land(self):
        """Half the tooth at its tip as an angle."""
        return math.pi / self.z - float(self.space(np.array([self.tip - self.STEP]))[0])


def clearance(gear, mate, centre):
    """Least way of the mate's tip corner to the flanks of the gear [modules].

    Both turn from where a tooth of the mate stands in the middle of the space, which it fills there.
    """
    turn = np.linspace(-9.0, 9.0, 20001) / mate.z
    seen = centre - mate.tip * np.exp(1j * (turn + mate.land))
    radius = np.abs(seen)
    met = np.abs(seen) < gear.tip
    beside = np.abs(np.angle(seen) + turn * mate.z / gear.z)
    return float((radius * (gear.space(radius) - beside))[met].min())


def test_interference_is_found_as_by_brute_force():
    """8 random small pairs, as many of each kind, whose clearance is not too near 0 for polygons to call."""
    seed = 20261128
    rng = np.random.default_rng(seed)
    missing = {False: 4, True: 4}
    while any(missing.values()):
        z = int(rng.integers(7, 20)), int(rng.integers(12, 60))
        shift = float(rng.uniform(-0.3, 0.25)), float(rng.uniform(-0.2, 0.3))
        dedendum = float(rng.uniform(1.05, 1.4))
        fillet = float(rng.uniform(0.1, 0.3))
        teeth = [ToothProfile(n, 1.0, ANGLE, x, dedendum, fillet) for n, x in zip(z, shift, strict=True)]
        # Without backlash: inv(alpha_w) = inv(alpha) + 2 sum(x) tan(alpha)/sum(z).
        inv = math.tan(ANGLE) - ANGLE + 2.0 * sum(shift) * math.tan(ANGLE) / sum(z)
        (working,) = fsolve(lambda angle, inv=inv: np.tan(angle) - angle - inv, ANGLE)
        centre = 0.5 * sum(z) * math.cos(ANGLE) / math.cos(working)
        tips = [0.5 * n + x + rng.uniform(0.85, 1.3) for n, x in zip(z, shift, strict=True)]
        if any(centre - tips[i] - teeth[1 - i].root_radius < 0.01 for i in (0, 1)):
            continue
        by_program = tip_clearance(teeth[0], tips[0], teeth[1], tips[1], centre)
        if -1e-3 < by_program < -1e-6 or not missing[by_program < -1e-4]:
            continue
        missing[by_program < -1e-4] -= 1
        gears = [Cut(n, x, dedendum, fillet, t) for n, x, t in zip(z, shift, tips, strict=True)]
        by_polygons = clearance(*gears, centre)
        # Bins of 5e-4 modules, in which a flank that stands askew changes by up to as much.
        assert by_polygons == pytest.approx(by_program, abs=6e-4), (seed, z, shift, dedendum, fillet, tips)


# ---- what is refused, and what would do --------------------------------------------------------------------

FIXED = {"centre_distance": 25.0}
ROUNDED = {"basic_rack__fillet_radius_coefficient": 0.3}
REFUSED = [
    ("8/60", {}, "contact_ratio"),
    ("6/60", {}, "contact_ratio"),
    ("8/8", {}, "contact_ratio"),
    ("10/40", FIXED | {"pinion__profile_shift": -0.3, "gear__profile_shift": 0.3}, "contact_ratio"),
    ("20/90", ROUNDED | {"basic_rack__dedendum_coefficient": 1.1}, "profile_shift"),
    ("12/24", {"pinion__profile_shift": 1.2}, "tip_diameter"),
    ("9/50", {"gear__addendum": 1.24, "pinion__profile_shift": -0.1}, "profile_shift"),
]  # fmt: skip
_VALUE = re.compile(r"(pinion|gear)\.(\w+) = (-?\d+(?:\.\d+)?)")


def ways_out(error):
    """Changes that a refusal says would do, each as {field: value}."""
    for problem in error.problems:
        for sentence in re.findall(r"(?:pinion|gear)\.\w+ = .*? would do", problem.action):
            for change in sentence.split(", or "):
                yield {f"{gear}.{field}": float(value) for gear, field, value in _VALUE.findall(change)}


@pytest.mark.parametrize(("teeth", "changes", "field"), REFUSED)
def test_what_a_refusal_says_would_do_does(teeth, changes, field):
    with pytest.raises(ParameterError) as refusal:
        stock(teeth, **changes)
    assert any(problem.field.endswith(field) for problem in refusal.value.problems)
    solutions = list(ways_out(refusal.value))
    assert solutions
    for solution in solutions:
        sizes = {path: int(value) if path.endswith("teeth") else value for path, value in solution.items()}
        z = [int(n) for n in teeth.split("/")]
        z = [sizes.pop(f"{gear}.teeth", n) for gear, n in zip(("pinion", "gear"), z, strict=True)]
        all_changes = {key.replace("__", "."): value for key, value in changes.items()} | sizes
        assert stock(f"{z[0]}/{z[1]}", changes=all_changes).geometry.contact_ratio >= 1.0


def test_the_profile_shift_that_would_do_is_the_least():
    """In steps of 0.01, which the search takes; of 8/60 the pinion's undercut leaves too short a contact."""
    with pytest.raises(ParameterError, match=r"pinion\.profile_shift = 0\.11, or pinion\.teeth = 9 would do"):
        stock("8/60")
    with pytest.raises(ParameterError, match="contact_ratio"):
        stock("8/60", pinion__profile_shift=0.10)


def test_a_hob_that_undercuts_clears_the_way():
    """The mate's tip passes the tangent point of 12 teeth by 0.58 mm, and runs: the rack has cut deeper."""
    pair = stock("12/60")
    g = pair.geometry
    assert g.L_XY - g.tip_length_gear == pytest.approx(-0.582e-3, abs=1e-6)
    assert pair.profile_shifts[0] == 0.0
    assert g.contact_ratio == pytest.approx(1.275, abs=1e-3)
    # With a longer tip it would cut into the trochoid.
    pinion, gear = pair.wheels
    assert not existence_problems(pinion, gear, g, 0.0)
    arguments = pinion.tooth, pinion.tip_radius, gear.tooth
    reach = [tip_clearance(*arguments, gear.tip_radius + more, g.centre_distance) for more in (0.0, 0.2e-3)]
    assert reach[0] > 0.0 > reach[1]


# ---- contact beyond the edge -------------------------------------------------------------------------------


def outline(tooth, tip):
    """Radii and half the thickness of a tooth, root to tip, densely."""
    start, end = tooth.fillet_range
    x, y = tooth.trochoid(roll := np.linspace(start, end, 4001))
    length = np.linspace(tooth.form_length, math.sqrt(tip**2 - tooth.base_radius**2), 8001)
    flank = tooth.base_half_angle - (length / tooth.base_radius - np.arctan(length / tooth.base_radius))
    radius = np.append(np.hypot(x, y), np.hypot(tooth.base_radius, length))
    return radius, np.append(math.pi / tooth.teeth - np.arctan2(x, y) - roll, flank)


def gap_of_outlines(pair, xi):
    """Way of the flanks along the line of action until both outlines touch, the pair at xi [m]."""
    g = pair.geometry
    pinion, gear = pair.wheels
    pinion_outline = outline(pinion.tooth, pinion.tip_radius)
    gear_outline = outline(gear.tooth, gear.tip_radius)
    inverse = math.tan(g.operating_pressure_angle) - g.operating_pressure_angle
    back = g.L_XP - xi
    # Half a tooth on the operating pitch circle, behind the pinion's flank and ahead of the gear's.
    pinion_turn = pinion.tooth.base_half_angle - inverse + back / g.base_radius_pinion
    gear_turn = -(gear.tooth.base_half_angle - inverse) + back / g.base_radius_gear
    gaps = []
    for (radius, half), (other, other_half), turn, other_turn, sense, base in (
        (gear_outline, pinion_outline, gear_turn, pinion_turn, 1.0, g.base_radius_pinion),
        (pinion_outline, gear_outline, pinion_turn, gear_turn, -1.0, g.base_radius_gear),
    ):
        angle = turn + sense * half
        across = radius * np.sin(angle)
        along = g.centre_distance - radius * np.cos(angle)
        far = np.hypot(across, along)
        facing = (far > other[0]) & (far < other[-1])
        angle_between = sense * (other_turn - np.arctan2(across, along)) - np.interp(far, other, other_half)
        gaps.append(base * float(angle_between[facing].min()) if facing.any() else math.inf)
    return min(gaps)


@pytest.mark.parametrize("teeth", ["15/40", "12/60", "10/60", "16/200"])
def test_gap_before_the_edge_is_that_of_the_drawn_teeth(teeth):
    """Edge on flank, then tip corner on flank: both follow from one formula."""
    pair = stock(teeth)
    g = pair.geometry
    assert g.L_XA == g.undercut_pinion > g.L_XY - g.tip_length_gear
    places = g.L_XA - g.base_pitch * np.array([0.005, 0.02, 0.05, 0.1, 0.15, 0.25, 0.3, 0.35, 0.4])
    drawn = np.array([gap_of_outlines(pair, xi) for xi in places])
    # The outlines miss the edge by up to a step: 0.5 um along a flank, some per cent of the smallest gaps.
    assert corner_gap(g, places) == pytest.approx(drawn, rel=0.02, abs=2e-10)


def test_a_tip_relief_ends_at_the_tip_and_a_flank_at_the_edge():
    """The gear's tip is beyond A of an undercut pair: there its relief is not yet whole."""
    pair = stock("12/60")
    g = pair.geometry
    tip = 1e-3 * math.sqrt(31.0**2 - (30.0 * math.cos(ANGLE)) ** 2)
    start = g.L_XY - g.L_XP
    degrees = math.degrees(start / g.base_radius_gear)
    relief = {"amount": 10.0, "start_roll_angle": degrees, "shape": "linear"}
    relieved = pair.with_({"gear.tip_relief": relief})
    at_a = 10e-6 * (g.L_XY - g.L_XA - start) / (tip - start)
    assert float(relief_error(relieved, np.array([g.L_XA]))[0]) == pytest.approx(at_a, rel=1e-9)
    assert at_a < 8.2e-6
    assert pair.flank(1).tip == pytest.approx(tip, rel=1e-12)
    assert pair.flank(0).start == g.undercut_pinion
    assert reliefs(relieved, circles(relieved))[0].end == pytest.approx(tip / g.base_radius_gear, rel=1e-12)


@pytest.mark.parametrize("teeth", ["15/40", "40/15", "12/60"])
def test_edges_of_both_models_have_one_gap(teeth):
    """Gap and slopes of the multibody model's ends of flanks against the lumped gap, and differences."""
    pair = stock(teeth)
    g = pair.geometry
    circle = circles(pair)
    assert (circle.start, circle.end) == pytest.approx((g.L_XA, g.L_XD), rel=1e-9)
    line = kn.Line(1.0, 0.0, g.L_XY, kn.DRIVE, g.base_radius_pinion, g.base_radius_gear)
    tips = (circle.reach_pinion, circle.reach_gear)
    edges = (circle.edge_pinion, circle.edge_gear)

    def corners(rho_p, rho_g, lengthening=0.0):
        return kn.corners_at(line._replace(length=g.L_XY + lengthening), rho_p, rho_g, tips, edges)

    h = 1e-8
    for distance in (0.01, 0.04, 0.1, 0.3):
        for xi in (g.L_XA - distance * g.base_pitch, g.L_XD + distance * g.base_pitch):
            lengths = xi, g.L_XY - xi
            corner = corners(*lengths)
            assert corner.gap == pytest.approx(float(corner_gap(g, np.array([xi]))[0]), rel=1e-7)
            by_p = [corners(lengths[0] + s, lengths[1]).gap for s in (h, -h)]
            by_g = [corners(lengths[0], lengths[1] + s).gap for s in (h, -h)]
            by_length = [corners(*lengths, s).gap for s in (h, -h)]
            slopes = [(a - b) / (2.0 * h) for a, b in (by_p, by_g, by_length)]
            assert (corner.by_p, corner.by_g, corner.by_length) == pytest.approx(slopes, rel=1e-5, abs=1e-8)


@pytest.mark.parametrize("teeth", ["15/40", "40/15", "12/60"])
def test_loaded_contact_reaches_beyond_the_edge(teeth):
    """A load closes the gap of the edge: at its first touch the static approach is that gap."""
    pair = stock(teeth, mesh__stiffness={"model": "energy"})
    g = pair.geometry
    contact = loaded_contact(at_rest(pair))
    low, high = contact.contact[0, 0], contact.contact[-1, 1]
    assert low < g.L_XA
    assert high > g.L_XD
    mesh = StaticMesh(at_rest(pair))
    first = mesh.static(np.array([low, high]))
    # What neighbours take off the approach there, the gap leaves: nothing is left to press.
    assert first.compression == pytest.approx([0.0, 0.0], abs=1e-11)
    # Where the edge begins to touch, and gives way to the tip, the pieces of the fit end; it follows to 5e-9.
    at_start = g.undercut_pinion == g.L_XA
    breaks = contact.gap.breaks
    for quantity in (mesh.beyond_edge, mesh.tip_minus_edge):
        assert np.abs(quantity(at_start, breaks)).min() < 1e-11
    xi = np.linspace(low, high, 2001)[1:-1]
    exact = mesh.static(xi)
    assert contact.gap(xi) == pytest.approx(exact.gap, abs=2e-8 * exact.approach.max())


def test_both_models_run_an_undercut_pair_alike():
    """The linear forms to the tolerance of the integration, the exact one by the first law."""
    pair = stock("12/60", mesh__stiffness={"model": "energy"})
    one = lumped.simulate(pair, cycles=3)
    other = multibody.simulate(pair, cycles=3, fidelity="linear")
    swing = float(np.ptp(one.dte.to_numpy()))
    assert np.abs(one.dte.to_numpy() - other.dte.to_numpy()).max() < 1e-7 * swing
    balance = multibody.power_balance(pair, cycles=3)
    assert abs(float(balance.residual)) < 1e-9 * float(balance.driving)


@pytest.mark.parametrize("teeth", ["15/40", "12/60", "16/200", "14/40"])
def test_the_sign_that_finds_kinks_says_whether_tip_or_edge_decides(teeth):
    g = stock(teeth).geometry
    xi = np.linspace(g.L_XA - 0.4 * g.base_pitch, g.L_XP, 4001)
    radii = g.base_radius_pinion, g.base_radius_gear
    ways = g.L_XY - xi - g.tip_length_gear, g.undercut_pinion - xi
    sizes = g.tip_length_gear, g.undercut_pinion
    both = flank_end_gaps(ways[0], sizes[0], ways[1], sizes[1], g.L_XY, *radii)
    without_tip = flank_end_gaps(np.full(xi.size, -1.0), 1e-9, ways[1], sizes[1], g.L_XY, *radii)
    sign = tips_minus_edges(ways[0], sizes[0], ways[1], sizes[1], g.L_XY, *radii)
    assert ((sign > 0.0) == (both > without_tip)).all()
    assert (np.diff(np.sign(sign)) != 0.0).sum() == 1


def test_an_undercut_pair_moves_by_momentary_load_as_in_its_linear_form():
    """At 1000 rpm, far below resonance, both are near the static motion: within a tenth of its swing."""
    pair = stock("15/40", mesh__stiffness={"model": "energy"})
    swings = [
        np.ptp(lumped.steady_state(pair, contact=one).dte.to_numpy()) for one in ("linear", "unilateral")
    ]
    assert swings[1] == pytest.approx(swings[0], rel=0.1)


@pytest.mark.parametrize("law", ["xu_kahraman", "benedict_kelley"])
def test_friction_beyond_the_edge_is_that_at_the_edge(law):
    """Contact of 12/60 reaches past the base circle, where an involute would have no curvature."""
    pair = stock("12/60", mesh__stiffness={"model": "energy"}, law=law)
    g = pair.geometry
    low = float(loaded_contact(at_rest(pair)).stiffness.interval[0])
    assert low < 0.0 < g.L_XA
    mu = MeshCycle.of(pair).elements.friction(np.array([low, 0.0, 0.9 * g.L_XA, g.L_XA]))
    assert mu == pytest.approx(np.full(4, mu[-1]), rel=1e-9)
    one = lumped.simulate(pair, cycles=2)
    other = multibody.simulate(pair, cycles=2, fidelity="linear")
    friction = one.friction_force.to_numpy()
    assert np.isfinite(friction).all()
    assert np.abs(friction - other.friction_force.to_numpy()).max() < 1e-5 * np.abs(friction).max()
