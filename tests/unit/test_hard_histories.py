"""Histories at the edge of what numbers can hold: an answer, or one clear line, in bounded time."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.aging import controller
from asperity.contact import ActiveSet
from asperity.contact.problem import PUBLISHED, Guess
from asperity.errors import ConvergenceError
from tests.refusals import each_refuses, refuses

SOLID: dict[str, Any] = {"k0": 1.0, "k1": 3.0}


def heights(shape, seed, kind="white"):
    rough = np.random.default_rng(seed).normal(size=shape)
    if kind == "stepped":
        return np.round(rough)
    if kind == "smooth":
        modes = np.fft.rfft2(rough)
        qy, qx = np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])
        rough = np.fft.irfft2(modes / (0.01 + qy**2 + qx**2), s=shape)
        return rough / rough.std()
    return rough


def spike(shape, seed):
    rough = 1e-3 * heights(shape, seed)
    rough[3, 4] = 5.0
    return rough


@pytest.mark.slow
@pytest.mark.parametrize("rough", [2.58 * spike((24, 25), 3), 67.0 * heights((24, 25), 4, "stepped")])
def test_a_held_load_never_loses_contact(rough):
    solid = asp.solids.spring_lattice(k0=1.6e-3, k1=9.63, R=153.0, R_viscous=2.6e-4)
    contact = asp.press(rough, solid, load=0.372)
    history = asp.age(contact, [1e-3, 1.0, 1e6])
    areas = history.dataset["area"].values
    assert areas[0] >= 1
    assert areas[-1] > areas[0]
    np.testing.assert_allclose(history.dataset["load"], 0.372, rtol=1e-8)
    assert areas[-1] == pytest.approx(asp.relax(contact).area, rel=0.02, abs=1)


@pytest.mark.parametrize(("seed", "kind"), [(46, "stepped"), (51, "smooth")])
def test_cycles_that_diverge_warn_nobody(seed, kind):  # a warning is an error here
    rough = heights((14, 28), seed, kind)
    solid = asp.solids.spring_lattice(k0=2630.0, k1=0.907, R=948.0)
    contact = asp.press(rough, solid, separation=float(rough.max()) - 0.01)
    history = asp.age(contact, [1e4, 1e7, 1.6e13])
    assert history.dataset["load"].values[-1] > 0


def pressed(shape=(16, 16), **mobilities):
    return asp.press(heights(shape, 0), asp.solids.spring_lattice(**SOLID, **mobilities), load=10.0)


@pytest.mark.parametrize(
    ("mobilities", "times"),
    [
        ({"R": 1e100}, [1.0, 10.0]),
        ({"R_viscous": 1e100}, [1.0, 10.0]),
        ({"R": 1e60}, [1.0, 10.0]),
        ({}, [1e-10, 1e100]),
        ({}, [1e-100, 1e100]),
    ],
)
def test_times_beyond_all_creep_are_refused(mobilities, times):
    for contact in (pressed(**mobilities), pressed((16,), **mobilities)):
        holds: list[Any] = [None, "separation"]
        each_refuses(*(("times", partial(asp.age, hold=hold), contact, times) for hold in holds))
        assert asp.relax(contact).area > contact.area


def test_what_leads_nowhere_is_refused(monkeypatch):
    with refuses("solid", "2.4e+41"):
        asp.age(pressed(R=1e40), [1e-30])
    contact = pressed()
    step = contact.system().mechanics.implicit_step(1.0)
    problem = contact.system().problem(step, np.full((1, 16, 16), np.nan))
    with refuses(kind=ConvergenceError):
        ActiveSet().solve(problem, Guess(contact.u, contact.in_contact), PUBLISHED)
    monkeypatch.setattr(controller, "TUNING", replace(controller.TUNING, most_steps=0.02))
    with refuses(kind=ConvergenceError):
        asp.age(contact, [1.0], rtol=1e-5)


@pytest.mark.parametrize("shape", [(16, 16), (16,)])
def test_the_widest_times_that_are_taken(shape):
    contact = pressed(shape)
    history = asp.age(contact, [1e-29, 1e-3, 1e28])
    assert history.final.area == pytest.approx(asp.relax(contact).area, abs=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "solid", "control", "last", "limit"),
    [
        ((16, 26), {"k0": 0.0, "k1": 1.0}, {"load": 0.7}, 1e6, 250),
        ((23, 60), {"k0": 1.0, "k1": 137.0}, {"separation": -0.6}, 1e6, 250),
        ((120,), {"k0": 0.0, "k1": 1.0}, {"load": 0.1}, 1e6, 600),  # errors in contact count as a mean
    ],
)
def test_steps_stay_few_where_a_front_of_contacts_moves(shape, solid, control, last, limit):
    """A paraboloid of rms height 1, whose contact grows or shrinks site by site."""
    axes = np.meshgrid(*(np.arange(n) - n // 2 for n in shape), indexing="ij")
    ball = -sum(axis.astype(float) ** 2 for axis in axes)
    contact = asp.press(ball / ball.std(), asp.solids.spring_lattice(**solid), **control)
    times = np.geomspace(1e-3, last, 10)
    history = asp.age(contact, times)
    assert (history.dataset["steps"] + history.dataset["rejected"]).max() < limit
    finer = asp.age(contact, times, rtol=2e-4)
    areas, exact = (one.dataset["area"].values.astype(float) for one in (history, finer))
    np.testing.assert_allclose(areas, exact, atol=0.01 * exact.max())


def test_the_scale_of_the_residual_is_told():
    contact = pressed(R_viscous=0.1)
    history = asp.age(contact, [1.0, 1e3, 1e6], hold="separation")
    data = history.dataset
    area, load, scale = (data[name].values for name in ("area", "load", "residual_scale"))
    assert scale[0] == pytest.approx(10.0 / contact.area)
    assert scale[1] == pytest.approx(load[1] / area[1])
    assert scale[-1] > load[-1] / max(area[-1], 1)  # the load has died out
    assert 0 < scale[-1] < 1e-5 * scale[0]
