"""Rock fractures: pictures with a known field, a paraboloid by Hertz, and a hardness that is put in."""

import os
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

import asperity as asp
from asperity.errors import InputError
from asperity_research.experiments import comparing, fracture_2018
from asperity_research.experiments.apertures import Aperture, of_file, of_picture
from asperity_research.studies.evidence import Evidence

DATA = Path(os.environ.get("ASPERITY_DATA", ""), "fracture")
END, PIXEL = 1e-3, 0.5e-3
BAR = np.array(
    [[0, 0, 0], [255, 0, 0], [255, 255, 0], [255, 255, 191], [191, 255, 255], [0, 255, 255], [0, 0, 255]]
)


def painted(part):
    """Colors, shape (..., 3), of parts of the bar from 0 to 1."""
    at = [0, 1 / 6, 1 / 3, 1 / 2, 2 / 3, 5 / 6, 1]
    return np.stack([np.interp(part, at, channel) for channel in BAR.T], axis=-1)


def picture(path, part):
    """Paint a field of parts of the bar, and a bar of 200 rows in a frame beside it."""
    image = np.full((240, part.shape[1] + 60, 3), 255.0)
    image[20 : 20 + len(part), 10 : 10 + part.shape[1]] = painted(part)
    image[20:221, -30:-10] = painted(np.linspace(1, 0, 201))[:, np.newaxis]
    image[[20, 220], -30:-10] = 19
    matplotlib.image.imsave(path, np.rint(image).astype(np.uint8))


def test_a_picture_is_read_to_a_row_of_its_bar(tmp_path):
    y, x = np.indices((160, 120))
    part = np.clip(0.1 + x / 150 + 0.1 * np.sin(y / 7), 0.01, 0.99)
    part[np.hypot(y - 80, x - 60) > 55] = 1.0
    picture(tmp_path / "a.png", part)
    found = of_picture(tmp_path / "a.png", 0.12, 0.32, END)
    assert found.pixel == pytest.approx((0.002, 0.001))
    assert np.abs(found.distance / END - part)[found.body].max() < 1 / 200
    assert np.array_equal(found.body, part < 1)


def test_colors_that_the_bar_does_not_have_are_undefined(tmp_path):
    part = np.full((100, 100), 1.0)
    part[20:80, 20:80] = 1 / 3
    picture(tmp_path / "a.png", part)
    image = matplotlib.image.imread(tmp_path / "a.png")[..., :3].copy()
    image[60, 60] = (image[60, 60] + image[20, 10]) / 2  # Between yellow and blue: gray
    matplotlib.image.imsave(tmp_path / "a.png", image)
    found = of_picture(tmp_path / "a.png", 0.1, 0.1, END)
    assert np.argwhere(np.isnan(found.distance)).tolist() == [[40, 50]]
    assert found.body.sum() == 3599


def numbers(folder, distance, unit="m"):
    """Write the distances as the repository does: a file of numbers for each axis and for the field."""
    for axis, size in zip("XY", distance.shape[::-1], strict=True):
        np.savetxt(folder / f"a.{axis}.txt", np.arange(size)[np.newaxis] * PIXEL)
    np.savetxt(folder / "a.Z.txt", distance)
    return folder / "a.Z.txt"


def test_numbers_in_files_are_read_as_they_are(tmp_path):
    distance = np.random.default_rng(0).uniform(0.1e-3, 0.8e-3, (20, 30))
    distance[3:6, 4] = np.nan
    distance[7, 8] = 1.5e-3
    found = of_file(numbers(tmp_path, distance), END)
    assert found.pixel == pytest.approx((PIXEL, PIXEL))
    assert np.allclose(found.distance, distance, equal_nan=True)
    assert found.body.sum() == 600 - 4
    np.savetxt(tmp_path / "plain.txt", distance)
    with pytest.raises(InputError, match="unit of length"):
        of_file(tmp_path / "plain.txt", END)
    with pytest.raises(InputError, match="apertures below 1 mm, got 0 %"):
        of_file(numbers(tmp_path, 1e3 * distance), END)
    np.savetxt(tmp_path / "a.Z.txt", distance.T)
    with pytest.raises(InputError, match=r"expected 20 by 30 apertures, .* got 30 by 20"):
        of_file(tmp_path / "a.Z.txt", END)


def disc(radius, shape=(128, 128)):
    """Squares of the distance from the middle, m^2, of a paraboloid's body, NaN beyond a radius."""
    y, x = ((np.indices(shape).T - (np.array(shape) - 1) / 2) * PIXEL).T
    return x, np.where(np.hypot(x, y) < radius, x**2 + y**2, np.nan)


def test_closure_of_a_paraboloid_is_that_of_hertz():
    curvature, modulus, edge = 0.35, 6e9, 25e-3
    _, square = disc(edge)
    radii = np.array([5e-3, 8e-3])
    loads = 4 * modulus * radii**3 / (3 * curvature)
    gaps = fracture_2018.cycle(
        Aperture(square / (2 * curvature), (PIXEL, PIXEL), END), modulus, None, loads / fracture_2018._AREA
    )
    # Gap outside a Hertzian contact of radius a, averaged over the disc.
    r = np.linspace(0, edge, 20001)[1:]
    known = []
    for a in radii:
        s = np.maximum(r, a)
        sunk = ((2 * a**2 - s**2) * np.arcsin(a / s) + a * np.sqrt(s**2 - a**2)) / (np.pi * curvature)
        gap = np.where(r > a, r**2 / (2 * curvature) - a**2 / curvature + sunk, 0)
        known.append(np.sum(gap * r) / np.sum(r))
    assert gaps[0] - gaps[1] == pytest.approx(known[0] - known[1], rel=0.01)


def test_a_tilted_paraboloid_turns_back():
    x, square = disc(25e-3)
    tilted = Aperture(square / 0.8 + 1e-4 + 2e-3 * x, (PIXEL, PIXEL), END)
    assert np.allclose(tilted.leveling(6e9, 5e3), [0, -2e-3], atol=5e-5)


@pytest.fixture(scope="module")
def rough():
    heights = asp.surfaces.spectral((48, 48), hurst=0.8, rms_slope=0.05, roll_off=24.0, cutoff=3.0, seed=2)
    distance = PIXEL * (heights.max() - heights)
    distance[:4] = np.nan
    return Aperture(distance, (PIXEL, PIXEL), END)


def test_the_second_loading_goes_up_where_the_first_came_down(rough):
    stress = np.array([0.02, 0.1, 0.3, 0.12, 0.02, 0.1, 0.3]) * 1e6
    gaps = fracture_2018.cycle(rough, 6e9, 1e8, stress)
    found = fracture_2018.closures(stress[:5], gaps[:5])
    assert found["first"][-1] > 0.1 * found["first"].max()
    again = np.interp(stress[4:], *np.array([stress[[0, 3, 2]], found["again"][[0, 3, 2]]]))
    assert np.allclose((gaps[4] - gaps[4:])[[0, 2]], again[[0, 2]], atol=1e-9)


def test_a_hardness_that_is_put_in_is_found(rough):
    stress = np.array([0.02, 0.1, 0.3, 0.1, 0.02]) * 1e6
    tried = fracture_2018.HARDNESSES

    def curve(hardness, hypothesis):
        return fracture_2018.closures(stress, fracture_2018.cycle(rough, 6e9, hardness, stress))[hypothesis]

    for hypothesis in fracture_2018.HYPOTHESES:
        predicted = np.array([curve(one, hypothesis) for one in tried])
        for hardness in (43e6, 120e6):
            found, misfit = fracture_2018.fit_hardness(tried, predicted, curve(hardness, hypothesis))
            assert found == pytest.approx(hardness, rel=0.1)
            assert misfit < 0.02 * predicted.max()
        assert fracture_2018.fit_hardness(tried, predicted, predicted[0])[0] == pytest.approx(tried[0])


def test_the_rock_is_taken_off_what_was_measured():
    stress, closure = fracture_2018.table("vd2")
    assert (stress.size, int(np.argmax(stress))) == (25, 12)
    assert closure[12] == pytest.approx(1e-3 * (0.1235 - 4.2e-3 * (10.2696 - 0.2575)))
    assert closure[-1] == pytest.approx(1e-3 * (0.0361 - 4.2e-3 * (0.2652 - 0.2575)), rel=1e-3)


def test_what_is_not_there_is_refused(tmp_path, monkeypatch):
    monkeypatch.setenv("ASPERITY_DATA", str(tmp_path))
    with pytest.raises(InputError, match="danielvogler/hm_coupled_fracture_response"):
        comparing.comparison_of("fracture-2018")
    with pytest.raises(InputError, match="a file each of vd1, vd2, vd3, got 1"):
        comparing.comparison_of("fracture-2018", [tmp_path / "a.png"])
    (tmp_path / "a.png").write_text("no picture")
    with pytest.raises(InputError, match="a picture"):
        comparing.comparison_of("fracture-2018", [tmp_path / "a.png"] * 3)
    matplotlib.image.imsave(tmp_path / "a.png", np.full((40, 40, 3), 255, np.uint8))
    with pytest.raises(InputError, match="on its right, a color bar, got 0 colored parts"):
        comparing.comparison_of("fracture-2018", [tmp_path / "a.png"] * 3)


@pytest.mark.skipif(not (DATA / "vd1_aperture.png").is_file(), reason="the pictures are not ours to give")
def test_verdicts_on_the_pictures(monkeypatch):
    monkeypatch.setattr(fracture_2018, "_PIXEL", 2e-3)
    monkeypatch.setattr(fracture_2018, "HARDNESSES", fracture_2018.HARDNESSES[::2])
    bodies = fracture_2018.read(())
    for body in bodies.values():
        assert 0.85 < body.body.sum() * np.prod(body.pixel) / fracture_2018._AREA < 1.0
        assert np.isnan(body.distance).mean() < 0.03
    read = [m for name, body in bodies.items() for m in fracture_2018._quantiles(name, body)]
    assert {m.verdict for m in read} == {"agrees"}
    coarse = {name: body.coarser(2e-3) for name, body in bodies.items()}
    outcome = fracture_2018.analyse(Evidence(Path()), coarse)
    verdicts = {finding.key: finding.verdict for finding in outcome.findings}
    assert len(verdicts) == 12
    assert verdicts["closure first"] == verdicts["left again"] == verdicts["other"] == "differs"
    assert verdicts["closure again"] != "differs"
    assert len(fracture_2018.draw(outcome.tables).axes) == 3
