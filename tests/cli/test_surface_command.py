"""``asperity surface``: what it says about a file, and what it draws."""

from pathlib import Path

import numpy as np
import pytest

from asperity import results
from asperity.surfaces import gaussian, spectral, sphere, statistics
from tests.cli.conftest import remarks, told
from tests.instrument_files import needs_library, stored


def row(text, name):
    """What stands beside a name."""
    (line,) = [line for line in text.splitlines() if line.startswith(name)]
    return line.removeprefix(name).strip()


def test_an_array(says):
    heights = gaussian((24, 16), seed=5) + 100 + 0.5 * np.arange(24)[:, None]
    heights[3, 4] = np.nan
    np.save("rough.npy", heights)
    text = says("surface", "rough.npy")
    for name, said in (
        ("pixels", "24 x 16 (rows x columns), undefined: 1"),
        ("size", "not in the file"),
        ("unit of heights", "not in the file"),
        ("edges", "reflecting"),
        ("figure written:", "rough.png; its data: rough.csv"),
    ):
        assert row(text, name) == said
    assert row(text, "sites").split("  ")[0] == "24 x 16"
    assert row(text, "sites").endswith("24 x 16")
    assert float(row(text, "maximum").split()[0]) == pytest.approx(np.nanmax(heights), rel=1e-4)
    # The tilt was most of the roughness: without it the noise of rms 1 is left.
    before, after = (float(word) for word in row(text, "rms height").split())
    assert before == pytest.approx(np.nanstd(heights), rel=0.01)
    assert after == pytest.approx(1.0, rel=0.1)
    down, right = (float(words.split()[0]) for words in row(text, "tilt").partition(", ")[2].split(" and "))
    assert (down, right) == pytest.approx((0.5, 0.0), abs=0.02)
    assert row(text, "tilt").endswith("per pixel to the right")
    assert Path("rough.png").read_bytes().startswith(b"\x89PNG")


def test_what_the_file_of_a_run_asks_for(says):
    keys = 'kind = "sphere"\nradius = "1 mm"\npixel_size = "1 um"\nshape = [32, 48]'
    Path("run.toml").write_text(f"[surface]\n{keys}\n")
    text = says("surface", "run.toml", "--out", "ball.png")
    ball = sphere((32, 48), radius=1e-3, pixel_size=1e-6)
    assert row(text, "edges") == ball.edges
    assert float(row(text, "rms height").split()[0]) == pytest.approx(1e9 * ball.heights.std(), rel=1e-4)
    told(text.splitlines()[0])
    assert Path("ball.png").exists()


def test_a_profile_in_text_with_options(says):
    Path("line.txt").write_text("\n".join(f"{h:.6f}" for h in gaussian(50, seed=1)))
    words = "--tilt none --periodic taper --unit rms --out line.pdf"
    text = says("surface", "line.txt", *words.split())
    assert [row(text, name) for name in ("edges", "tilt")] == ["periodic, border tapered", "none"]
    assert "rms" in row(text, "unit  ")
    assert Path("line.pdf").read_bytes().startswith(b"%PDF")


def test_roughness_and_hurst_exponent_are_those_of_the_scan(says):
    part = spectral((400, 400), hurst=0.6, cutoff=1, spacing=0.25, seed=5)[:200, :300]
    np.save("part.npy", part)
    words = ("--pixel-size", "0.25", "--length-unit", "um", "--file-unit", "nm")
    text = says("surface", "part.npy", *words)
    assert row(text, "power spectrum") == "of the scan itself, with a Hann window"
    found = row(text, "Hurst exponent").replace(")", "").split()
    assert float(found[3]) <= 0.6 <= float(found[5].rstrip(","))
    assert found[-1] == "um"
    with_unit = says("surface", "part.npy", "--pixel-size", "0.25um", "--file-unit", "nm", "--overwrite")
    assert row(with_unit, "Hurst exponent") == row(text, "Hurst exponent")
    curvature = statistics(part, (250.0, 250.0)).rms_curvature
    assert row(text, "rms curvature").split()[:2] == [f"{curvature:.4g}", "1/nm"]
    # A border that was brought to the mean does not count.
    tapered = says("surface", "part.npy", "--periodic", "taper", "--overwrite", *words)
    assert row(tapered, "Hurst exponent") == row(text, "Hurst exponent")


def test_a_part_and_a_band_of_waves(says, refused):
    np.save("rough.npy", gaussian((24, 16), seed=5))
    words = "--crop 2 10 0 8 --crop-unit um --longest 6 --shortest 2"
    lengths = "--pixel-size 0.5 --length-unit um --periodic reflect"
    text = says("surface", "rough.npy", *words.split(), *lengths.split())
    for name, said in (
        ("part", "pixels 4 20 0 16 (top bottom left right)"),
        ("wavelengths kept", "longest 6, shortest 2 um"),
        ("edges", "reflecting"),
    ):
        assert row(text, name) == said
    assert row(text, "sites").split() == ["24", "x", "16", "16", "x", "16"]
    assert row(text, "Hurst exponent").startswith("none: no half decade")
    refused("surface", "rough.npy", "--crop", "2", "30", "0", "8", "--overwrite")


def test_oblong_pixels_are_refused_or_averaged(says, refused):
    x, y = np.meshgrid(np.arange(12.0), 3.0 * np.arange(10), indexing="ij")
    np.savetxt("oblong.xyz", np.stack([x, y, gaussian((12, 10), seed=2)], axis=-1).reshape(-1, 3))
    text = says("surface", "oblong.xyz")
    assert remarks(text) == 1
    refused("run", "--file", "oblong.xyz")
    text = says("surface", "oblong.xyz", "--resample", "--overwrite")
    assert "remark" not in text
    sites = [words.split()[::2] for words in row(text, "sites").split("  ") if words]
    assert sites == [["10", "12"], ["10", "4"]]
    assert "pixels            averaged to 3 x 3 (no unit)\n" in text
    Path("run.toml").write_text('[surface]\npath = "oblong.xyz"\nresample = true\n[aging]\nlast = 0.1\n')
    says("run", "run.toml", "--quiet")
    assert "resample = true" in Path("asperity-out/config.toml").read_text()


def test_bow_and_spikes_are_remarked_and_removed(asperity, says):
    heights = spectral((96, 96), roll_off=20, cutoff=4, seed=1)
    u = np.linspace(-1, 1, 96)
    heights += 15 * u**2 + 10 * u[:, None] ** 2
    heights[20:22, 70] += 300.0
    np.save("bow.npy", heights)
    assert remarks(says("surface", "bow.npy")) == 2
    words = ("--tilt", "quadratic", "--despike")
    text = says("surface", "bow.npy", *words, "--overwrite")
    assert "remark" not in text
    assert row(text, "spikes filled") == "2 pixels"
    removed = row(text, "tilt").split(", and ")[1].split()
    found = [float(number.strip(",")) for number in removed[:3]]
    i, j = (places - 47.5 for places in np.nonzero(heights < 200))
    basis = np.stack([np.ones(i.size), i, j, i * i, i * j, j * j], axis=-1)
    fitted = np.linalg.lstsq(basis, heights[heights < 200], rcond=None)[0]
    assert found == pytest.approx(fitted[3:].tolist(), rel=1e-3)
    assert float(row(text, "rms height").split()[-1]) == pytest.approx(1.0, rel=0.05)
    # The same in a run: remarked, prepared, and recorded.
    options = ("--periodic", "reflect", "--load", "30", "--times", "0", "--figures", "")
    for prepared, expected in (((), 3), (words, 1)):
        status, text, error = asperity("run", "--file", "bow.npy", *prepared, *options, "--overwrite")
        assert status == 0
        assert error.count("remark: ") == expected
    assert "tilt = quadratic" in text
    assert "spikes filled" in text
    assert 'tilt = "quadratic"\ndespike = true' in Path("asperity-out/config.toml").read_text()
    assert results.load("asperity-out")["heights"].values.max() < 6


def test_lengths_in_units_that_people_use(says):
    np.save("rough.npy", 2e-9 * gaussian((20, 40), seed=1))
    words = ("--file-unit", "m", "--pixel-size", "5e-7", "--length-unit", "m")
    text = says("surface", "rough.npy", *words)
    assert row(text, "size") == "10 x 20 um"
    assert row(text, "unit of heights") == "m"
    assert [word for word in row(text, "rms height").split() if word.isalpha()] == ["nm", "nm"]
    hurst = row(text, "Hurst exponent")
    assert hurst.startswith("none")
    assert "use the rms slope" in hurst


@needs_library
def test_a_file_of_an_instrument(asperity, says):
    text = says("surface", stored("opd-1.opd"), "--unit", "nm")
    # What the instrument's own notes say of this file.
    assert row(text, "pixels") == "480 x 640 (rows x columns), undefined: 116"
    assert row(text, "size") == "94.4319 x 125.909 um"
    assert "nm" in row(text, "rms height")
    assert asperity("surface", stored("opd-1.opd"), "--channel", "nonsense", "--overwrite")[0] == 2


def test_undefined_values_and_channels_by_flags(says):
    heights = gaussian((24, 16), seed=5)
    heights[3:8, 4] = -9999
    np.savetxt("a.txt", heights)
    Path("two.txt").write_text(f"{Path('a.txt').read_text()}\n{Path('a.txt').read_text()}")
    for words in (["a.txt"], ["two.txt", "--channel", "1"]):
        text = says("surface", *words, "--undefined-value", "-9999", "--out", f"{words[0]}.png")
        assert row(text, "pixels") == "24 x 16 (rows x columns), undefined: 5"
