"""Threads: the same digits for any number of them, a loop that fails in one, and no thread left behind."""

import gc
import threading
import time

import numpy as np
import pytest
import scipy.fft

import asperity as asp
from asperity import lattice
from asperity.contact.multigrid import loops, processor
from asperity.contact.multigrid import team as module
from asperity.contact.multigrid.team import Team
from asperity.threads import cores, usual_threads


def test_threads_follow_the_environment(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert usual_threads() == 3
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert usual_threads() == cores() >= 1


@pytest.mark.parametrize(
    ("shape", "solid"),
    [
        ((300, 250), asp.solids.spring_lattice(k0=1.0, k1=3.0)),
        ((301, 249), asp.solids.spring_lattice(k0=1.0, k1=3.0)),
        ((64, 64), asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])),
    ],
)
def test_results_do_not_depend_on_the_number_of_threads(monkeypatch, shape, solid):
    monkeypatch.setattr(processor, "_WORTH_SHARING", 2**10)
    monkeypatch.setattr(lattice, "_WORTH_SHARING", 2**10)
    workers, transform = set(), scipy.fft.rfftn

    def counted(*args, **options):
        workers.add(options["workers"])
        return transform(*args, **options)

    monkeypatch.setattr(scipy.fft, "rfftn", counted)
    heights = np.random.default_rng(0).normal(size=shape)
    found = []
    for n in ("1", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", n)
        contact = asp.press(heights, solid, load=0.02 * heights.size)
        found.append(np.array([contact.u, asp.age(contact, [1.0]).final.u0]))
    np.testing.assert_array_equal(found[0], found[1])
    assert workers == {1, 3}


def shares(size):
    """Rows of numbers, and the arguments with which so many threads add them up."""
    numbers = np.random.default_rng(0).normal(size=(100 * size, 2, 5)).astype(np.float32)
    sums = np.zeros((len(numbers), 7))
    return [(numbers, 8, sums, 100 * n, 100 * n + 100) for n in range(size)], sums


@pytest.mark.parametrize("size", [2, 5])
def test_every_thread_does_its_share(size):
    team, (calls, sums) = Team(size), shares(size)
    for rest in (0.0, 0.0, 0.05, 0.0):  # threads that are awake, and that sleep
        time.sleep(rest)
        sums[:] = 0.0
        team.do(loops.total, calls)
        expected = np.zeros_like(sums)
        loops.total(calls[0][0], 8, expected, 0, len(expected))
        np.testing.assert_array_equal(sums, expected)
        team.do(loops.total, calls[:2])


def test_what_fails_in_a_thread_is_raised_where_it_was_called():
    team, (calls, _) = Team(3), shares(3)

    def failing(*arguments):
        if arguments[3] == 100:
            raise MemoryError("no more of it")
        loops.total(*arguments)

    with pytest.raises(MemoryError, match="no more"):
        team.do(failing, calls)
    team.do(loops.total, calls)


def test_a_thread_does_not_wait_at_a_gate_for_one_that_failed():
    team, (calls, _) = Team(2), shares(2)
    gate, sites = team.gate(2), loops.Sites(32, 32, False)
    e, bound, b = (np.zeros((32, 2, 17), np.float32) for _ in range(3))
    one = np.float32(1.0)
    equation = loops.One(e, bound, b, one, one, one, sites)

    def failing(*arguments):
        if arguments[-2] == 16:
            raise MemoryError("no more of it")
        loops.sweeps_1(*arguments)

    with pytest.raises(MemoryError, match="no more"):
        team.do(failing, [(equation, 2, gate, 0, 16), (equation, 2, gate, 16, 32)])
    team.do(loops.total, calls)


@pytest.mark.parametrize("name", ["call", "announce"])
def test_an_interrupt_leaves_a_team_that_works(monkeypatch, name):
    team, (calls, sums) = Team(3), shares(3)
    usual, caller = getattr(module, name), threading.current_thread()

    def interrupted(*arguments):
        usual(*arguments)
        if threading.current_thread() is caller:
            raise KeyboardInterrupt

    def failing(*arguments):
        if arguments[3] == 0:
            raise KeyboardInterrupt
        loops.total(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(module, name, interrupted)
        with pytest.raises(KeyboardInterrupt):
            team.do(failing, calls)
    sums[:] = 0.0
    team.do(loops.total, calls)
    assert np.count_nonzero(sums[:, 0]) == len(sums)


def test_threads_end_with_their_team():
    before = set(threading.enumerate())
    team = Team(4)
    team.do(loops.total, shares(4)[0])
    threads = set(threading.enumerate()) - before
    assert len(threads) == 3
    del team
    gc.collect()
    for thread in threads:
        thread.join(timeout=10.0)
        assert not thread.is_alive()
