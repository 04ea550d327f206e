"""Sliding: shifts of the rough surface under a body whose crept shape stays with the body."""

import math
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.analysis.maps import on_the_surface
from asperity.contact import ActiveSet, Multigrid
from asperity.lattice import Lattice
from tests.continua import pressed
from tests.dense_reference import Dense
from tests.history_reference import assert_follows, second_order
from tests.surfaces import correlated, uncorrelated

P = asp.protocols
TIMES = (0.2, 0.4, 0.6, 0.8)
BRANCHES = [(0.6, 1.0), (0.2, 30.0)]
HALF_SPACE = asp.solids.half_space(modulus=2.0, branches=BRANCHES)


def springs(R_viscous=0.0):
    return asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0, R_viscous=R_viscous)


@pytest.fixture(scope="module", params=["springs", "half-space", "line", "held"])
def contact(request):
    if request.param == "line":
        return asp.press(correlated(8).ravel(), HALF_SPACE, load=4.0)
    if request.param == "half-space":
        return pressed(correlated(16)[:12], HALF_SPACE, load=8.0, spacing=(1.5, 0.5))
    start = asp.press(correlated(16), springs(), load=80.0)
    return start if request.param == "springs" else asp.press(start, separation=start.separation - 0.2)


def test_a_contact_that_has_not_crept_moves_as_it_is(contact):
    moved = contact
    for _ in range(contact.heights.shape[-1]):
        moved = asp.slide(moved, 1)
        assert moved.area == contact.area
    for name in ("heights", "u", "anchors", "force", "in_contact"):
        assert (getattr(moved, name) == getattr(contact, name)).all()
    assert (moved.separation, moved.load) == (contact.separation, contact.load)
    # Without a shift nothing changes.
    for shift in (0, [0.0] * contact.heights.ndim, contact.heights.shape[-1]):
        assert asp.slide(contact, shift) is contact


def test_the_crept_shape_stays_and_a_period_brings_the_contact_back(contact):
    old = asp.age(contact, [10.0]).final
    moved = asp.slide(old, 3)
    assert (moved.heights == np.roll(old.heights, 3, axis=-1)).all()
    shape, before = (one.anchors - one.anchors.mean() for one in (moved, old))
    np.testing.assert_allclose(shape, before, atol=1e-12)
    assert moved.area < old.area  # contacts leave the places that have crept
    back = asp.slide(moved, -3)
    assert back.area == old.area
    np.testing.assert_allclose(back.u, old.u, atol=1e-8)


def moved_by(time):
    slid = np.floor(time / 0.2 + 1e-9)
    return (0, int(np.clip(slid, 0, 2))) if time < 0.8 - 1e-9 else (1, 1)


HELD: dict[str, Any] = {"load": lambda _: 6.0, "separation": lambda _: 1.0}


@pytest.mark.parametrize("solver", [Multigrid(), ActiveSet()], ids=["springs", "fields"])
@pytest.mark.parametrize(("R_viscous", "held"), [(0.0, "load"), (0.5, "separation")])
def test_sliding_follows_the_explicit_algorithm(R_viscous, held, solver):
    contact = asp.press(uncorrelated(8), springs(R_viscous), **{held: HELD[held](0.0)})
    protocol = [
        P.Hold(0.2),
        P.Slide(2.0, velocity=5.0),
        P.Hold(0.2),
        P.Slide(math.sqrt(2), velocity=math.inf, direction=(1, -1)),
    ]
    history = asp.age(contact, TIMES, protocol=protocol, rtol=1e-4, fields_at=TIMES, solver=solver)
    after = assert_follows(
        history, second_order(HELD[held], held, R_viscous, TIMES, moved_by), contact.u.std()
    )
    assert after["field_shift_x"].values.tolist() == [1, 2, 2, 1]
    assert after["field_shift_y"].values.tolist() == [0, 0, 0, 1]


def test_a_half_space_slides_as_dense_matrices_say():
    spacing, heights = (1.5, 0.5), correlated(6)[:4]

    def part(share, time):
        return lambda q, _: share * q, lambda q, _: 1 / (share * time * np.where(q > 0, q, np.inf))

    dense = Dense.of_laws(heights, lambda q, _: 0.2 * q, [part(*branch) for branch in BRANCHES], spacing)
    anchors = np.zeros((2, heights.size))
    contact = pressed(heights, HALF_SPACE, load=3.0, spacing=spacing)
    protocol = [P.Hold(2.0), P.Slide(1.0, velocity=1.0), P.Slide(1.5, velocity=3.0, direction="-y")]
    history = asp.age(contact, [2.0], protocol=protocol, rtol=3e-4)
    dense.contact(anchors, load=3.0)
    anchors = dense.creep(anchors, 2.0, load_at=lambda _: 3.0)
    areas = []
    for shift, lapse in [((0, 1), 0.5), ((0, 2), 0.5), ((-1, 2), 0.5)]:
        dense.heights = np.roll(heights, shift, axis=(0, 1)).ravel()
        dense.contact(anchors, load=3.0)
        areas.append(dense.touching.sum())
        anchors = dense.creep(anchors, lapse, load_at=lambda _: 3.0)
        y, _, r = dense.contact(anchors, load=3.0)
        areas.append(dense.touching.sum())
    final = history.final
    assert history.area.values[2:].tolist() == areas
    np.testing.assert_allclose(final.u.ravel() - final.separation, y, atol=1e-3 * np.ptp(heights))
    np.testing.assert_allclose(final.force.ravel(), r * dense.touching, atol=2e-3)
    assert history["displacement"].values[-1] == 2.5
    assert history["velocity"].values[-1] == 3.0


def test_a_fraction_of_a_site_is_the_analytic_shift_of_each_wave():
    lattice = Lattice((12, 18))
    y, x = np.indices(lattice.shape)
    for ky, kx in ((0, 1), (3, 2), (-2, 8), (5, 0), (5, 8)):

        def wave(y, x, ky=ky, kx=kx):
            return np.cos(2 * np.pi * (ky * y / 12 + kx * x / 18) + 0.3)

        np.testing.assert_allclose(
            lattice.shifted(wave(y, x), (0.25, -0.7)), wave(y - 0.25, x + 0.7), atol=1e-13
        )
        np.testing.assert_allclose(lattice.shifted(wave(y, x), (2.5, 1.0)), wave(y - 2.5, x - 1), atol=1e-13)
    # The shortest wave of an even length: sites hold its cosine alone, and half a site away it vanishes.
    shortest = np.cos(np.pi * np.arange(8.0))
    np.testing.assert_allclose(Lattice((8,)).shifted(shortest, (0.5,)), 0, atol=1e-15)


def test_shifts_by_fractions_of_a_site_come_to_the_sites_exactly():
    contact = asp.press(uncorrelated(16), springs(), load=40.0)
    whole = asp.age(contact, [0.0], protocol=[P.Hold(1.0), P.Slide(3.0, velocity=math.inf)])
    thirds = asp.age(contact, [0.0], protocol=[P.Hold(1.0), P.Slide(3.0, velocity=math.inf, substeps=3)])
    assert (thirds.final.heights == whole.final.heights).all()
    assert thirds["displacement"].values[2:] == pytest.approx(np.arange(1, 10) / 3)
    assert thirds.area.values[-1] == whole.area.values[-1]
    np.testing.assert_allclose(thirds.final.u, whole.final.u, atol=1e-8)


def test_maps_are_drawn_where_the_rough_surface_was():
    contact = asp.press(uncorrelated(16), springs(), load=40.0)
    protocol = P.Slide(3.0, velocity=10.0, direction="-y")
    dataset = asp.age(contact, [0.3], protocol=protocol, fields_at=[0.0, 0.15, 0.3]).dataset
    placed = on_the_surface(dataset)
    for u, in_contact in zip(placed["u"].values, placed["in_contact"].values.astype(bool), strict=True):
        assert in_contact.any()
        np.testing.assert_array_equal(u[in_contact], dataset["heights"].values[in_contact])
        assert (u >= dataset["heights"].values).all()
