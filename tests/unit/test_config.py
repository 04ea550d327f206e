"""The configuration: what it accepts, and how it names every mistake."""

from __future__ import annotations

import json
import pickle
import time
import tomllib
from pathlib import Path
from typing import Any

import pytest

import asperity as asp
from asperity.app.cli.flags import flags_for, given
from asperity.app.config.mistakes import ORDER, flag_of, models_of
from asperity.app.config.models import (
    Aging,
    Independent,
    MeasuredSurface,
    Output,
    RunConfig,
    SelfAffine,
    Spectral,
)
from asperity.app.config.reading import (
    config_from,
    file_surface,
    from_tables,
    read_config,
    to_tables,
    to_toml,
)
from asperity.app.config.solids import SpringLattice
from asperity.base.words import closest
from asperity.errors import ConfigError, InputError
from asperity.theory import ExponentialHeights, GaussianHeights
from tests.refusals import refuses


def written(folder: Path, text: str) -> Path:
    path = folder / "run.toml"
    path.write_text(text, encoding="utf-8")
    return path


def problems_of(path: Path | None, flags: dict[str, dict[str, object]] | None = None) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read_config(path, flags or {})
    return caught.value.problems


def flags_of(section: str, **words: str | list[str]) -> dict[str, dict[str, object]]:
    """What the flags of a section give that were written with these words."""
    made: Any = flags_for(section)
    return given(made(**{f"{section}_{key}": word for key, word in words.items()}))


def test_without_a_file_the_conditions_are_the_papers() -> None:
    config = read_config(None, {})
    assert config == RunConfig(
        surface=Independent(kind="gaussian", shape=[200, 200], rms=1.0),
        solid=SpringLattice(k0=1.0, k1=3.0, R=1.0),
    )


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
        "[surface] hurst: not a key of a surface of kind 'gaussian', but of 'self_affine' and 'spectral'",
        "[solid] K1: no such key; did you mean 'k1'?",
        "[contcat]: no such section; did you mean 'contact'?",
        "[surface] rms: expected a number above 0.0, got -1",
        "[surface] seed: expected a whole number, got 1.5",
        "[solid] k0: expected a number, got 'one'",
        "[aging] hold: expected one of 'load' or 'separation', got 'laod'; did you mean 'load'?",
        "[output] figures: expected one of 'png', 'pdf' or 'svg', got 'jpg'",
    ]


HALF = "[solid]\nkind = 'half_space'\n"
STIFF = f"{HALF}modulus = 1.0\n"
MISTAKES = [
    "solid = 3",
    "[surface]\nkind = 'gausian'",
    "[surface]\nkind = 'file'",
    "[surface]\nshape = [3, 3, 3]",
    "[surface]\nkind = 'self_affine'\nsize = 100",
    f"[surface]\nseed = {2**64}",
    "[solid]\nk0 = nan",
    "[solid]\nk1 = 0",
    f"[solid]\nk0 = 1{'0' * 400}",
    "[solid]\nR = 1e100",
    "[solid]\nkind = 'steel'",
    "[solid]\ncreep_rate = 1.0",
    "[solid]\ncreep = 'garofalo'\ncreep_rate = 1.0\ncreep_stress = 1.0",
    "[solid]\ncreep = 'norton'\ncreep_rate = 1.0\ncreep_stress = 1.0",
    "[solid]\ncreep = 'eyring'\ncreep_rate = 1.0",
    "[solid]\nkind = 'layer'\nmodulus = 1.0\npoisson = 0.3",
    f"{HALF}modulus = -1.0",
    f"{HALF}modulus = '3 um'",
    f"{HALF}young = 1.0",
    f"{HALF}relaxation = 'none.csv'\npoisson = 0.3",
    f"{STIFF}branches = [[0.6, 1.0], [0.5, 2.0]]",
    f"{STIFF}branches = [[1.5, 1.0]]",
    f"{STIFF}branches = [0.5]",
    f"{STIFF}creep_energy = 1.0\ntemperature = 300.0",
    f"{STIFF}per_decade = 2.0",
    f"{STIFF}permanent = 0.3",
    f"{STIFF}permanent = 0.01\ncreep = 'eyring'\ncreep_rate = 1.0\ncreep_stress = 1.0",
    "[contact]\nload = '1 MPa'",
    "[contact]\nload = '0,5'",
    "[contact]\nload = 0.0",
    "[aging]\ntimes = [2.0, 1.0]",
    "[aging]\ntimes = ['0,5']",
    "[aging]\nrtol = 1.0",
    "[[protocol]]\nkind = 'hold'\nduration = -1.0",
    "[[protocol]]\nkind = 'ramp'\nduration = 1.0",
    "[[protocol]]\nkind = 'slide'\ndistance = 1.0\nvelocity = 1.0\ndirection = 'z'",
    "[[protocol]]\nkind = 'repeat'\ncount = 2\nlegs = [{kind = 'step', load = '1 Pa'}]",
    "[output]\nmaps_at = [1e9]",
    "[output]\nfigures = 'png'",
]
UNKNOWN = {
    "k0 = 3": "k0: stands outside any section; it belongs below [solid]",
    "nonsense = 3": "nonsense: stands outside any section",
    "[sweep]\nload = [1.0]": "[sweep]: makes this the file of a campaign, not of a run; try",
    "[surface]\nfile = 'a.npy'": "[surface] file: no such key; try path",
    "[solid]\nE = 1.0": "[solid] E: no such key; there are kind, creep, creep_",
    "[solid]\nmodulus = 1.0": "[solid] modulus: not a key of a solid of kind 'spring_lattice', but",
    HALF: "[solid] expected modulus, young and poisson, or relaxation and poisson, got none",
    f"{STIFF}young = 1.0": "[solid] expected modulus or young, got both",
    f"{STIFF}poisson = 0.3": "[solid] poisson: expected none beside the contact modulus",
    f"{STIFF}branches = [[0.5, 1.0]]\nflow = [1.0, 2.0]": "[solid] expected branches or flow, got both",
    "[contact]\nload = 1\nseparation = 1": "[contact] expected load or separation, got both",
    "[contact]\npressure = 1.0\nload = 1.0\nseparation = 1.0": "[contact] expected load, pressure or",
    "[aging]\nfirst = 10.0\nlast = 1.0": "[aging] expected first < last, got 10 and 1",
    "[aging]\ntimes = [1.0, 2.0]\nlast = 3.0": "[aging] expected times or last, got both",
    "[[protocol]]\nkind = 'hold'\nduration = 1.0\nmobilty = 2.0": "protocol[0] mobilty: no such key; did you",
}


def test_a_mistake_is_one_line() -> None:
    for text in MISTAKES:
        with refuses("configuration", kind=ConfigError) as caught:
            config_from(tomllib.loads(text), {}, None)
        assert len(caught.value.problems) == 1  # type: ignore[attr-defined]
        assert "http" not in str(caught.value)
    for text, line in UNKNOWN.items():
        with pytest.raises(ConfigError) as raised:
            config_from(tomllib.loads(text), {}, None)
        (problem,) = raised.value.problems
        assert problem.startswith(line)


def test_files_that_are_no_configuration_and_one_that_is(tmp_path: Path) -> None:
    path = tmp_path / "notepad.toml"
    path.write_text("[solid]\nk1 = 4.0\n", encoding="utf-8-sig")  # a mark before the first letter
    assert read_config(path, {}).solid == SpringLattice(k1=4.0)
    assert "No such file" in problems_of(tmp_path / "none.toml")[0]
    assert "directory" in problems_of(tmp_path)[0]
    assert "not a TOML file" in problems_of(written(tmp_path, "a = ["))[0]
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    assert "not text in UTF-8" in problems_of(binary)[0]
    digits = written(tmp_path, f"[surface]\nseed = 1{'0' * 5000}")
    assert "not a TOML file: a number has too many digits" in problems_of(digits)[0]
    assert "too many brackets within each other" in problems_of(written(tmp_path, f"a = {'[' * 5000}"))[0]


def test_a_mistake_in_a_flag_is_named_as_the_flag(tmp_path: Path) -> None:
    flags = flags_of("surface", rms="-1.0", hurst="0.5")
    problems = problems_of(written(tmp_path, "[solid]\nk0 = -1"), flags)
    assert problems[0] == (
        "--hurst: not a key of a surface of kind 'gaussian', but of 'self_affine' and 'spectral'; "
        "try --surface self_affine"
    )
    assert problems[1] == "--rms: expected a number above 0.0, got -1.0"
    assert problems[2].endswith("run.toml: [solid] k0: expected a number of at least 0.0, got -1")
    assert flag_of("surface", "kind") == "--surface"
    assert flag_of("surface", "path") == "--file"
    assert flag_of("aging", "per_decade") == "--per-decade"


def test_flags_override_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "[solid]\nk0 = 2.0\nk1 = 5.0\n[contact]\nseparation = 1.0\n[aging]\nlast = 7.0")
    flags = flags_of("solid", k1="4") | flags_of("aging", times=["1,2,", "3"]) | flags_of("contact", load="9")
    config = read_config(path, flags)
    assert config.solid == SpringLattice(k0=2.0, k1=4.0)
    assert (config.contact.load, config.contact.separation) == (9.0, None)
    assert config.aging.times == [1.0, 2.0, 3.0]
    assert config.end == 3.0


def test_a_flag_for_another_kind_of_surface_takes_the_keys_of_the_old_kind_away(tmp_path: Path) -> None:
    path = written(tmp_path, "[surface]\nkind = 'self_affine'\nsize = 64\nhurst = 0.8\nseed = 5")
    config = read_config(path, flags_of("surface", kind="gaussian", shape=["32x16"]))
    assert config.surface.kind == "gaussian"
    assert (config.surface.shape, config.surface.seed) == ([32, 16], 5)
    (problem,) = problems_of(path, flags_of("surface", kind="gaussian", hurst="0.5"))
    assert problem.startswith("--hurst: not a key of a surface of kind 'gaussian'")


def test_a_surface_file_is_looked_for_beside_the_configuration(tmp_path: Path) -> None:
    surface = read_config(written(tmp_path, "[surface]\npath = 'a.npy'"), {}).surface
    assert isinstance(surface, MeasuredSurface)
    assert Path(surface.path) == tmp_path / "a.npy"
    words: Any = flags_for("surface", "preparation")
    flags = words(surface_path="a.npy", surface_channel="2", surface_unit="µm")
    by_flag = read_config(None, given(flags)).surface
    assert isinstance(by_flag, MeasuredSurface)
    assert (by_flag.path, by_flag.channel, by_flag.unit) == ("a.npy", 2, "um")


def test_a_flag_for_another_measure_of_roughness_replaces_the_first(tmp_path: Path) -> None:
    path = written(tmp_path, "[surface]\nkind = 'spectral'\nspacing = 0.5\nrms_height = 2.0")
    surface = read_config(path, flags_of("surface", rms_slope="0.1")).surface
    assert isinstance(surface, Spectral)
    assert (surface.rms_height, surface.rms_slope, surface.spacing) == (None, 0.1, [0.5])
    both = flags_of("surface", kind="spectral", rms_slope="0.1", rms_curvature="2")
    made = read_config(None, both).surface
    with pytest.raises(InputError, match="expected one of rms_height, rms_slope, rms_curvature"):
        made.build()


def test_surfaces_know_their_lattice_their_law_and_where_they_come_from() -> None:
    surfaces: list[tuple[Any, Any]] = [
        (Independent(shape=[4, 6], rms=2.0), GaussianHeights(2.0)),
        (Independent(kind="exponential", shape=[9], rms=0.5), ExponentialHeights(0.5)),
        (SelfAffine(size=8), None),
        (Spectral(shape=[8, 4], spacing=[0.5, 0.25], unit="nm"), None),
    ]
    for surface, law in surfaces:
        built = surface.build()
        assert built.shape == surface.lattice
        assert repr(surface.law) == repr(law)
        assert surface.model_dump(exclude_none=True).items() <= built.provenance.items()


def test_a_spectral_surface_has_lengths_where_they_have_a_unit() -> None:
    built = Spectral(shape=[8, 4], spacing=[0.5, 0.25], unit="nm").build()
    assert (built.unit, built.pixel_size, built.length_unit) == ("nm", (0.5, 0.25), "nm")
    assert built.provenance["pixel_size"] == [0.5, 0.25]
    bare = Spectral(shape=[8], spacing=[0.5]).build()
    assert (bare.has_lengths, bare.pixel_size) == (False, (0.5,))


def test_how_a_file_is_prepared_is_checked() -> None:
    assert file_surface(Path("a.npy"), {"tilt": "mean"}).tilt == "mean"
    with pytest.raises(ConfigError, match=r"--max-undefined: expected a number below 1\.0, got 2\.0"):
        file_surface(Path("a.npy"), {"max_undefined": 2.0})


@pytest.mark.parametrize(
    "config",
    [
        RunConfig(),
        RunConfig(surface=SelfAffine(size=64, hurst=1 / 3, delta=1e-17)),
        RunConfig(surface=Spectral(shape=[8, 4], rms_slope=0.1, spacing=[0.5, 1e-9], unit="um")),
        RunConfig(surface=MeasuredSurface(path="/a", crop=[0.0, 1.5], crop_unit="um", pixel_size=[0.25])),
        RunConfig(surface=MeasuredSurface(path='/a "b"\\c\tü\x7f\n.npy', channel=0, unit="rms")),
        RunConfig(aging=Aging(times=[0.1, 1 / 3, 1e29]), output=Output(maps_at=[], figures=["svg", "pdf"])),
        RunConfig.model_validate(
            {"protocol": [{"kind": "repeat", "count": 2, "legs": [{"kind": "hold", "duration": 1.0}]}]}
        ),
    ],
)
def test_what_is_written_reads_back_as_the_very_same(tmp_path: Path, config: RunConfig) -> None:
    text = to_toml(config)
    tomllib.loads(text)
    assert read_config(written(tmp_path, text), {}) == config
    assert from_tables(json.loads(json.dumps(to_tables(config)))) == config
    assert pickle.loads(pickle.dumps(config)) == config  # as it goes to other processes


def test_words_of_flags_become_numbers_or_are_left_to_the_check() -> None:
    for word in ("0.1,1,10", "0.1 1 10"):
        assert read_config(None, flags_of("aging", times=[word])).aging.times == [0.1, 1.0, 10.0]
    assert read_config(None, flags_of("aging", times=["1,2,3"])).aging.times == [1.0, 2.0, 3.0]
    for words in (["0,5"], ["1", "2,5e3"]):  # a comma that may be a decimal mark
        (problem, *_) = problems_of(None, flags_of("aging", times=words))
        assert "--times: expected a number, got" in problem
        assert "for two values" in problem
    (problem,) = problems_of(None, flags_of("aging", per_decade="2.7"))
    assert problem == "--per-decade: expected a whole number, got 2.7"
    (problem,) = problems_of(None, flags_of("surface", shape=["20,twenty"]))
    assert problem == "--shape: expected a whole number, got 'twenty'"


def test_every_key_has_one_flag_and_its_help() -> None:
    sections = ("surface", "preparation", "solid", "contact", "aging", "friction", "carried", "output")
    keys = {(section, key.name) for section, key in flags_for(*sections).keys.values()}
    models = {name: models_of(name) for name in ORDER}
    assert keys == {
        (section, key) for section, known in models.items() for model in known for key in model.model_fields
    } - {("solid", "draws")}  # which are for files alone
    for known in models.values():
        for model in known:
            assert all(field.description for key, field in model.model_fields.items() if key != "kind")


def test_only_what_is_close_is_suggested() -> None:
    for word, known, meant in (
        ("rnu", ["run", "fit"], "run"),
        ("K1", ["k0", "k1"], "k1"),
        ("gausian", ["gaussian"], "gaussian"),
        ("pressure", ["surface", "load"], None),
        ("E", ["R", "k0"], None),
    ):
        assert closest(word, known) == meant


@pytest.mark.parametrize("text", ["[solid]\n{keys}", "{sections}", "[[protocol]]\nkind = 'hold'\n{keys}"])
def test_of_many_mistakes_the_first_are_told_at_once(tmp_path, text):
    count = 20_000
    keys, sections = ("\n".join(f"{form.format(n)}" for n in range(count)) for form in ("m{0} = 1", "[m{0}]"))
    (tmp_path / "run.toml").write_text(text.format(keys=keys, sections=sections), encoding="utf-8")
    begin = time.process_time()
    with pytest.raises(ConfigError) as raised:
        read_config(tmp_path / "run.toml", {})
    assert time.process_time() - begin < 2.0  # comparing each with all names takes longer
    assert len(raised.value.problems) == count + ("protocol" in text)  # which misses its duration
    *told, rest = raised.value.shown
    assert told == raised.value.problems[:10]
    assert rest == f"... and {len(raised.value.problems) - 10:,} more"
    assert str(raised.value) == "; ".join(raised.value.shown)


def test_what_a_terminal_does_not_show_is_escaped(tmp_path):
    for read in (asp.surfaces.read, asp.campaign.read_plan, asp.campaign.open):
        with pytest.raises(InputError) as raised:
            read(tmp_path / "a\0b")
        assert "a\\x00b" in str(raised.value)
        assert "digits" not in str(raised.value)
        assert str(raised.value).isprintable()


def test_a_mistake_of_any_length_is_a_line(tmp_path):
    name = "k" * 300_000
    (tmp_path / "run.toml").write_text(f"[solid]\n{name} = 1\n[{name}]\n", encoding="utf-8")
    with pytest.raises(ConfigError) as raised:
        read_config(tmp_path / "run.toml", {})
    assert len(raised.value.problems) == 2
    assert all(len(problem) < 500 for problem in raised.value.problems)
    assert raised.value.problems[0].endswith("hardness")


def test_a_ramp_from_no_load_may_be_repeated() -> None:
    ramps = [{"kind": "ramp", "duration": 1.0, "load": load} for load in (3.0, 1.0)]
    legs = {"kind": "repeat", "count": 2, "legs": ramps}
    config = config_from({"contact": {"load": 0.0}, "protocol": [legs]}, {}, None)
    assert [leg.end for leg in config.written_out] == [3.0, 1.0, 3.0, 1.0]
