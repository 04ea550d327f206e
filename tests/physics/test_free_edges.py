"""Half-spaces with free edges beside dense matrices of Love's closed form, written here on their own."""

import math

import numpy as np
import pytest

import asperity as asp
from tests.continua import love
from tests.dense_reference import Dense
from tests.refusals import each_refuses

SHAPE, SMALL, SPACING = (13, 10), (7, 6), (1.0, 0.7)
LOAD = 0.6


def rough(shape=SHAPE, spacing=SPACING, rms=0.3, seed=3, edges="free"):
    heights = rms * np.random.default_rng(seed).normal(size=shape)
    return asp.surfaces.Surface(heights, pixel_size=spacing, edges=edges)


def compliance(shape=SHAPE, spacing=SPACING):
    """Displacement of each site by a unit force on each, E* = 1."""
    return love(shape, spacing) / math.prod(spacing)


def same(contact, position, force, rtol=1e-6):
    __tracebackhide__ = True
    force = force.reshape(contact.force.shape)
    np.testing.assert_array_equal(contact.in_contact, force > 1e-9 * force.max())
    np.testing.assert_allclose(contact.force, force, atol=rtol * force.max())
    assert contact.separation == pytest.approx(position, rel=rtol, abs=rtol)


def test_pressed_by_a_load_and_at_a_separation():
    surface, matrix = rough(), compliance() / 2.0
    solid = asp.solids.half_space(modulus=2.0)
    dense = Dense.of_compliance(surface.heights, matrix)
    _, position, force = dense.contact([], load=LOAD)
    force = force * dense.touching
    contact = asp.press(surface, solid, load=LOAD)
    same(contact, position, force)
    np.testing.assert_allclose(contact.u.ravel(), position + matrix @ force, atol=1e-8)
    assert contact.energy == pytest.approx(force @ matrix @ force / 2, rel=1e-8)
    assert contact.nominal_area == pytest.approx(13 * 10 * 0.7)
    touching = contact.in_contact.ravel()
    frozen = matrix[np.ix_(touching, touching)]
    assert contact.normal_stiffness == pytest.approx(np.linalg.inv(frozen).sum(), rel=1e-7)
    held = asp.press(surface, solid, separation=position)
    same(held, position, force)


@pytest.mark.parametrize("hold", ["load", "separation"])
def test_a_law_of_creep(hold):
    """Explicit small steps of the creep of each site, of first order, so in two runs."""
    surface, stress = rough(SMALL), 0.2
    law = asp.solids.Eyring(rate=0.02, stress=stress)
    solid = asp.solids.half_space(modulus=2.0, creep=law)
    start = asp.press(surface, solid, load=LOAD)
    final = asp.age(start, [1.0], hold=hold, rtol=1e-4).final
    dense = Dense.of_compliance(surface.heights, compliance(SMALL) / 2.0, [(1.0, np.inf)])
    ends = []
    for steps in (50, 100):
        shape, body = np.zeros(surface.heights.size), start.separation
        held = {"load": LOAD} if hold == "load" else {"position": body}
        for step in range(steps + 1):
            _, body, force = dense.contact([shape], **held)
            force = force * dense.touching
            if step < steps:
                shape = shape + 0.02 * np.sinh(force / 0.7 / stress) / steps
        ends.append(np.append(force, body))
    *force, position = 2 * ends[1] - ends[0]
    np.testing.assert_allclose(final.force.ravel(), force, atol=0.01 * np.max(force))
    assert final.separation == pytest.approx(position, abs=2e-3)


def test_a_saved_contact_ages_on(tmp_path):
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.3, 1.0), (0.3, 10.0)])
    aged = asp.age(asp.press(rough((24, 24)), solid, load=1.0), [1.0]).final
    aged.save(tmp_path / "contact.zarr")
    read = asp.results.load_contact(tmp_path / "contact.zarr", solid)
    np.testing.assert_array_equal(read.in_contact, aged.in_contact)
    np.testing.assert_allclose(read.force, aged.force, atol=1e-7 * aged.force.max())
    one, other = (asp.age(contact, [1.0, 10.0]).final for contact in (aged, read))
    np.testing.assert_array_equal(one.in_contact, other.in_contact)
    assert one.separation == pytest.approx(other.separation, rel=2e-3)


def test_nothing_joins_or_shines_beyond_the_edges():
    heights = np.full((24, 24), -5.0)
    heights[:2], heights[-2:] = 0.0, 0.0
    surface = asp.surfaces.Surface(heights, pixel_size=(1.0, 1.0), edges="free")
    contact = asp.press(surface, asp.solids.half_space(modulus=1.0), load=1.0)
    assert asp.analysis.patches(contact.in_contact, edges="free").sizes.tolist() == [48, 48]
    seen = asp.observe(contact, blur=2.0)
    assert seen.image.sum() < 0.85 * contact.area  # the rest falls beyond the edges
    mirrored = asp.observe(contact.in_contact, blur=2.0, edges="reflecting")
    assert mirrored.image.sum() == pytest.approx(contact.area, rel=1e-9)


HALF_SPACE = asp.solids.half_space
FLUID = HALF_SPACE(modulus=1.0, branches=[(1.0, 1.0)])
EYRING = asp.solids.Eyring(rate=1.0, stress=1.0)
UNENDING = [
    (asp.solids.spring_lattice(k0=1.0, k1=1.0, R=1.0), "edges"),
    (asp.solids.layer(modulus=1.0, poisson=0.3, thickness=3.0), "edges"),
    (HALF_SPACE(modulus=1.0, flow=(1.0, 0.0)), "edges"),
    (HALF_SPACE(modulus=1.0, apparatus=3.0), "apparatus"),
    (HALF_SPACE(modulus=1.0, permanent=0.3, creep=EYRING), "edges"),
]


def test_what_a_free_body_cannot_do():
    contact, square = asp.press(rough(), FLUID, load=LOAD), rough(spacing=(1.0, 1.0))
    line = asp.surfaces.Surface(contact.heights[0], edges="free")
    each_refuses(
        *((name, lambda solid=solid: asp.press(square, solid, load=LOAD)) for solid, name in UNENDING),
        ("edges", "a line contact", lambda: asp.press(line, FLUID, load=LOAD)),
        ("slide", lambda: asp.slide(contact, shift=(0, 1))),
        ("solid", asp.relax, contact),
    )
