"""What an instrument sees: against the map itself, sums by hand, and a blurred disc in closed form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray as xr

import asperity as asp
from tests.refusals import refuses


def brightness(shape):
    return np.random.default_rng(0).random(shape)


@pytest.fixture(scope="module")
def contact():
    heights = 1e-6 * asp.surfaces.gaussian((24, 32), seed=1)
    scan = asp.surfaces.Surface(
        heights, unit="m", pixel_size=(2e-6, 1e-6), length_unit="m", edges="reflecting"
    )
    return asp.press(scan, asp.solids.half_space(modulus=1e9), pressure=3e7)


@pytest.mark.parametrize("edges", ["periodic", "reflecting"])
def test_a_sharp_eye_sees_the_sites_themselves(edges):
    touching = brightness((7, 12)) < 0.3
    seen = asp.observe(touching, threshold=0.5, edges=edges)
    np.testing.assert_allclose(seen.image, touching, atol=1e-14)
    np.testing.assert_array_equal(seen.seen, touching)
    assert seen.area == np.count_nonzero(touching)
    assert seen.fraction == touching.mean()
    ours, known = seen.patches, asp.analysis.patches(touching, edges=edges)
    np.testing.assert_array_equal(ours.sizes, known.sizes)


@pytest.mark.parametrize(
    ("pixel", "blur", "edges"), [(0.5, 0.3, "periodic"), (1.5, 2.0, "reflecting"), (6.0, 6.0, "reflecting")]
)
def test_pixels_that_tile_the_surface_see_all_of_its_light(pixel, blur, edges):
    light = brightness((6, 12))
    seen = asp.observe(light, pixel=pixel, blur=blur, edges=edges)
    assert seen.image.shape == (round(6 / pixel), round(12 / pixel))
    assert seen.area == pytest.approx(light.sum(), rel=1e-12)
    assert seen.image.min() >= light.min() - 1e-12
    assert seen.image.max() <= light.max() + 1e-12


def test_a_pixel_is_the_mean_of_what_it_covers():
    light = brightness((10, 7))
    seen = asp.observe(light, pixel=2.5)
    assert seen.image.shape == (4, 2)  # two sites of the last axis are not seen
    part = np.array([1.0, 1.0, 0.5, 0, 0, 0, 0])
    columns = [part, np.array([0, 0, 0.5, 1.0, 1.0, 0, 0])]
    row = np.append(part, [0, 0, 0])
    np.testing.assert_allclose(seen.image[0], [row @ light @ column / 6.25 for column in columns])


def test_edges_are_seen_through_and_show_what_lies_beyond():
    light = brightness((9, 8))
    ours, moved = (asp.observe(one, blur=3.0).image for one in (light, np.roll(light, (4, 3), (0, 1))))
    np.testing.assert_allclose(np.roll(ours, (4, 3), (0, 1)), moved, rtol=1e-12)
    doubled = np.block([[light, light[:, ::-1]], [light[::-1], light[::-1, ::-1]]])
    alone = asp.observe(light, pixel=1.0, blur=5.0, edges="reflecting", threshold=0.5)
    images = asp.observe(doubled, pixel=1.0, blur=5.0, threshold=0.5)
    np.testing.assert_allclose(images.image[:9, :8], alone.image, rtol=1e-12)
    assert images.area == 4 * alone.area


@pytest.mark.parametrize("width", [12.0, 40.0])
def test_a_blurred_disc(width):
    # A point of the disc's image: the probability that a normal vector around it ends within the disc.
    n, radius, deviation = 160, 24.0, width / (2 * math.sqrt(2 * math.log(2)))
    place = np.arange(n) + 0.5 - n / 2
    distance = np.hypot(place[:, None], place)
    seen = asp.observe(distance < radius, blur=width, threshold=0.5)
    exact = scipy.stats.ncx2.cdf((radius / deviation) ** 2, 2, (distance / deviation) ** 2)
    # The edge of the disc runs along sites: the wider the blur, the less it matters.
    np.testing.assert_allclose(seen.image, exact, atol=0.15 / width)
    assert seen.area == pytest.approx(np.count_nonzero(exact > 0.5), rel=0.01)
    assert seen.patches.count == 1


def test_lengths_are_those_of_the_contact(contact):
    itself = asp.observe(contact, threshold=0.5)
    assert itself.spacing == (2e-6, 1e-6)
    assert itself.area == pytest.approx(contact.contact_area, rel=1e-12)
    assert itself.edges == "reflecting"
    written, counted = (
        asp.observe(contact, pixel=pixel, blur=blur, threshold=0.5)
        for pixel, blur in (("4 um", "3000 nm"), (4e-6, 3e-6))
    )
    assert written.image.shape == (12, 8)
    np.testing.assert_array_equal(written.image, counted.image)
    assert written.area == pytest.approx(np.sum(written.image >= 0.5) * 16e-12)


def test_a_dataset_is_seen_as_the_contact(contact):
    history = asp.age(contact, [1.0], fields_at=[0.0, 1.0])
    at_first = history.dataset.isel(field_time=0)
    ours, theirs = (asp.observe(image, blur="2um") for image in (at_first, contact))
    np.testing.assert_array_equal(ours.image, theirs.image)
    assert ours.spacing == theirs.spacing
    with refuses("image"):
        asp.observe(history.dataset)
    with refuses("image"):
        asp.observe(xr.Dataset())


def test_a_profile_is_seen_too():
    seen = asp.observe([0.0, 1.0, 1.0, 0.0], pixel=2.0, threshold=0.6)
    np.testing.assert_allclose(seen.image, [0.5, 0.5])
    assert seen.area == 0


def test_what_cannot_be_seen(contact):
    touching = brightness((6, 8)) < 0.5
    refused: list[tuple[Any, str, Any]] = [
        *((touching, "pixel", value) for value in (7.0, "1 um")),
        *((touching, name, value) for name, value in (("blur", -1.0), ("edges", "open"))),
        *((contact, name, value) for name, value in (("pixel", "1 MPa"), ("spacing", 1.0))),
    ]
    for image, name, value in refused:
        with refuses(name):
            asp.observe(image, **{name: value})
    with refuses("patches"):
        assert asp.observe(touching).patches
