"""The configuration: what it accepts, and how it names every mistake."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

from asperity.cli.flags import AgingFlags, FileFlags, SolidFlags, SurfaceFlags, given
from asperity.config.mistakes import flag_of
from asperity.config.models import Aging, MeasuredSurface, Output, RunConfig, SelfAffine
from asperity.config.reading import file_surface, from_tables, read_config, to_tables, to_toml
from asperity.errors import ConfigError


def written(folder: Path, text: str) -> Path:
    path = folder / "run.toml"
    path.write_text(text, encoding="utf-8")
    return path


def problems_of(path: Path | None, flags: dict[str, dict[str, object]] | None = None) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read_config(path, flags or {})
    return caught.value.problems


def test_without_a_file_the_conditions_are_the_papers() -> None:
    config = read_config(None, {})
    assert config == RunConfig()
    assert config.surface.kind == "gaussian"
    assert config.surface.shape == [200, 200]
    assert config.solid.k1 / config.solid.k0 == 3
    assert config.contact.load is None


def test_every_mistake_has_its_line(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        """
        [surface]
        shap = [20, 20]
        hurst = 0.5
        rms = -1
        seed = 1.5
        [solid]
        K1 = 3
        k0 = "one"
        [contcat]
        load = 2
        [aging]
        hold = "laod"
        [output]
        figures = ["jpg"]
        """,
    )
    problems = problems_of(path)
    assert all(line.startswith(f"{path}: ") and "\n" not in line for line in problems)
    assert [line.removeprefix(f"{path}: ") for line in problems] == [
        "[surface] shap: no such key; did you mean 'shape'?",
        "[surface] hurst: not a key of a surface of kind 'gaussian', but of 'self_affine'",
        "[solid] K1: no such key; did you mean 'k1'?",
        "[contcat]: no such section; did you mean 'contact'?",
        "[surface] rms: expected a number above 0.0, got -1",
        "[surface] seed: expected a whole number, got 1.5",
        "[solid] k0: expected a number, got 'one'",
        "[aging] hold: expected one of 'load' or 'separation', got 'laod'",
        "[output] figures: expected one of 'png', 'pdf' or 'svg', got 'jpg'",
    ]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("k0 = 3", "k0: stands outside any section; it belongs below [solid]"),
        ("shape = 3", "shape: stands outside any section; it belongs below [surface]"),
        ("nonsense = 3", "nonsense: stands outside any section"),
        ("solid = 3", "solid: expected a section [solid], got 3"),
        ("surface = 3", "surface: expected a section [surface], got 3"),
        ("[surface]\nkind = 'gausian'", "got 'gausian'; did you mean 'gaussian'?"),
        ("[surface]\nkind = 3", "got 3"),
        ("[surface]\nkind = 'file'", "[surface] path: expected a value, got none"),
        ("[surface]\nshape = [3, 3, 3]", "[surface] shape: expected at most 2 in the list, got [3, 3, 3]"),
        ("[surface]\nshape = []", "[surface] shape: expected at least 1 in the list, got []"),
        ("[surface]\nshape = [0]", "[surface] shape: expected a number of at least 1, got 0"),
        ("[surface]\nseed = true", "[surface] seed: expected a whole number, got True"),
        (
            "[surface]\nkind = 'self_affine'\nsize = 100",
            "size: expected a power of two, 2 or more, got 100; try 64",
        ),
        ("[solid]\nk0 = nan", "[solid] k0: expected a finite number, got nan"),
        ("[solid]\nk1 = inf", "[solid] k1: expected a finite number, got inf"),
        ("[solid]\nk1 = 0", "[solid] k1: expected a number above 0.0, got 0"),
        ("[contact]\nload = 1\nseparation = 1", "[contact] expected load or separation, got both"),
        ("[aging]\nfirst = 10.0\nlast = 1.0", "[aging] expected first < last, got 10 and 1"),
        ("[aging]\ntimes = [1.0, 2.0]\nlast = 3.0", "[aging] expected times or last, got both"),
        ("[aging]\ntimes = [2.0, 1.0]", "[aging] times: expected strictly increasing times"),
        ("[aging]\nrtol = 1.0", "[aging] rtol: expected a number of at most 0.1, got 1.0"),
        ("[output]\nmaps_at = [1e9]", "[output] maps_at: expected times up to the last, 1e+06, got 1e+09"),
        ("[output]\nfigures = 'png'", "[output] figures: expected a list, got 'png'"),
    ],
)
def test_a_mistake_is_named(tmp_path: Path, text: str, line: str) -> None:
    (problem,) = problems_of(written(tmp_path, text))
    assert line in problem
    assert "http" not in problem


def test_files_that_are_no_configuration(tmp_path: Path) -> None:
    assert "No such file" in problems_of(tmp_path / "none.toml")[0]
    assert "directory" in problems_of(tmp_path)[0]
    assert "not a TOML file" in problems_of(written(tmp_path, "a = ["))[0]
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    assert "not text in UTF-8" in problems_of(binary)[0]


def test_a_mistake_in_a_flag_is_named_as_the_flag(tmp_path: Path) -> None:
    flags = given(SurfaceFlags(rms=-1.0, hurst=0.5))
    problems = problems_of(written(tmp_path, "[solid]\nk0 = -1"), flags)
    assert problems[0] == (
        "--hurst: not a key of a surface of kind 'gaussian', but of 'self_affine'; try --surface self_affine"
    )
    assert problems[1] == "--rms: expected a number above 0.0, got -1.0"
    assert problems[2].endswith("run.toml: [solid] k0: expected a number of at least 0.0, got -1")
    assert flag_of("surface", "kind") == "--surface"
    assert flag_of("surface", "path") == "--file"
    assert flag_of("aging", "per_decade") == "--per-decade"


def test_flags_override_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "[solid]\nk0 = 2.0\nk1 = 5.0\n[contact]\nseparation = 1.0\n[aging]\nlast = 7.0")
    flags = given(SolidFlags(k1=4.0), AgingFlags(times=["1,2", "3"])) | {"contact": {"load": 9.0}}
    config = read_config(path, flags)
    assert (config.solid.k0, config.solid.k1) == (2.0, 4.0)
    assert (config.contact.load, config.contact.separation) == (9.0, None)
    assert config.aging.times == [1.0, 2.0, 3.0]
    assert config.aging.end == 3.0


def test_a_flag_for_another_kind_of_surface_takes_the_keys_of_the_old_kind_away(tmp_path: Path) -> None:
    path = written(tmp_path, "[surface]\nkind = 'self_affine'\nsize = 64\nhurst = 0.8\nseed = 5")
    config = read_config(path, given(SurfaceFlags(surface="gaussian", shape=["32x16"])))
    assert config.surface.kind == "gaussian"
    assert (config.surface.shape, config.surface.seed) == ([32, 16], 5)
    (problem,) = problems_of(path, given(SurfaceFlags(surface="gaussian", hurst=0.5)))
    assert problem.startswith("--hurst: not a key of a surface of kind 'gaussian'")


def test_a_surface_file_is_looked_for_beside_the_configuration(tmp_path: Path) -> None:
    surface = read_config(written(tmp_path, "[surface]\npath = 'a.npy'"), {}).surface
    assert isinstance(surface, MeasuredSurface)
    assert Path(surface.path) == tmp_path / "a.npy"
    by_flag = read_config(None, given(SurfaceFlags(file="a.npy"), FileFlags(channel="2"))).surface
    assert isinstance(by_flag, MeasuredSurface)
    assert (by_flag.path, by_flag.channel) == ("a.npy", 2)


def test_how_a_file_is_prepared_is_checked() -> None:
    assert file_surface(Path("a.npy"), {"tilt": "mean"}).tilt == "mean"
    with pytest.raises(ConfigError, match=r"--max-undefined: expected a number below 1\.0, got 2\.0"):
        file_surface(Path("a.npy"), {"max_undefined": 2.0})


@pytest.mark.parametrize(
    "config",
    [
        RunConfig(),
        RunConfig(surface=SelfAffine(size=64, hurst=1 / 3, delta=1e-17)),
        RunConfig(surface=MeasuredSurface(path='/a "b"\\c\tü\x7f\n.npy', channel=0, unit="rms")),
        RunConfig(aging=Aging(times=[0.1, 1 / 3, 1e90]), output=Output(maps_at=[], figures=["svg", "pdf"])),
    ],
)
def test_what_is_written_reads_back_as_the_very_same(tmp_path: Path, config: RunConfig) -> None:
    text = to_toml(config)
    tomllib.loads(text)
    assert read_config(written(tmp_path, text), {}) == config
    assert from_tables(json.loads(json.dumps(to_tables(config)))) == config


def test_words_that_are_no_numbers_are_left_to_the_check() -> None:
    (problem,) = problems_of(None, given(SurfaceFlags(shape=["20,twenty"])))
    assert problem == "--shape: expected a whole number, got 'twenty'"
