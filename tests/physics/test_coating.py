"""A film on a half-space of another material: elastic limits, an independent solution, relaxation in time."""

from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.lattice import Lattice
from asperity.solids.coating import Coated, Material
from tests.continua import elasticity, stiffness_of_a_wave, talbot
from tests.refusals import refuses
from tests.surfaces import correlated

FILM: dict[str, Any] = {"modulus": 2.0, "poisson": 0.4, "thickness": 3.0}
FILM |= {"base_modulus": 0.5, "base_poisson": 0.25}
LATTICE = Lattice((32, 24), (0.7, 0.9))


def stiffness_of_layers(q, thickness, film, base):
    """Pressure over displacement of a wave on a bonded film; the base has what decays below it."""
    decaying = np.linalg.matrix_power(elasticity(q, *base) + q * np.eye(4), 2)[:, :2]
    modulus, poisson = film
    return stiffness_of_a_wave(q, modulus, poisson, thickness, decaying)


@pytest.mark.parametrize(("film", "base"), [((2.0, 0.4), (0.5, 0.25)), ((0.1, 0.45), (3.0, 0.1))])
def test_the_stiffness_is_that_of_the_equations_of_elasticity(film, base):
    coated = Coated(Material(film[0], film[1], ()), Material(base[0], base[1], ()), 1.0)
    x = np.array([0.05, 0.4, 1.0, 3.0])
    expected = [stiffness_of_layers(one, 1.0, film, base) for one in x]
    np.testing.assert_allclose(coated.over_wave_number(x, 0.0) * x, expected, rtol=1e-9)


def test_limits_are_a_half_space_and_a_layer():
    same = asp.solids.coated_half_space(**FILM | {"base_modulus": 2.0, "base_poisson": 0.4})
    half = asp.solids.half_space(modulus=2.0)
    np.testing.assert_allclose(same.on(LATTICE).permanent, half.on(LATTICE).permanent, rtol=1e-12)
    hard = asp.solids.coated_half_space(**FILM | {"base_modulus": 1e9}).on(LATTICE).permanent
    layer = asp.solids.layer(modulus=2.0, poisson=0.4, thickness=3.0).on(LATTICE).permanent
    np.testing.assert_allclose(hard.flat[1:], layer.flat[1:], rtol=1e-6)
    assert hard.flat[0] == 0


POWER_LAW = asp.relaxation.power_law(modulus=1.0, exponent=0.5, time=1.0, first=1e-2, last=1e6).branches


@pytest.mark.parametrize(
    ("x", "branches"), [(0.1, POWER_LAW), (1.0, [(0.4, 1.0), (0.3, 30.0)]), (4.0, POWER_LAW)]
)
def test_relaxation_in_time_is_that_of_the_transform(x, branches):
    base_branches = [(0.5, 5.0)]
    solid = asp.solids.coated_half_space(**FILM, branches=branches, base_branches=base_branches)
    line = Lattice((64,), (2 * np.pi / 64 / x * FILM["thickness"],))  # wave 1 has q thickness = x
    spectra = solid.on(line)

    def modulus(s, at_once, parts):
        return at_once * (1 - sum(share / (1 + s * tau) for share, tau in parts))

    def transform(s):
        film, base = modulus(s, 2.0, branches), modulus(s, 0.5, base_branches)
        return stiffness_of_layers(x, 1.0, (film, 0.4), (base, 0.25)) / s

    at_once = (spectra.permanent + spectra.creeping.sum(axis=0))[1]
    scale = at_once / (talbot(transform, 1e-9) or 1.0)
    for t in (0.1, 1.0, 10.0, 100.0):
        found = spectra.permanent[1] + float(spectra.creeping[:, 1] @ np.exp(-t * spectra.rate[:, 1]))
        assert found / at_once == pytest.approx(scale * talbot(transform, t) / at_once, abs=3e-3)


def test_the_whole_ages_from_one_elastic_contact_to_another():
    rough = correlated(64)
    film = asp.solids.coated_half_space(**FILM, branches=[(0.5, 1.0)], base_branches=[(0.8, 100.0)])
    relaxed_film = {"modulus": 1.0, "base_modulus": 0.1}
    contact = asp.press(rough, film, load=0.02 * rough.size)
    at_once = asp.press(rough, asp.solids.coated_half_space(**FILM), load=0.02 * rough.size)
    in_the_end = asp.press(rough, asp.solids.coated_half_space(**FILM | relaxed_film), load=0.02 * rough.size)
    np.testing.assert_array_equal(contact.in_contact, at_once.in_contact)
    history = asp.age(contact, [0.1, 1.0, 1e6])
    areas = history.dataset["area"].values
    assert not film.separable
    assert (np.diff(areas) > 0).all()
    assert asp.relax(contact).area == in_the_end.area
    assert areas[-1] == pytest.approx(in_the_end.area, abs=1)


def test_numbers_are_checked():
    wrong: dict[str, Any] = {"thickness": 0.0, "base_poisson": 0.7, "base_modulus": -1.0}
    wrong |= {"base_branches": [(0.5, -1.0)], "branches": [(1.0, 1.0)]}
    for name, value in wrong.items():
        with refuses(name, "" if isinstance(value, list) else value):
            asp.solids.coated_half_space(**FILM | {name: value})


def test_a_rigid_machine_holds_a_film_on_a_base_that_flows():
    rough, flows = correlated(32), [(1.0, 1.0)]
    solid = asp.solids.coated_half_space(**FILM, base_branches=flows, apparatus=np.inf)
    contact = asp.press(rough, solid, load=0.02 * rough.size)
    held = asp.press(rough, solid, separation=contact.separation)
    assert held.load == pytest.approx(contact.load, rel=1e-6)
    loads = asp.age(held, [1.0, 10.0]).dataset["load"].values
    assert (np.diff(loads) < 0).all()
