"""What results say of themselves: one short line, and HTML with a picture, numbers and the certificate."""

import base64
import functools
import io
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

import asperity as asp
from asperity.base.views import InNotebooks
from asperity.figures import html_of

SPRINGS = asp.solids.spring_lattice(k0=1.0, k1=3.0)
CREEPING = asp.solids.half_space(modulus=1e9, branches=[(0.5, 10.0), (0.25, 1e3)])
SCAN = asp.surfaces.Surface(
    np.asarray(asp.surfaces.gaussian((24, 24))),
    unit="um",
    pixel_size=(2.0, 2.0),
    length_unit="um",
    provenance={"file": "<b>scan</b> & more.opd"},
)
PRESSED = asp.press(SCAN, CREEPING, pressure=1e7)
SPRUNG = asp.press(asp.surfaces.gaussian((24, 24)), SPRINGS, load=20.0)
HISTORY = asp.age(PRESSED, [1.0, 10.0, 100.0], fields_at=[0.0])
TIME = np.geomspace(0.1, 1e3, 21)
CURVE = 10.0 * (1 + 0.3 * np.log1p(TIME))
FIT = asp.fits.saturation(TIME, CURVE)
TABLE = asp.relaxation.fit(asp.relaxation.Relaxation(TIME, 1e9 * (0.2 + 0.8 / (1 + TIME) ** 0.3)))
PREDICTION = asp.predict(TABLE.data, SCAN, pressure="10 MPa", shear_strength="50 MPa")

RESULTS = {
    "contact": PRESSED,
    "contact of springs": SPRUNG,
    "line": asp.press(asp.surfaces.gaussian((64,)), SPRINGS, load=6.0),
    "history": HISTORY,
    "instant": asp.age(SPRUNG, [0.0]),
    "surface": SCAN,
    "profile": asp.surfaces.Surface(asp.surfaces.gaussian((64,))),
    "springs": SPRINGS,
    "solid": CREEPING,
    "fit": FIT,
    "relaxation": TABLE,
    "prediction": PREDICTION,
}


@functools.cache
def html(thing: InNotebooks) -> str:
    return thing._repr_html_() or ""


def texts(thing: InNotebooks) -> list[str]:
    """The texts of a page whose tags match."""
    return list(ElementTree.fromstring(re.sub(r"(<img[^>]*)>", r"\1/>", html(thing))).itertext())


def cells(thing: InNotebooks) -> dict[str, str]:
    return dict(zip(texts(thing)[1::2], texts(thing)[2::2], strict=False))


def test_html_is_well_formed_and_its_picture_is_one() -> None:
    for name, thing in RESULTS.items():
        assert isinstance(thing, InNotebooks)
        assert texts(thing), name
        assert len(html(thing)) < 200_000, name
        pictures = re.findall(r"data:image/png;base64,([^\"]+)", html(thing))
        assert len(pictures) == (name not in ("instant", "springs", "fit")), name
        for picture in pictures:
            with Image.open(io.BytesIO(base64.b64decode(picture))) as image:
                assert min(image.size) > 200, name
                assert len(np.unique(np.asarray(image.convert("L")))) > 10, name


def test_a_contact_gives_its_numbers_and_its_certificate() -> None:
    said = cells(PRESSED)
    assert said["contact"] == f"{PRESSED.area} of 576 sites = {100 * PRESSED.area / 576:.4g} %"
    assert said["load"] == "23.04\u00a0mN"  # 10 MPa on 48 µm x 48 µm
    assert said["mean pressure"] == "10\u00a0MPa"
    assert f"residual of {PRESSED.residual:.1e}" in html(PRESSED)
    assert cells(SPRUNG)["load"] == "20"
    assert cells(SPRUNG)["solid"] == "spring_lattice, k0 1, k1 3, R 1, R_viscous 0"
    assert ["stiffness" in html(one) for one in (PRESSED, SPRUNG)] == [False, True]


def test_a_history_gives_first_and_last_area_and_the_worst_residual() -> None:
    said = cells(HISTORY)
    for when, at in (("contact at t = 0", 0), ("contact at t = 100 s", -1)):
        assert f": {HISTORY.area.values[at]} of 576 sites" in said[when]
        area, unit = said[when].split(":")[0].split("\u00a0")
        assert float(area) == pytest.approx(HISTORY["contact_area"].values[at] * 1e12, rel=1e-3)
        assert unit == "µm²"
    worst = f"{HISTORY['residual'].max():.1e} of the mean contact force; exact contact, "
    assert said["worst residual"].startswith(worst)
    assert not [name for name in said if name.startswith("load at")]  # it is held
    held = cells(asp.age(SPRUNG, [10.0], hold="separation"))["load at t = 10"]
    assert float(held.split(",")[0]) < 20


def test_surfaces_solids_and_fits_give_their_parameters_and_names_from_files_are_text() -> None:
    assert "<b>scan" not in html(SCAN)
    expected = {
        SCAN: {"from": "<b>scan</b> & more.opd", "pixels": "2\u00a0µm × 2\u00a0µm"},
        SPRINGS: {"k1": "3"},
        CREEPING: {"share 0.25": "relaxes in 1e+03"},
        FIT: {"points": "21"},
    }
    for thing, said in expected.items():
        assert said.items() <= cells(thing).items()
    assert cells(FIT)["a"].startswith(f"{FIT.a:.3g}"[:3])


def test_a_prediction_gives_its_growth_with_its_band() -> None:
    said, growth = cells(PREDICTION), PREDICTION.growth
    low, high = growth.ratio_band
    decimals = 1 - math.floor(math.log10((high - low) / 4))  # two digits of one standard error
    ratio, low, high = (f"{value:.{decimals}f}" for value in (growth.ratio, low, high))
    assert said[PREDICTION.between("A")] == f"{ratio} (95 %: {low} to {high})"
    least = 100 * min(slope for *_, slope in growth.decades)
    assert "% of the first area (95 %: " in said["growth per decade"]
    assert f"); {least:.3g} to " in said["growth per decade"]
    assert said["load"].startswith("23.04\u00a0mN, 10 MPa over ")  # on 48 µm x 48 µm
    assert set(PREDICTION.remarks) <= set(texts(PREDICTION))


def test_what_has_no_card_is_refused() -> None:
    with pytest.raises(TypeError, match="no card for a dict"):
        html_of({})
