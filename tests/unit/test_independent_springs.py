"""Springs that no others join (k0 = 0) on maps: against closed forms and the Fourier solver."""

import numpy as np
import pytest

import asperity as asp
from asperity.aging import creep
from asperity.contact.multigrid import Multigrid
from tests.surfaces import correlated


@pytest.mark.parametrize(
    ("control", "last"), [({"load": 2e4}, 1e6), ({"load": 2e4}, 1e28), ({"separation": -20.0}, 1e18)]
)
def test_springs_that_all_touch_end_up_alike(control, last):
    contact = asp.press(correlated(24, seed=8), asp.solids.spring_lattice(k0=0.0, k1=1.5, R=1.0), **control)
    assert contact.in_contact.all()
    final = asp.age(contact, [1e-3 * last, last]).final
    np.testing.assert_allclose(final.force, contact.force.mean(), rtol=1e-3)
    assert final.load == pytest.approx(contact.load, rel=1e-3)  # creep on no base keeps the mean


@pytest.mark.parametrize(
    ("edges", "control", "mobilities"),
    [
        ("reflecting", {"load": 12.0}, (1.0, 0.0)),
        ("periodic", {"load": 12.0}, (0.0, 1.0)),
        ("periodic", {"separation": 1.2}, (1.0, 0.2)),
    ],
)
def test_histories_are_those_of_the_fourier_solver(edges, control, mobilities):
    rough = asp.surfaces.Surface(np.random.default_rng(2).normal(size=(16, 15)), edges=edges)
    solid = asp.solids.spring_lattice(k0=0.0, k1=2.0, R=mobilities[0], R_viscous=mobilities[1])
    contact, times = asp.press(rough, solid, **control), np.geomspace(1e-2, 1e3, 6)
    found, other = (
        list(creep(contact, times, rtol=2e-4, solver=solver)) for solver in (Multigrid(), asp.ActiveSet())
    )
    scale = 0.0
    for one, two in zip(found, other, strict=True):
        assert one.contact.residual < 1e-9
        if two.contact.load > 1e-3 * contact.load:  # less dies out
            assert np.count_nonzero(one.contact.in_contact ^ two.contact.in_contact) <= 2
        scale = max(scale, float(two.contact.u.std()))
        error = one.contact.anchors - two.contact.anchors
        assert (error - error.mean()).std() < 2e-4 * scale
        assert one.contact.load == pytest.approx(two.contact.load, abs=1e-3 * contact.load)


def test_nine_decades_take_few_cycles():
    heights = np.random.default_rng(6).normal(size=(64, 64))
    contact = asp.press(heights, asp.solids.spring_lattice(k0=0.0, k1=3.0), load=0.06 * heights.size)
    history = asp.age(contact, np.geomspace(1e-3, 1e6, 37)).dataset
    assert history["area"].values[-1] == heights.size
    steps = int((history["steps"] + history["rejected"]).sum())
    assert steps < 175  # 148
    assert int(history["iterations"].sum()) < 14 * steps  # 12
