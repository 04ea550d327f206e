"""What a contact carries besides its load: current, heat, and shear; beside closed forms."""

import math
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.errors import Remark
from tests.refusals import each_refuses

PIXEL, SITES = 1 / 256, 200
RADIUS, A = 8.0, 64 / 256
LOAD = 4 / 3 * A**3 / RADIUS  # Hertz: the contact has the radius A under E* = 1
MU, NU = 0.4, 0.3
RATIO = 2 * (1 - NU) / (2 - NU)
SOLID = asp.solids.half_space(modulus=1.0)


def squares(shape=(SITES, SITES), at=(0.5, 0.5), pixel=PIXEL):
    y, x = ((np.arange(n) - part * n + 0.5) * pixel for n, part in zip(shape, at, strict=True))
    return y[:, np.newaxis] ** 2 + x**2


def free(heights, pixel=PIXEL):
    return asp.surfaces.Surface(heights, pixel_size=(pixel, pixel), edges="free")


@pytest.fixture(scope="module")
def hertz():
    """A sphere whose contact is 64 sites in radius."""
    return asp.press(free(-squares() / (2 * RADIUS)), SOLID, load=LOAD)


def test_one_disc_has_the_resistance_of_holm(hertz):
    """R. Holm, *Electric Contacts* (1967): (rho_1 + rho_2) / (4 a)."""
    assert hertz.normal_stiffness == pytest.approx(2 * A, rel=2e-3)
    assert hertz.resistance(3.0) == pytest.approx(3.0 / (2 * A), rel=5e-3)
    assert hertz.resistance((1.0, 5.0)) == pytest.approx(hertz.resistance(3.0), rel=1e-12)
    assert hertz.thermal_resistance((1.0, 1 / 5)) == pytest.approx(hertz.resistance(3.0), rel=1e-12)
    assert hertz.tangential_stiffness(NU) == pytest.approx(RATIO * 2 * A, rel=2e-3)


@pytest.mark.parametrize("apparatus", ["1e9 N/m", "1e6 N/m", "1 N/m"])
def test_current_and_heat_do_not_pass_the_apparatus(apparatus):
    """It is in series with the normal stiffness; its own is known, and spreads no band."""
    how = {"hurst": 0.8, "roll_off": 4.0, "cutoff": 2.0, "rms_height": 0.02, "pixel_size": 1.0}
    scan = asp.surfaces.spectral((32, 32), **how, unit="um", seed=1)
    carried, ends = asp.Carried(resistivity=1e-6, conductivity=0.2), ("", "_low", "_high")
    spans: dict[str, Any] = {"pressure": "1 MPa", "first": 1.0, "last": 10.0, "per_decade": 4}
    found = []
    for one in (None, apparatus):
        solid = asp.solids.half_space(young="3 GPa", poisson=0.3, apparatus=one, branches=[(0.5, 1.0)])
        found.append(asp.predict(solid, scan, **spans, carried=carried).dataset)
    alone, beside = found
    for name in ("resistance", "resistance_low", "resistance_high", "thermal_resistance"):
        np.testing.assert_allclose(beside[name], alone[name], rtol=1e-7)
    assert alone["normal_stiffness_low"].notnull().all()
    for end in ends:
        name, spring = f"normal_stiffness{end}", beside.attrs["apparatus"]
        np.testing.assert_allclose(beside[name], 1 / (1 / alone[name] + 1 / spring), rtol=2e-4)


def test_far_discs_conduct_side_by_side():
    """Conductances add, but for an influence of a / (pi d) of each on the other (J. A. Greenwood, 1966)."""
    shape, a = (64, 512), 12 * PIXEL
    discs = [np.where(squares(shape, (0.5, part)) <= a**2, 0.0, -1.0) for part in (0.125, 0.875)]
    one = asp.press(free(discs[0]), SOLID, load=1e-3)
    both = asp.press(free(np.maximum(*discs)), SOLID, load=2e-3)
    apart = 0.75 * shape[1] * PIXEL
    radius = 1 / (2 * one.resistance(1.0))
    expected = one.resistance(1.0) / 2 + 1 / (2 * math.pi * apart)
    assert both.resistance(1.0) == pytest.approx(expected, rel=2e-3)
    assert radius == pytest.approx(a, rel=0.02)


@pytest.mark.parametrize("part", [0.3, 0.95])
def test_a_sheared_sphere_sticks_and_gives_way_as_cattaneo_and_mindlin_say(hertz, part):
    """R. D. Mindlin, J. Appl. Mech. 16, 259 (1949): c / a = (1 - Q / (mu P))^(1/3)."""
    shear = part * MU * hertz.load
    slip = hertz.partial_slip(shear, MU, NU)
    radius = A * (1 - part) ** (1 / 3)
    assert math.sqrt(np.count_nonzero(slip.stick) / math.pi) == pytest.approx(radius / PIXEL, abs=1)
    assert not (slip.stick & slip.slip).any()
    np.testing.assert_array_equal(slip.stick | slip.slip, hertz.in_contact)
    assert slip.stick_fraction == pytest.approx((radius / A) ** 2, rel=0.02)
    way = MU / RATIO * A**2 / RADIUS * (1 - (1 - part) ** (2 / 3))
    assert slip.displacement == pytest.approx(way, rel=1e-3)
    assert slip.stiffness == pytest.approx(RATIO * 2 * radius, rel=2e-3)
    assert slip.traction.sum() * PIXEL**2 == pytest.approx(shear, rel=1e-6)
    np.testing.assert_allclose(slip.traction[slip.slip], MU * hertz.pressure[slip.slip], rtol=1e-12)


@pytest.mark.parametrize(
    ("part", "tolerance"),
    [(0.05, 0.05), (0.1, 0.02), (0.3, 2e-3), (0.7, 1e-3), (0.99, 1e-3), (1 - 1e-12, 1e-3)],
)
def test_a_cycle_loses_what_mindlin_and_deresiewicz_say(hertz, part, tolerance):
    """R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20, 327 (1953), DOI 10.1115/1.4010702.

    At a part of 0.05 the annulus that slips is one site wide, and of two large numbers the loss is 1e-5.
    """
    slip, rest = hertz.partial_slip(part * MU * hertz.load, MU, NU), 1 - part
    lost = 1 - rest ** (5 / 3) - 5 * part / 6 * (1 + rest ** (2 / 3))
    scale = 24 * MU**2 * LOAD**2 / 5 * A**2 / (RADIUS * LOAD * RATIO)
    assert slip.energy_lost == pytest.approx(scale * lost, rel=tolerance)


@pytest.fixture(scope="module")
def rough():
    """An aged contact of 66 sites."""
    heights = asp.surfaces.spectral((24, 24), hurst=0.8, roll_off=12.0, cutoff=4.0, seed=2, rms_height=0.1)
    solid = asp.solids.half_space(modulus=1.0, branches=[(0.5, 1.0)])
    return asp.age(asp.press(free(heights, 1.0), solid, load=1.0), [2.0]).final


def test_a_cycle_loses_the_area_of_its_loop(rough):
    """By Masing's rule 4 Q delta(Q) less 8 times the integral of delta, which has kinks: by short parts."""
    shear, count = 0.5 * MU * rough.load, 60
    at = (np.arange(count) + 0.5) / count * shear
    integral = shear * np.mean([rough.partial_slip(force, MU, NU).displacement for force in at])
    slip = rough.partial_slip(shear, MU, NU)
    assert slip.energy_lost == pytest.approx(4 * shear * slip.displacement - 8 * integral, rel=2e-3)
    losses = [rough.partial_slip(part * shear, MU, NU).energy_lost for part in np.logspace(-6, 0, 13)]
    assert losses[0] == 0  # no site slips yet
    assert (np.diff(losses) >= 0).all()


def test_nothing_sticks_until_a_ramp_carries_the_shear_force():
    """On an elastic half-space the state at each load is that of the load alone."""
    heights = np.random.default_rng(3).normal(size=(16, 16))
    surface, load, shear = free(heights, 1.0), 20.0, 1.0
    carried = asp.Carried(shear=shear, friction_coefficient=MU)
    times = [0.1, 0.12, 0.13, 0.5, 1.0, 2.0]  # shear / (MU load) is 0.125
    legs = [asp.protocols.Ramp(1.0, load=load), asp.protocols.Hold(1.0)]
    with pytest.warns(Remark, match="the bodies slide at 3 of 7 recorded times"):
        series = asp.age(asp.press(surface, SOLID, load=0.0), times, protocol=legs, carried=carried).dataset
    now, stuck = (
        [asp.press(surface, SOLID, load=max(load * min(t, 1.0) - less, 1e-6)).area for t in times]
        for less in (0.0, shear / MU)
    )
    expected = np.array(stuck) / now * [0, 0, 1, 1, 1, 1]
    np.testing.assert_array_equal(series["stick_fraction"], [0.0, *expected])


def test_units_are_read():
    surface = asp.surfaces.sphere((64, 64), radius="1 mm", pixel_size="1 um")
    contact = asp.press(surface, asp.solids.half_space(modulus="3 GPa"), load="1 mN")
    assert contact.resistance("17 nOhm m") == pytest.approx(contact.resistance(17e-9), rel=1e-12)
    assert contact.thermal_resistance(("200 mW/m/K", 400.0)) == contact.thermal_resistance((0.2, 400.0))
    assert contact.partial_slip("0.2 mN", MU).shear == pytest.approx(2e-4)


def test_what_cannot_be_told(hertz):
    heights = np.random.default_rng(0).normal(size=(16, 16))
    on_springs = asp.press(heights, asp.solids.spring_lattice(k0=1.0, k1=1.0), load=5.0)
    layer = asp.press(heights, asp.solids.layer(modulus=1.0, poisson=0.3, thickness=3.0), load=5.0)
    each_refuses(
        *(("resistivity", wrong, hertz.resistance, wrong) for wrong in (0.0, (1.0, 2.0, 3.0))),
        ("units", "17 nOhm m", hertz.resistance, "17 nOhm m"),
        ("shear", "0.00104167", lambda: hertz.partial_slip(MU * hertz.load, MU, NU)),
        ("friction", "0.0", lambda: hertz.partial_slip(0.1 * LOAD, 0.0)),
        ("poisson", "none", lambda: hertz.partial_slip(0.1 * LOAD, MU).stiffness),
        ("resistance", "a spring lattice", lambda: on_springs.resistance(1.0)),
        ("resistance", "a layer", lambda: layer.thermal_resistance(1.0)),
        ("partial_slip", "a layer", lambda: layer.partial_slip(0.1, MU)),
        ("tangential_stiffness", "a spring lattice", lambda: on_springs.tangential_stiffness(NU)),
    )
