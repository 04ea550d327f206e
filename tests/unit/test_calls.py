"""What TOML takes, Python takes: texts with units, `young`, `unit`; mistaken arguments are answered."""

import dataclasses
import functools
import inspect
import pickle
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

import asperity as asp
from asperity.errors import CallError, InputError, Remark
from tests.refusals import refuses

SOLIDS, SURFACES, THEORY = asp.solids, asp.surfaces, asp.theory
PAIR, CURVE = np.array([1.0, 3.0]), [1.0, 2.0, 3.0, 5.0, 8.0, 13.0]
FILM: dict[str, Any] = {"poisson": 0.3, "thickness": "1 um"}
STIFF = SOLIDS.half_space(young="3 GPa", poisson=0.3)
PRESSED = asp.press(PAIR, SOLIDS.spring_lattice(k0=1.0, k1=3.0), load=1.0)


WRONG_TYPES = [
    ("path", "None", asp.results.load, {"path": None}),
    ("path", "-1", asp.surfaces.read, {"path": -1}),
    ("undefined", "ndarray", asp.surfaces.read, {"path": "x.csv", "undefined": PAIR}),
    ("checkpoint", "False", asp.age, {"contact": PRESSED, "times": [1.0], "checkpoint": False}),
    ("hold", "ndarray", asp.age, {"contact": PRESSED, "times": [1.0], "hold": PAIR}),
    ("progress", "'yes'", asp.age, {"contact": PRESSED, "times": [1.0], "progress": "yes"}),
    ("edges", "ndarray", SURFACES.Surface, {"heights": PAIR, "edges": PAIR}),
    ("unit", "ndarray", SURFACES.gaussian, {"shape": 8, "unit": PAIR}),
    ("bonded", "None", SOLIDS.layer, FILM | {"modulus": 1.0, "bonded": None}),
    ("heights", "None", THEORY.winkler_area, {"load_per_site": 0.5, "k1": 3.0, "heights": None}),
    ("laws", "[]", asp.fits.measured_growth, {"time": CURVE, "value": CURVE, "laws": []}),
    ("laws", "'logarithm'", asp.fits.measured_growth, {"time": CURVE, "value": CURVE, "laws": "logarithm"}),
]


@pytest.mark.parametrize(("name", "got", "call", "given"), WRONG_TYPES)
def test_an_argument_of_another_type_is_refused_by_its_name(name, got, call, given):
    with refuses(name, got):
        call(**given)


def test_what_goes_wrong_within_a_call_stays_what_it_is():
    law = SOLIDS.CreepLaw(lambda s: s, np.ones_like)
    with pytest.raises(TypeError, match="unsupported") as raised:
        SOLIDS.CreepLaw(lambda s: s + None, np.ones_like)  # type: ignore[operator]
    assert not isinstance(raised.value, InputError)
    assert law.velocity(np.ones(2))[0].tolist() == [1.0, 1.0]
    for function in (asp.press, asp.predict, SOLIDS.half_space, asp.analysis.patches):
        assert pickle.loads(pickle.dumps(function)) is function


@pytest.mark.parametrize(
    ("made", "same"),
    [
        # E/(1 - nu^2) by hand: 3 GPa/(1 - 0.38^2), and 1/(0.8556/3 + 0.91/200) GPa
        (SOLIDS.contact_modulus("3 GPa", 0.38), 3e9 / 0.8556),
        (SOLIDS.contact_modulus(["3 GPa", "200000 MPa"], [0.38, 0.3]), 1e9 / (0.8556 / 3 + 0.91 / 200)),
        (THEORY.hertz("1 mN", modulus="3 GPa", radius="1 mm").approach, (0.75e-15 / 3) ** (2 / 3) / 1e-3),
        (
            THEORY.persson_area("1 MPa", modulus="3 GPa", slope=0.1),
            THEORY.persson_area(1e6, modulus=3e9, slope=0.1),
        ),
        (
            THEORY.westergaard_area(["1 MPa", "2 MPa"], modulus="3 GPa", amplitude="1 um", wavelength="1 mm"),
            THEORY.westergaard_area([1e6, 2e6], modulus=3e9, amplitude=1e-6, wavelength=1e-3),
        ),
    ],
)
def test_texts_with_units_are_numbers_in_si(made, same):
    assert made == pytest.approx(same, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "given", "name", "got"),
    [
        (SOLIDS.half_space, {}, "modulus and young", "none"),
        (SOLIDS.half_space, {"modulus": 1.0, "young": 1.0, "poisson": 0.3}, "poisson", "0.3"),
        (SOLIDS.half_space, {"young": "3 m", "poisson": 0.3}, "young", "'3 m'"),
        # nothing else has a unit
        (asp.press, {"heights": [1.0, 2.0], "solid": STIFF, "load": 1.0}, "units", "'3 GPa'"),
        (SURFACES.gaussian, {"shape": 8, "pixel_size": 0.5}, "unit", "none"),
        (SURFACES.gaussian, {"shape": 8, "rms": "1 um"}, "unit", "none"),
        (SURFACES.self_affine, {"size": 8, "unit": "ft"}, "unit", "'ft'"),
        (SURFACES.spectral, {"shape": 8, "pixel_size": "1 um"}, "unit", "none"),
        (SURFACES.spectral, {"shape": 8, "pixel_size": 1.0, "spacing": 1.0}, "pixel_size and spacing", ""),
    ],
)
def test_what_does_not_go_together_is_refused(call, given, name, got):
    with refuses(name, got):
        call(**given)


@pytest.mark.parametrize(
    ("make", "first", "numbers", "texts"),
    [
        (SURFACES.gaussian, (8, 4), {"rms": 0.05}, {"rms": "50 nm"}),
        (SURFACES.exponential, (8, 4), {"rms": 0.05}, {"rms": "50 nm"}),
        (SURFACES.self_affine, 8, {"delta": 0.05}, {"delta": "50 nm"}),
        (SURFACES.spectral, (8, 4), {"cutoff": 2.0}, {"cutoff": "2 um"}),
        (SURFACES.spectral, (8, 4), {"rms_slope": 0.1}, {"rms_slope": 0.1}),
    ],
)
def test_a_unit_makes_a_surface_of_the_same_heights(make, first, numbers, texts):
    waves = {"pixel_size": 0.5} if make is SURFACES.spectral else {}
    plain = make(first, **numbers, **waves)
    assert type(plain) is np.ndarray
    for given, size in ((numbers, 0.5), (texts, "500 nm"), (texts, ("0.5 um", "500 nm"))):
        rough = make(first, **given, unit="um", pixel_size=size)
        assert (rough.unit, rough.length_unit, rough.provenance["unit"]) == ("um",) * 3
        np.testing.assert_allclose(rough.heights, plain, rtol=1e-12)
        assert rough.pixel_size == pytest.approx((0.5, 0.5))
    if waves:
        assert np.array_equal(make(first, **numbers, spacing=0.5), plain)
    told = inspect.signature(make)  # as help and editors show it
    assert (told.parameters["unit"].annotation, told.return_annotation) == ("str | None", "Field | Surface")


@pytest.mark.parametrize(
    ("thing", "words"),
    [
        (
            SURFACES.sphere((8, 8), radius="1 mm", pixel_size="1 um"),
            "8 x 8 sites of 1 x 1 um, rms height 3.24 nm",
        ),
        (SURFACES.Surface(PAIR, unit="um", pixel_size=(0.5,)), "2 sites of 0.5, rms height 1 um"),
        (SURFACES.Surface(PAIR), "2 sites, rms height 1, periodic"),
        (SOLIDS.half_space(young="2 GPa", poisson=0.5), "half_space, modulus 2.667e+09 Pa, 0 branches"),
        (SOLIDS.half_space(modulus=2.0), "half_space, modulus 2, 0 branches"),
    ],
)
def test_bodies_are_shown_with_the_units_that_they_have(thing, words):
    assert words in repr(thing)


def test_a_remark_is_at_the_line_that_called():
    made = SURFACES.gaussian((8, 8), rms="1 um", unit="um")
    rough = dataclasses.replace(made, filled=np.ones((8, 8), dtype=bool))
    slides = asp.Carried(shear="1 N", friction_coefficient=0.1)
    calls: list[Callable[[], object]] = [
        lambda: asp.press(rough, STIFF, pressure="1 MPa"),
        lambda: asp.press(rough, STIFF, pressure=["1 MPa"]),
        lambda: asp.age(asp.press(made, STIFF, pressure="1 MPa"), [1.0], carried=slides),
    ]
    for call in calls:
        with pytest.warns(Remark) as seen:
            call()
        assert {one.filename for one in seen} == {__file__}


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        *(
            (name, f"asperity.relaxation.material(..., {name}=...)")
            for name in ("poisson", "young", "temperature", "hardness", "draws")
        ),
        ("branches_per_decade", "asperity.relaxation.material(..., per_decade=...)"),
        ("resistivity", "carried=asperity.Carried(resistivity=...)"),
        ("pixel", "instrument={'pixel': ...}"),
        ("legs", "protocol=[...]"),
        ("shear_strenght", "shear_strength=..."),
    ],
)
def test_an_argument_that_belongs_elsewhere_is_sent_there(name, advice):
    with refuses("predict", repr(name), advice=advice, kind=CallError):
        asp.predict("relaxation.csv", "scan.opd", pressure="1 MPa", **cast(Any, {name: 1.0}))


def test_a_key_of_an_instrument_is_checked_before_anything_is_read():
    with refuses("instrument", "'pixle'"):
        asp.predict("none.csv", "none.opd", pressure="1 MPa", instrument={"pixle": "1 um"})


def test_what_vanishes_is_zero_also_where_numpy_has_it_raise():
    data = asp.relaxation.Relaxation(np.geomspace(1e-6, 1e9, 40), np.linspace(3.0, 1.0, 40))
    solid = SOLIDS.spring_lattice(k0=1.0, k1=3.0)
    zener = functools.partial(asp.relaxation.fractional_zener, instantaneous=2.0, relaxed=0.5, exponent=0.5)
    with np.errstate(under="raise"):
        fitted = asp.relaxation.fit(data)
        series = zener(time=4.0, first=0.5, last=64.0)
        aged = asp.age(asp.press(PAIR, solid, load=1.0), [1e6])
    assert fitted.series == asp.relaxation.fit(data).series
    assert series == zener(time=4.0, first=0.5, last=64.0)
    assert aged.dataset.identical(asp.age(asp.press(PAIR, solid, load=1.0), [1e6]).dataset)
