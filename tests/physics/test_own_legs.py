"""Legs that are not linear in time, written outside the package, with every kind of time steps."""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from annotated_types import Ge, Gt
from scipy.integrate import quad, solve_ivp

import asperity as asp
from asperity.analysis.legs import leg_table, protocol_of
from asperity.base.parameters import Quantity
from asperity.contact import ActiveSet, Multigrid
from asperity.protocols import Hold, Leg, Repeat, Step
from asperity.protocols.legs import described, in_words, leg_of
from tests.history_reference import assert_follows, second_order
from tests.refusals import each_refuses
from tests.surfaces import correlated, uncorrelated


@dataclass(frozen=True)
class Sine(Leg):
    """The load, the pressure, the separation or the approach oscillates about what it was."""

    duration: Annotated[float, Gt(0), Quantity("how long it lasts", "s")]
    amplitude: Annotated[float, Ge(0), Quantity("amplitude")]
    period: Annotated[float, Gt(0), Quantity("period", "s")]
    target: Annotated[Literal["load", "pressure", "separation", "approach"], Quantity("what oscillates")] = (
        "load"
    )
    mobility: Annotated[float, Gt(0), Quantity("factor on the mobility of creep meanwhile")] = 1.0

    @property
    def longest(self):
        return self.period / 20

    def value(self, time, start):
        return start + self.amplitude * math.sin(2 * math.pi * time / self.period)

    def words(self, say):
        return f"{self.target} oscillates for {say('time', self.duration)}"


@dataclass(frozen=True)
class Squared(Leg):
    """The load rises like the square of time, to twice itself in one unit of time."""

    duration: Annotated[float, Gt(0), Quantity("how long it lasts", "s")]
    target = "load"

    def rises(self, start):
        return True

    def value(self, time, start):
        return start * (1 + time**2)

    @property
    def longest(self):
        return 0.05


TIMES = np.array([0.25, 0.5, 0.75, 1.0])
SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0)


def springs(**more):
    return asp.solids.spring_lattice(k0=1.0, k1=3.0, **more)


CHANGES: dict[str, Any] = {
    "load": lambda time: 6.0 * (1 + math.sin(8 * time) / 3),
    "separation": lambda time: 0.7 * (1 + math.sin(8 * time) / 3),
}


@pytest.mark.parametrize("solver", [Multigrid(), ActiveSet()], ids=["springs", "fields"])
@pytest.mark.parametrize(("target", "R_viscous"), [("load", 0.0), ("separation", 0.5)])
def test_oscillations_follow_the_explicit_algorithm(target, R_viscous, solver):
    value = CHANGES[target](0.0)
    how: dict[str, Any] = {target: value}
    contact = asp.press(uncorrelated(8), springs(R_viscous=R_viscous), **how)
    leg = Sine(1.0, value / 3, math.pi / 4, target)
    history = asp.age(contact, TIMES, protocol=leg, rtol=1e-4, fields_at=TIMES, solver=solver)
    assert_follows(history, second_order(CHANGES[target], target, R_viscous), contact.u.std())
    prescribed = value * (1 + np.sin(8 * np.append(0, TIMES)) / 3)
    if target == "load":
        np.testing.assert_allclose(history["load"], prescribed, rtol=1e-9)
    else:
        np.testing.assert_allclose(history["approach"], value - prescribed, atol=1e-12)


FLOWING = asp.solids.Eyring(rate=0.3, stress=0.5)


def test_a_law_creeps_under_a_load_that_oscillates():
    """All sites of a flat block touch: each carries its share of the load, which says how fast it creeps."""
    contact = asp.press(np.zeros((4, 4)), springs(R=0.0, creep=FLOWING), load=16.0)
    history = asp.age(contact, TIMES, protocol=Sine(1.0, 8.0, 0.5, "load"), rtol=1e-5)

    def velocity(time):
        return float(FLOWING.velocity(np.array([1 + np.sin(4 * np.pi * time) / 2]))[0][0])

    crept = [quad(velocity, 0, time, epsabs=1e-12)[0] for time in TIMES]
    elastic = (history["load"].values[1:] - 16.0) / 16 / 3.0
    np.testing.assert_allclose(history["approach"][1:], crept + elastic, rtol=1e-4)


def test_a_law_creeps_under_a_body_that_oscillates():
    contact = asp.press(np.zeros((4, 4)), springs(R=0.0, creep=FLOWING), separation=-0.8)
    history = asp.age(contact, TIMES, protocol=Sine(1.0, 0.02, 0.5, "approach"), rtol=1e-5)

    def rate(time, stress):  # of a spring and a dashpot in series that are compressed so fast
        pace = 0.08 * np.pi * np.cos(4 * np.pi * time)
        return 3.0 * (pace - FLOWING.velocity(stress)[0])

    stress = solve_ivp(rate, (0, 1), [2.4], t_eval=TIMES, rtol=1e-9, atol=1e-12, method="LSODA").y[0]
    np.testing.assert_allclose(history["load"][1:] / 16, stress, rtol=1e-4)


def test_the_exact_contact_follows_a_load_that_rises_as_it_likes():
    branches = [(0.4, 0.1), (0.3, 2.0)]
    solid = asp.solids.half_space(modulus=1.0, branches=branches)
    contact = asp.press(correlated(32), solid, load=20.0)
    exact, steps = (
        asp.age(contact, TIMES, protocol=Squared(1.0), exact=exact, rtol=1e-4) for exact in (True, False)
    )
    assert [one.dataset.attrs.get("exact_contact") for one in (exact, steps)] == ["at all times", None]
    for name in ("load", "mean_gap", "energy"):
        np.testing.assert_allclose(exact[name], steps[name], rtol=2e-3)
    np.testing.assert_allclose(exact["load"], 20 * (1 + np.append(0, TIMES) ** 2), rtol=1e-9)


@pytest.mark.parametrize(
    ("target", "solver"),
    [("load", None), ("pressure", ActiveSet()), ("separation", ActiveSet()), ("approach", None)],
)
def test_without_an_amplitude_it_is_a_hold(target, solver):
    contact = asp.press(correlated(16), springs(R_viscous=0.1), load=10.0)
    hold: Any = "separation" if target in ("separation", "approach") else "load"
    still, held = (
        asp.age(contact, TIMES, protocol=leg, rtol=1e-4, solver=solver)
        for leg in (Sine(2.0, 0.0, 10.0, target, mobility=3.0), Hold(2.0, hold=hold, mobility=3.0))
    )
    for name in ("area", "load", "separation", "energy"):
        np.testing.assert_allclose(still[name], held[name], rtol=2e-4)


def test_a_body_that_oscillates_touches_on_its_way():
    heights = uncorrelated(8)
    contact = asp.press(heights, SPRINGS, separation=float(heights.max()) + 0.5)
    history = asp.age(contact, np.linspace(0.1, 2, 20), protocol=Sine(2.0, 1.0, 2.0, "approach"))
    assert history.area.values[1] == 0
    assert (history.area.values[2:6] > 0).all()  # sin(0.2 pi) > 0.5


def test_a_history_with_such_a_leg_is_written():
    contact = asp.press(uncorrelated(16), SPRINGS, load=10.0)
    protocol = [Step(load=12.0), Repeat([Sine(1.0, 2.0, 0.5, mobility=2.0)], 2), Hold(1.0)]
    whole = asp.age(contact, [0.3, 1.3, 1.7], protocol=protocol)
    assert protocol_of(whole.dataset) == protocol
    assert [row.kind for row in leg_table(whole.dataset)] == ["step", "sine", "sine", "hold"]
    assert leg_of(described(protocol[1])) == protocol[1]
    assert "sine 1 amplitude=2 period=0.5 mobility=2" in in_words(map(described, protocol))


@dataclass(frozen=True)
class Late(Squared):
    """It does not begin where it is."""

    def value(self, time, start):
        return 2 * start


def test_what_cannot_be():
    contact = asp.press(uncorrelated(16), SPRINGS, load=10.0)
    each_refuses(
        ("amplitude", "-1.0", lambda: Sine(1.0, -1.0, 1.0)),
        ("target", "'area'", lambda: Sine(1.0, 1.0, 1.0, "area")),  # type: ignore[arg-type]
        ("load", "-", lambda: asp.age(contact, [1.0], protocol=Sine(1.0, 20.0, 1.0))),
        ("protocol", "20", lambda: asp.age(contact, [1.0], protocol=Late(1.0))),
        ("protocol", "'cosine'", lambda: leg_of({"kind": "cosine"})),
    )
