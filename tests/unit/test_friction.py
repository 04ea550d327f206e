"""Tabor's relation on datasets of histories."""

import numpy as np
import pytest

import asperity as asp
from asperity.friction import ShearStrength, add_friction
from asperity.protocols import Hold, Slide
from tests.refusals import refuses
from tests.surfaces import correlated

SOLID = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CONTACT = asp.press(correlated(16), SOLID, load=60.0)
PROTOCOL = [Hold(1.0), Slide(2.0, velocity=1.0), Hold(1.0), Slide(2.0, velocity=10.0), Hold(1.0)]
DATASET = asp.age(CONTACT, [0.5, 1.0], protocol=PROTOCOL).dataset


def test_friction_is_strength_times_area():
    found = add_friction(DATASET, 4.0)
    expected = 4.0 * DATASET["area"] / DATASET["load"]
    np.testing.assert_allclose(found["friction"], expected, rtol=1e-14)
    np.testing.assert_allclose(found["friction_force"], 4.0 * DATASET["area"], rtol=1e-14)
    assert found["friction_force"].attrs["units"] == DATASET["load"].attrs["units"]
    assert found.attrs["shear_strength"] == 4.0
    assert "friction" not in DATASET


def test_a_half_space_has_the_friction_of_a_prediction():
    surface = asp.surfaces.Surface(correlated(16), unit="um", pixel_size=(1.0, 1.0), length_unit="um")
    solid = asp.solids.half_space(modulus=1e9, branches=[(0.5, 1.0)])
    dataset = asp.age(asp.press(surface, solid, pressure="10 MPa"), [1.0]).dataset
    found = add_friction(dataset, "40 MPa")
    expected = asp.theory.static_friction(dataset["contact_area_corrected"], dataset["load"], 4e7)
    np.testing.assert_allclose(found["friction"], expected, rtol=1e-14)
    assert found["friction_force"].attrs["units"] == "N"


def test_the_strength_grows_like_the_logarithm_of_the_velocity():
    law = ShearStrength(4.0, rate_coefficient=0.1, reference_velocity=1.0)
    assert law.at(np.exp(2.0)) == pytest.approx(4.8)
    ratio = add_friction(DATASET, law)["friction"] / add_friction(DATASET, 4.0)["friction"]
    # At rest, the friction is that at which the next slide begins, and after the last one that of the last.
    slower = DATASET["leg"] <= 1
    np.testing.assert_allclose(ratio.values, np.where(slower, 1.0, 1 + 0.1 * np.log(10.0)), rtol=1e-14)


def test_strengths_that_cannot_be():
    with refuses("shear_strength"):
        add_friction(DATASET, 0.0)
    with refuses("units"):
        add_friction(DATASET, "40 MPa")
    with refuses("reference_velocity"):
        ShearStrength(4.0, rate_coefficient=0.1)
    law = ShearStrength(4.0, rate_coefficient=0.1, reference_velocity=1e6)
    with refuses("rate_coefficient"):
        add_friction(DATASET, law)
    with refuses("velocity"):
        add_friction(asp.age(CONTACT, [1.0]).dataset, law)
    with refuses("velocity"):
        add_friction(asp.age(CONTACT, [0.0], protocol=Slide(2.0, np.inf)).dataset, law)
    with refuses("dataset"):
        add_friction(asp.age(CONTACT, [1.0]), 4.0)  # type: ignore[arg-type]
