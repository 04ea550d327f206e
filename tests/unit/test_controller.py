"""The length of time steps, by errors alone: no contact is needed to test it."""

import math

import pytest

from asperity.aging.controller import TUNING, Controller, step_tolerance


def run(error_of, stop, length):
    """Follow errors of steps to a time; all lengths that were taken."""
    controller, time, taken = Controller(step_tolerance(2e-3), length), 0.0, []
    while time < stop:
        step = controller.step(time, stop)
        assert not controller.is_stuck(time, step)
        if controller.accepts(step, error_of(time, step)):
            time = stop if step == stop - time else time + step
            taken.append(step)
    return taken


def test_a_cubic_error_leads_to_the_length_that_is_allowed():
    taken = run(lambda _, length: (length / 0.02) ** 3, 1.0, 1e-6)
    assert max(taken) <= 0.02
    assert taken[-5:-2] == pytest.approx([0.018] * 3, rel=0.06)


def test_a_step_too_long_is_shortened_by_its_error_and_at_most_to_a_fifth():
    controller = Controller(1e-3, 1.0)
    assert not controller.accepts(1.0, 8.0)
    assert controller.length == pytest.approx(0.45)
    assert not controller.accepts(0.45, math.inf)
    assert controller.length == pytest.approx(0.09)
    assert controller.unsolved == 1
    assert controller.accepts(0.09, 0.0)
    assert controller.length == pytest.approx(0.36)


def test_a_stop_is_met_by_two_even_steps_rather_than_by_a_long_and_a_short_one():
    controller = Controller(1e-3, 0.7)
    assert controller.step(0.0, 1.0) == 0.5
    assert controller.step(0.5, 1.0) == 0.5
    assert controller.step(0.0, 10.0) == 0.7
    assert controller.step(0.0, 10.0, longest=0.1) == 0.1
    # A short one to a stop shortens the next no more than it must.
    assert controller.step(0.0, 0.1) == 0.1
    assert controller.accepts(0.1, 0.0)
    assert controller.length == pytest.approx(0.4)


def test_it_tells_when_it_is_stuck_and_starts_over_where_it_was():
    controller = Controller(1e-3, 0.5)
    for _ in range(TUNING.most_unsolved + 1):
        assert not controller.is_stuck(1.0, controller.length)
        controller.accepts(controller.length, math.inf)
    assert controller.is_stuck(1.0, controller.length)
    controller.start_over(1.0)
    assert controller.length == 0.5
    assert not controller.is_stuck(1.0, 0.5)
    assert controller.is_stuck(1.0, 1e-17)
