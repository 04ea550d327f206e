"""Threads: as many as the environment says, and the same digits for any number of them."""

import os
import subprocess
import sys

import numpy as np
import pytest
import scipy.fft

import asperity as asp
from asperity import lattice
from asperity.base.machine import cores, usual_threads


def test_threads_follow_the_environment(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert usual_threads() == 3
    monkeypatch.delenv("OMP_NUM_THREADS")
    assert usual_threads() == cores() >= 1


@pytest.mark.parametrize(
    ("shape", "solid"),
    [
        ((64, 64), asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])),
        ((65, 63), asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])),
    ],
)
def test_results_do_not_depend_on_the_number_of_threads(monkeypatch, shape, solid):
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


HISTORIES = """
import hashlib, numpy as np, asperity as asp
heights = np.random.default_rng(0).normal(size=(110, 100))
law = asp.solids.Eyring(rate=1.0, stress=1.0)
for k0, creep in ((1.0, law), (0.0, None)):
    solid = asp.solids.spring_lattice(k0=k0, k1=3.0, creep=creep)
    final = asp.age(asp.press(heights, solid, load=200.0), [0.1]).final
    print(hashlib.sha256(final.u.tobytes() + final.u0.tobytes()).hexdigest())
"""


@pytest.mark.skipif(cores() < 2, reason="needs two cores")
def test_libraries_with_threads_of_their_own_change_no_digit():
    # They take what the environment says as they are loaded, and share sums over more than 10,000 numbers.
    found = [
        subprocess.check_output(
            [sys.executable, "-c", HISTORIES], env=os.environ | {"OMP_NUM_THREADS": n}, text=True, timeout=120
        )
        for n in ("1", "2")
    ]
    assert found[0] == found[1]
