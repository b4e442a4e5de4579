"""Do states, events and derivatives agree with closed solutions, differences and another integrator?"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from floquet.orbits.polynomials import crossing
from floquet.orbits.records import CLOSED, GAP
from floquet.orbits.system import Contact, ContactSystem
from lumped import NumericalError

GRAVITY = 9.0
STIFFNESS = 400.0
#: A mass that gravity presses on an undamped spring without clearance: z'' = g - k z where z > 0.
BOUNCER = ContactSystem(
    [[0.0]], [[0.0]], [GRAVITY], (Contact([1.0], [-1.0], STIFFNESS),), phases=[0.0, 1.0], output=[1.0]
)
K = np.array([[3.0, 1.0, -0.5], [2.5, -1.0, 0.3]])
DAMPING = np.array([[0.2, 0.3], [0.25, -0.2]])
FORCE = np.array([[[-1.0, 0.1], [0.8, 0.05], [0.3, 0.0]]] * 2)
#: Two masses, two contacts with clearances and polynomial coefficients, and a row that gathers.
GEARLIKE = ContactSystem(
    [[0.6, -0.1], [-0.1, 0.9], [0.2, 0.0]], [[0.03, 0.0], [0.0, 0.04], [0.0, 0.01]], [0.3, -0.1, 0.2],
    (
        Contact([1.0, -1.0], FORCE, K, DAMPING, [[0.0, 0.1]] * 2),
        Contact([1.0, -1.0], [-0.9, 0.7, -0.2], 0.5 * K, 0.1, [[0.05, 0.0], [0.05, -0.2]],
                present=[False, True]),
    ),
    phases=[0.0, 0.45, 1.0], output=[1.0, -1.0], parameter_force=[0.1, 0.0, -1.0],
)  # fmt: skip


def bounce_time(v0):
    """Time of flight and of contact of a mass that leaves the spring at speed v0."""
    omega = np.sqrt(STIFFNESS)
    return 2.0 * v0 / GRAVITY, (2.0 * np.pi - 2.0 * np.arctan2(v0 * omega, GRAVITY)) / omega


def test_an_event_is_not_found_again_at_the_start_of_the_next_step():
    """Rounding leaves a zero there; Newton's method must not leave the bracket for it."""
    assert 0.0 < crossing(np.array([1e-38, 1e-14, -0.76, -0.52, 0.71]), 1.0, 1.0) < 1e-10
    assert crossing(np.array([1e-20, 1.0, -10.0, 0.0]), 1.0, 1.0) == pytest.approx(0.1, rel=1e-15)


def test_a_bouncing_mass_returns_after_the_time_of_flight_and_contact():
    """Parabola and sine arc in turn, both in closed form; energy is kept."""
    flight, contact = bounce_time(2.0)
    T = flight + contact
    run = BOUNCER.run(np.array([0.0, -2.0 * T]), T, 3, logged=10, derivatives=True)
    assert run.end == pytest.approx([0.0, -2.0 * T], rel=1e-12, abs=1e-12)
    assert run.events["state"][:5].tolist() == [CLOSED, GAP, CLOSED, GAP, CLOSED]
    # After half of the flight the mass is v0^2/2g above the spring.
    assert run.least == pytest.approx(-(2.0**2) / (2.0 * GRAVITY), rel=1e-12)
    # The end over the start speed: the return time moves by dT/dv0, during which the mass falls on.
    step = 1e-6
    shift = (sum(bounce_time(2.0 + step)) - sum(bounce_time(2.0 - step))) / (2.0 * step)
    one = BOUNCER.run(np.array([0.0, -2.0 * T]), T, 1, derivatives=True)
    # The mass is still on its way for that long, at speed v0 and falling at g.
    assert one.derivative[0, 1] * T == pytest.approx(-2.0 * shift, rel=1e-8)
    assert one.derivative[1, 1] == pytest.approx(1.0 + GRAVITY * shift, rel=1e-8)
    assert np.linalg.det(one.derivative[:2, :2]) == pytest.approx(1.0, rel=1e-11)  # Liouville


def test_a_contact_that_opens_under_its_dampers_load_jumps_back():
    """Where the damper sees another rate than that of the gap, its load goes at once."""
    contact = Contact([1.0], [-1.0], 1.0, 1.0, clearance=[[0.0, 0.3]], clearance_rate=0.0)
    system = ContactSystem([[0.0]], [[0.0]], [0.0], (contact,), [0.0, 1.0], [1.0])
    x = np.array([0.05, 0.1])
    T = 1.0
    step = 1e-6
    run = system.run(x, T, 1, derivatives=True, logged=4)
    assert run.events["state"].tolist() == [GAP]
    columns = [
        (system.run(x + step * e, T, 1).end - system.run(x - step * e, T, 1).end) / (2 * step)
        for e in np.eye(2)
    ]
    assert run.derivative[:2, :2] == pytest.approx(np.array(columns).T, rel=1e-7)


def by_solve_ivp(s, x, T, cycles, p):
    """The same motion by DOP853, cut at phases of jumps and, by its dense output, at events."""
    u = np.array([1.0, -1.0])

    def field(t, y, piece):
        local = t - [0.0, 0.45][piece]
        z = y[:2]
        v = y[2:4]
        acceleration = T**2 * (s.force + p * np.array(s.parameter_force) - s.stiffness @ z)
        acceleration = acceleration - T * s.damping @ v
        stiffness = K[piece] @ local ** np.arange(3)
        damping = DAMPING[piece] @ local ** np.arange(2)
        force = np.array([-1 + 0.1 * local, 0.8 + 0.05 * local, 0.3])
        contacts = [(0.1 * local, 0.1, stiffness, damping, force)]
        if piece == 1:
            contacts += [(0.05 - 0.2 * local, -0.2, 0.5 * stiffness, 0.1, np.array([-0.9, 0.7, -0.2]))]
        for e, slope, ki, ci, a in contacts:
            d = u @ z - e
            rate = (u @ v - slope) / T
            load = ki * d + ci * rate
            if d > 0.0 and load > 0.0:
                acceleration = acceleration + T**2 * a * load
        return np.concatenate([v, acceleration])

    y = np.concatenate([x, [0.0]])
    for _ in range(cycles):
        for piece, (low, high) in enumerate([(0.0, 0.45), (0.45, 1.0)]):
            y = solve_ivp(
                field, (low, high), y, method="DOP853", rtol=1e-10, atol=1e-12, args=(piece,), max_step=2e-3
            ).y[:, -1]
    return y


def test_another_integrator_comes_to_the_same_state():
    """DOP853 with short steps across the events, where it loses digits."""
    gearlike_start = np.array([0.4, -0.2, 1.0, -2.5])
    run = GEARLIKE.run(gearlike_start, 5.0, 1, 0.3)
    other = by_solve_ivp(GEARLIKE, gearlike_start, 5.0, 1, 0.3)
    assert np.concatenate([run.end, run.accumulated]) == pytest.approx(other, abs=2e-7)


def test_the_error_falls_with_the_order():
    x = np.array([0.4, -0.2, 1.0, -2.5])
    exact = GEARLIKE.run(x, 5.0, 2, 0.3, order=24).end
    errors = [np.abs(GEARLIKE.run(x, 5.0, 2, 0.3, order=order).end - exact).max() for order in (6, 12, 18)]
    assert max(errors) < 1e-10  # the last terms control the step, whatever the order
    *_, finest = errors
    assert finest < 2e-12


def test_means_and_samples_are_those_of_the_motion():
    """Mean and mean square over a bounce against the closed motion."""
    flight, contact = bounce_time(2.0)
    T = flight + contact
    run = BOUNCER.run(np.array([0.0, -2.0 * T]), T, 1, samples=np.linspace(0.0, 1.0, 2000, endpoint=False))
    t = run.phases * T
    omega = np.sqrt(STIFFNESS)
    rest = GRAVITY / STIFFNESS
    inside = t - flight
    closed = rest * (1.0 - np.cos(omega * inside)) + 2.0 / omega * np.sin(omega * inside)
    motion = np.where(t < flight, -2.0 * t + 0.5 * GRAVITY * t**2, closed)
    assert run.states[:, 0] == pytest.approx(motion, abs=1e-12)
    assert run.loads[:, 0] == pytest.approx(np.where(t < flight, 0.0, STIFFNESS * closed), abs=1e-9)
    flown = -(2.0**3) / (1.5 * GRAVITY**2)  # integral of the parabola: -2 v0^3/(3 g^2)
    pressed = rest * contact - rest / omega * np.sin(omega * contact)
    pressed += 2.0 / STIFFNESS * (1.0 - np.cos(omega * contact))
    assert run.mean * T == pytest.approx(flown + pressed, rel=1e-12)
    assert run.largest_load == pytest.approx(GRAVITY + np.hypot(GRAVITY, 2.0 * STIFFNESS / omega), rel=1e-12)
    swing = BOUNCER.run(np.array([1.4 * rest, 0.0]), 2.0 * np.pi / omega, 1)  # in contact throughout
    assert swing.least_load == pytest.approx(0.6 * GRAVITY, rel=1e-9)


def test_endless_growth_is_refused():
    with pytest.raises(NumericalError, match="beyond all numbers"):
        ContactSystem([[-1e6]], [[0.0]], [0.0], (Contact([1.0], [-1.0], 1.0),), [0.0, 1.0], [1.0]).run(
            np.array([1.0, 0.0]), 1.0, 100
        )
