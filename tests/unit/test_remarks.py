"""Remarks on a contact, its surface and its solid: of which they are true, and that every door has them."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import asperity as asp
from asperity.analysis.bands import rows_of_maps
from asperity.app.config import config_from
from asperity.app.runs import Progress, answer, execute
from asperity.base.calls import remarks_made
from asperity.contact.remarks import (
    Resolved,
    _is_shape,
    remarks_on_bodies,
    remarks_on_contacts,
    sticking_work,
)
from asperity.prediction.plausible import remarks_on_history
from asperity.solids import Dugdale, half_space
from asperity.surfaces import KINDS, Surface, combined, spectral, statistics

FEW, FULL, STEEP, STICK, YIELD, STRAIN = (
    "too few for the statistics",
    "longer waves",
    "the rms slope is",
    "bodies so soft stick",
    "set a hardness",
    "strains are large",
)
PLASTIC = half_space(modulus="3 GPa")
NM: dict[str, Any] = {"pixel_size": 20.0, "unit": "nm", "seed": 1}


def remarks_of(call):
    with remarks_made() as made:
        call()
    return made


def any_of(remarks, *texts):
    made = "\n".join(remarks)
    return {text for text in texts if text in made}


def test_all_doors_make_the_same_remarks():
    rough = spectral((64, 64), rms_slope=0.4, **NM)
    surface = {"kind": "spectral", "shape": [64, 64], "rms_slope": 0.4, **NM}
    solid = {"kind": "half_space", "modulus": "2.4 MPa", "branches": [[0.3, "1 s"]]}
    rubber = half_space(modulus="2.4 MPa", branches=[(0.3, "1 s")])
    tables = {
        "surface": surface,
        "solid": solid,
        "contact": {"pressure": "0.5 MPa"},
        "aging": {"times": [0.1, 0.3, 1, 3, 10]},
    }

    def of(**changed):
        return answer(config_from(tables | changed, {}, None), Progress()).remarks

    law: dict[str, Any] = {"pressures": ["0.1 MPa", "0.5 MPa"], "per_decade": 1}
    doors = [
        of(),
        of(output={"maps_at": []}),  # as the page asks for it
        of(prediction={}),
        asp.predict(rubber, rough, pressure="0.5 MPa", first="0.1 s", last="10 s").remarks,
        of(contact={}, aging={"times": [0.0]}, law=law),
        remarks_of(lambda: asp.press(rough, rubber, pressure="0.5 MPa")),
        remarks_of(lambda: asp.press(rough, rubber, pressure=["0.1 MPa", "0.5 MPa"])),
        remarks_of(lambda: asp.law(rubber, rough, times=[0.0], **law)),
    ]
    for remarks in doors:
        assert any_of(remarks, FEW, FULL, STEEP, STICK, YIELD, STRAIN) == {FEW, FULL, STEEP, STICK, STRAIN}
        assert len(set(remarks)) == len(remarks)
        assert not [one for one in remarks if "--" in one]


def test_a_law_counts_the_rows_that_a_remark_is_true_of():
    rough = spectral((64, 64), rms_slope=0.2, **NM)
    made = remarks_of(lambda: asp.law(PLASTIC, rough, pressures=["1 MPa", "10 MPa", "30 MPa"]))
    few = []
    for pressure in (1e6, 1e7, 3e7):
        with remarks_made():
            few.append(asp.analysis.patches(asp.press(rough, PLASTIC, pressure=pressure).in_contact).count)
    (said,) = (one for one in made if FEW in one)
    assert said.startswith(f"{few[0]} patch")
    assert "under 1 MPa after 0 s" in said
    assert said.endswith(f"likewise in {sum(0 < count < 30 for count in few) - 1} of 2 other rows")


def test_rough_bodies_stick_by_the_balance_of_pastewka_and_robbins():
    # At the rim of a line contact the gap is Hertz's, with half the rms Laplacian as 1/R.
    rough = spectral((64, 64), rms_slope=0.1, **NM)
    measures, modulus, reach = statistics(*rough.in_meters()), 2e6, 0.5e-9
    half_width, curvature = measures.rms_slope / measures.rms_curvature, measures.rms_curvature

    def gap(x):
        """Beside a line contact of half-width a, to lowest order: 2 sqrt(2) / 3 sqrt(a) x^1.5 / R."""
        return 2 * math.sqrt(2) / 3 * math.sqrt(half_width) * x**1.5 * curvature

    rim = brentq(lambda x: gap(x) - reach, 0.0, half_width, xtol=1e-20)
    work = measures.rms_slope * modulus / 2 * reach / (math.pi * rim / (2 * half_width))
    assert sticking_work(measures, modulus) == pytest.approx(work, rel=1e-9)
    # Of w / E* = 21 nm and a slope of 0.77 as on a scan with pixels of 20 nm, and not of a stiff solid.
    steep = spectral((64, 64), rms_slope=0.77, **NM)
    for solid, expected in (
        (half_space(modulus="2.4 MPa"), {STICK}),
        (half_space(modulus="99 MPa"), set()),
        (half_space(modulus="2.4 MPa", adhesion=Dugdale(work="50 mJ/m^2", range="20 nm")), set()),
    ):
        assert any_of(remarks_on_bodies(steep, solid), STICK) == expected
    flat = Surface(np.zeros((8, 8)), unit="um", pixel_size=(1.0, 1.0), length_unit="um")
    assert any_of(remarks_on_bodies(flat, half_space(modulus="2 MPa")), STICK) == {STICK}
    assert not any_of(remarks_on_bodies(flat, half_space(modulus="0.2 GPa")), STICK)


@pytest.mark.parametrize(
    ("modulus", "said"), [("2.4 MPa", STRAIN), ("99 MPa", STRAIN), ("0.101 GPa", YIELD), ("70 GPa", YIELD)]
)
def test_only_stiff_solids_would_yield(modulus, said):
    seen = Resolved(99, 50.0, 0.0, 0.0, "at first", strain=0.06)
    rough = spectral((32, 32), rms_slope=0.1, **NM)
    assert any_of(remarks_on_contacts(rough, half_space(modulus=modulus), [seen]), YIELD, STRAIN) == {said}
    hard = half_space(modulus=modulus, hardness="1 MPa")
    assert not any_of(remarks_on_contacts(rough, hard, [seen]), YIELD, STRAIN)


@pytest.mark.parametrize(("slope", "said"), [(0.25, set()), (0.35, {STEEP})])
def test_slopes_that_are_not_small_are_remarked(slope, said):
    for rough in (spectral((64, 64), rms_slope=slope, **NM), spectral((64,), rms_slope=slope, **NM)):
        assert any_of(remarks_on_bodies(rough, PLASTIC), STEEP) == said


@pytest.mark.parametrize(
    ("pressure", "modulus", "said"),
    [
        ("1 MPa", "3 GPa", set()),
        (5, "3 GPa", {"5 Pa under"}),  # meant as 5 MPa
        ("3 Pa", 3, {"E* is 3 Pa"}),
        ("30 GPa", "3 TPa", {"E* is 3e+12 Pa"}),
    ],
)
def test_numbers_that_seem_to_lack_a_unit_are_remarked_in_python(pressure, modulus, said):
    rough = spectral((32, 32), rms_slope=0.1, **NM)
    made = remarks_of(lambda: asp.press(rough, half_space(modulus=modulus), pressure=pressure))
    told = [remark for remark in made if "texts have units" in remark]
    assert len(told) == len(said)
    assert all(any(part in remark for remark in told) for part in said)


WIDE = "as wide as the cell"


def test_shapes_are_no_statistics_and_must_fit_in_their_cell():
    made_at_random = {"gaussian", "exponential", "self_affine", "spectral", "spectrum"}
    for kind in KINDS.keys() - {"file"}:
        assert _is_shape(Surface(np.eye(4), provenance={"kind": kind})) == (kind not in made_at_random)
    ball = asp.surfaces.sphere((64, 64), radius="1 mm", pixel_size="1 um")
    rubber = half_space(modulus="3 MPa", branches=[(0.5, "1 s")])
    # By Hertz a = (3 R F / (4 E*))^(1/3): 24.7 um at first, of 32; 31.1 um when half has relaxed.
    made = remarks_of(lambda: asp.press(ball, rubber, load="60 uN"))
    assert not any_of(made, FEW, FULL, WIDE)
    tables = {
        "surface": {"kind": "sphere", "shape": [64, 64], "radius": "1 mm", "pixel_size": "1 um"},
        "solid": {"kind": "half_space", "modulus": "3 MPa", "branches": [[0.5, "1 s"]]},
        "contact": {"load": "60 uN"},
        "aging": {"times": [1.0, 20.0]},
    }
    outputs: tuple[dict[str, Any], ...] = ({}, {"maps_at": []})
    for output in outputs:
        remarks = execute(config_from(tables | {"output": output}, {}, None), Progress()).remarks
        assert any_of(remarks, FEW, FULL, WIDE) == {WIDE}
        (said,) = (one for one in remarks if WIDE in one)
        assert f"the contact is {100 * 2 * 31.1 / 64:.0f} % as wide" in said
    both = combined(
        ball, dataclasses.replace(spectral((64, 64), rms_slope=0.1, pixel_size=1.0, unit="um"), edges="free")
    )
    assert any_of(remarks_of(lambda: asp.press(both, PLASTIC, load="1 mN")), FEW) == {FEW}


@pytest.mark.parametrize(("reach", "said"), [(0.45, False), (0.6, True)])
def test_images_are_remarked_where_they_matter(reach, said):
    """Balls beside their images touch less than Hertz's; where nothing is said, by 3 % at most."""
    radius, width = 1e-3, 96
    load = 4 / 3 * 3e9 * (reach / 2 * width * 1e-6) ** 3 / radius
    ball = asp.surfaces.sphere((width, width), radius=radius, pixel_size=1e-6, edges="periodic")
    contacts = []
    made = remarks_of(lambda: contacts.append(asp.press(ball, PLASTIC, load=load)))
    hertz = math.pi * (reach / 2 * width * 1e-6) ** 2
    assert (contacts[0].contact_area_corrected / hertz < 0.97) == said
    assert any_of(made, "images") == ({"images"} if said else set())


ADVICE = {"tilt = 'quadratic'", "lines = 'median'", "despike = true"}


def scanned(heights, **options):
    np.save("scan.npy", heights)
    units: dict[str, Any] = {"file_unit": "nm", "pixel_size": 20.0, "length_unit": "nm"}
    return asp.surfaces.read("scan.npy", periodic="reflect", **units, **options)


@pytest.mark.usefixtures("here")
def test_advice_leaves_out_what_was_done_and_pits_bear_nothing():
    rng = np.random.default_rng(0)
    heights = spectral((64, 64), roll_off=16, cutoff=4, seed=2)
    heights /= heights.std()
    lined = heights + 3 * rng.normal(size=(64, 1))
    every = {"tilt": "quadratic", "lines": "median", "despike": True}
    touching = Resolved(99, 50.0, 0.0, 0.0, "at first", fraction=0.4, pressure=1e6, effective=1e6)
    for done in ({}, {"tilt": "quadratic"}, {"despike": True}, {"despike": True, "lines": "median"}, every):
        (said,) = remarks_on_contacts(scanned(lined, **done), PLASTIC, [touching])
        assert any_of([said], *ADVICE) == {one for one in ADVICE if one.split(" =")[0] not in done}
    pitted = heights.copy()
    pitted[rng.random(heights.shape) < 0.003] -= 40.0
    scan = scanned(pitted)
    (said,) = remarks_on_contacts(scan, PLASTIC, [touching])
    assert not any_of([said], *ADVICE)
    assert f"pits (skewness {scan.describe().skewness:.3g})" in said


@pytest.mark.parametrize(("strength", "said"), [("50 MPa", True), ("0.5 MPa", False), ("5 Pa", True)])
def test_an_implausible_friction_is_remarked(strength, said):
    surface = {"kind": "spectral", "shape": [32, 32], "rms_slope": 0.1, **NM}
    tables = {
        "surface": surface,
        "solid": {"kind": "half_space", "modulus": "2.4 MPa", "branches": [[0.3, "1 s"]]},
        "contact": {"pressure": "0.2 MPa"},
        "aging": {"times": [0.1, 0.3, 1, 3, 10]},
        "friction": {"shear_strength": strength},
    }
    questions: list[dict[str, Any]] = [{}, {"prediction": {}}]
    for question in questions:
        found = answer(config_from(tables | question, {}, None), Progress())
        mu = float(found.dataset["friction"][0])
        assert any_of(found.remarks, f"the coefficient of friction is {mu:.3g};") == (
            {f"the coefficient of friction is {mu:.3g};"} if said else set()
        )


def test_maps_between_recorded_times_lose_nothing():
    tables: dict[str, Any] = {
        "surface": {"kind": "spectral", "shape": [16, 16], "rms_slope": 0.1, **NM},
        "solid": {"kind": "half_space", "modulus": "3 GPa", "branches": [[0.5, "1 s"]]},
        "contact": {"pressure": "10 MPa"},
        "aging": {"times": [1.0, 10.0]},
        "output": {"maps_at": [0.0, 3.0]},
    }
    dataset = execute(config_from(tables, {}, None), Progress()).dataset
    assert dataset["field_time"].values.tolist() == [0.0, 3.0]
    assert rows_of_maps(dataset) == [0, 1]
    # A map between a switch and the first time that is recorded after it: the switch is the last entry.
    tables["protocol"] = [{"kind": "hold", "duration": 2.0}, {"kind": "hold", "duration": 8.0}]
    dataset = execute(config_from(tables, {}, None), Progress()).dataset
    assert dataset["time"].values.tolist() == [0.0, 1.0, 2.0, 10.0]
    assert rows_of_maps(dataset) == [0, 2]


def test_no_patches_after_a_pull_off_are_not_few():
    rough = spectral((32, 32), rms_slope=0.1, **NM)
    dataset = asp.age(asp.press(rough, PLASTIC, pressure="1 MPa"), [1.0]).dataset
    for patches, said in ((0, set()), (1, {FEW}), (30, set())):
        seen = Resolved(patches, 1.0, 0.0, 0.0, "at first")
        assert any_of(remarks_on_history(rough, PLASTIC, dataset, [seen]), FEW) == said
    # A map under less than the largest load is no contact whose patches count.
    held = [
        Resolved(50, 9.0, 0.0, 0.0, "at 0 s", pressure=1e6),
        Resolved(1, 9.0, 0.0, 0.0, "at 9 s", pressure=1e3),
    ]
    assert not any_of(remarks_on_history(rough, PLASTIC, dataset, held), FEW, "merge")


@pytest.mark.parametrize(("pixels", "said"), [(6.3, "16 %"), (12.0, "8 %"), (19.0, "5 %"), (21.0, None)])
def test_few_pixels_in_the_zone_of_a_front_are_remarked(pixels, said):
    # The zone is pi E* w / (4 s0^2) with s0 = w / h0: pi E* h0^2 / (4 w).
    pixel, modulus, work = 10e-9, 1e6, 20e-3
    reach = math.sqrt(4 * work * pixels * pixel / (math.pi * modulus))
    ball = asp.surfaces.paraboloid((24, 24), radius="1 um", pixel_size=pixel)
    rubber = half_space(modulus=modulus, adhesion=Dugdale(work=work, range=reach))
    contacts = []
    made = remarks_of(lambda: contacts.append(asp.press(ball, rubber, load="1 nN")))
    expected = {f"{pixels:.3g} pixels", said} if said else set()
    assert any_of(made, f"{pixels:.3g} pixels", said or "zone") == expected
    # A history says at last, once the modulus has relaxed.
    relaxing = half_space(modulus=modulus, adhesion=Dugdale(work=work, range=reach), branches=[(0.1, 1e-3)])
    made = remarks_of(lambda: asp.age(asp.press(ball, relaxing, load="1 nN"), [1.0]))
    assert bool(any_of(made, f"{0.9 * pixels:.3g} pixels at last")) == (0.9 * pixels < 20)
