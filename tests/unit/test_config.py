"""The configuration: what it accepts, the solids that it makes, how it names every mistake, and as Python."""

import gc
import json
import pickle
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli.flags import flags_for, given
from asperity.app.config import MeasuredSurface, config_from
from asperity.app.config.keys import Key, sections
from asperity.app.config.mistakes import Door
from asperity.app.config.python import to_python
from asperity.app.config.reading import config_at, file_surface, read_config, to_tables, to_toml
from asperity.app.runs import Progress, execute, recorded_times
from asperity.app.runs.pipeline import height_law
from asperity.ask.run import ORDER, Aging, Output, RunConfig
from asperity.ask.section import KINDS as SECTIONS
from asperity.ask.section import keys_of_maker
from asperity.ask.solid import SOLIDS, HalfSpace
from asperity.ask.surface import SURFACES
from asperity.base.words import has_unit, numbers, written_with_units
from asperity.errors import ConfigError, InputError
from asperity.lattice import Lattice
from asperity.protocols.legs import KINDS as KINDS_OF_LEGS
from asperity.solids import Solid
from asperity.theory import ExponentialHeights, GaussianHeights
from tests.refusals import refuses

JUDGES = Path(__file__).parents[1] / "judges"
KINDS: Any = SURFACES | SOLIDS
Gaussian, Exponential, SelfAffine, Spectral, SpringLattice, Layer = map(
    KINDS.get, ("gaussian", "exponential", "self_affine", "spectral", "spring_lattice", "layer")
)


def written(folder: Path, text: str) -> Path:
    path = folder / "run.toml"
    path.write_text(text, encoding="utf-8")
    return path


def configured(folder: Path, text: str) -> RunConfig:
    return read_config(written(folder, text), {})


def problems_of(path: Path | None, flags: dict[str, dict[str, object]] | None = None) -> list[str]:
    with pytest.raises(ConfigError) as caught:
        read_config(path, flags or {})
    return caught.value.problems


def flags_of(section: str, **words: object) -> dict[str, dict[str, object]]:
    """What the flags of a section give that were written with these words."""
    made: Any = flags_for(section)
    return given(made(**{f"{section}_{key}": word for key, word in words.items()}))


def flagged(section: str, **words: object) -> Any:
    return read_config(None, flags_of(section, **words))


def test_without_a_file_the_conditions_are_the_papers() -> None:
    config = read_config(None, {})
    assert config == RunConfig(
        surface=Gaussian(shape=[200, 200], rms=1.0),
        solid=SpringLattice(k0=1.0, k1=3.0, R=1.0),
    )


def test_every_mistake_has_its_line(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        """
        surface = { shap = [20, 20], hurst = 0.5, rms = -1, seed = 1.5 }
        solid = { K1 = 3, k0 = "one" }
        contcat = { load = 2 }
        aging = { hold = "laod" }
        output = { figures = ["jpg"] }
        """,
    )
    problems = problems_of(path)
    assert all(line.startswith(f"{path}: ") and "\n" not in line for line in problems)
    assert [line.removeprefix(f"{path}: ") for line in problems] == [
        "[surface] shap: no such key; try shape",
        "[surface] hurst: not a key of a surface of kind 'gaussian', but of 'self_affine' and 'spectral'; "
        'try kind = "self_affine"',
        "[solid] K1: no such key; try k1",
        "[contcat]: no such section; try contact",
        "[surface] rms: expected a finite number > 0, got -1",
        "[surface] seed: expected a whole number from 0 to 9223372036854775807, got 1.5",
        "[solid] k0: expected a finite number >= 0 and <= 1e+30, got 'one'",
        "[aging] hold: expected one of 'load' or 'separation', got 'laod'; try hold = \"load\"",
        "[output] figures: expected one of 'png', 'pdf' or 'svg', got 'jpg'; try figures = \"png\"",
    ]


HALF = "[solid]\nkind = 'half_space'\n"
STIFF = f"{HALF}modulus = 1.0\n"
MISTAKES = [
    "solid = 3",
    "[surface]\nkind = 'file'",
    "[surface]\nshape = [3, 3, 3]",
    "[surface]\nkind = 'self_affine'\nsize = 100",
    "[solid]\nk0 = nan",
    f"[solid]\nk0 = 1{'0' * 400}",
    "[solid]\nR = 1e100",
    "[solid]\ncreep_rate = 1.0",
    "[solid]\ncreep = 'garofalo'\ncreep_rate = 1.0\ncreep_stress = 1.0",
    "[solid]\ncreep = 'eyring'\ncreep_rate = 1.0",
    f"{HALF}modulus = 1.0\ndata_last = 1.0",
    f"{HALF}modulus = 1.0\nbranches = [[0.1, 1.0]]\nextrapolate = 'model'",
    f"{HALF}relaxation = 'none.csv'\npoisson = 0.3",
    f"{STIFF}branches = [[0.6, 1.0], [0.5, 2.0]]",
    f"{STIFF}branches = [[1.5, 1.0]]",
    f"{STIFF}branches = [0.5]",
    f"{STIFF}creep_energy = 1.0\ntemperature = 300.0",
    f"{STIFF}per_decade = 2.0",
    f"{STIFF}permanent = 0.3",
    f"{STIFF}permanent = 0.01\ncreep = 'eyring'\ncreep_rate = 1.0\ncreep_stress = 1.0",
    "[contact]\nload = '1 MPa'",
    "[contact]\nload = 0.0",
    "[aging]\ntimes = [2.0, 1.0]",
    "[[protocol]]\nkind = 'ramp'\nduration = 1.0",
    "[[protocol]]\nkind = 'slide'\ndistance = 1.0\nvelocity = 1.0\ndirection = 'z'",
    "[[protocol]]\nkind = 'repeat'\ncount = 2\nlegs = [{kind = 'step', load = '1 Pa'}]",
    "[output]\nmaps_at = [1e9]",
    "[output]\nfigures = 'png'",
]
BALL = "[surface]\nkind = 'sphere'\nradius = 9.0\npixel_size = 1.0\n"
UNKNOWN = {
    "k0 = 3": "k0: stands outside any section; it belongs below [solid]",
    "nonsense = 3": "nonsense: stands outside any section",
    "[sweep]\nload = [1.0]": "[sweep]: makes this the file of a campaign, not of a run; try",
    "[surface]\nfile = 'a.npy'": "[surface] file: no such key; try path",
    "[solid]\nE = 1.0": "[solid] E: no such key; try young",
    f"{BALL}spacing = 1.0": "[surface] spacing: no such key; try pixel_size",
    "[solid]\nmodulus = 1.0": "[solid] modulus: not a key of a solid of kind 'spring_lattice', but",
    HALF: "[solid]: expected modulus, young and poisson, or relaxation and poisson, got none",
    f"{STIFF}young = 1.0": "[solid]: modulus and young: expected exactly one of them, got",
    f"{STIFF}poisson = 0.3": "[solid] poisson: expected none: the contact modulus contains it",
    f"{STIFF}branches = [[0.5, 1.0]]\nflow = [1.0, 2.0]": "[solid] flow: expected no branches beside it, got",
    "[contact]\nload = 1\nseparation = 1": "[contact]: expected load or separation, got both",
    "[contact]\npressure = 1.0\nload = 1.0\nseparation = 1.0": "[contact]: expected load or pressure or",
    "[aging]\nfirst = 10.0\nlast = 1.0": "[aging] last: expected more than first, 10, got 1",
    "[aging]\ntimes = [1.0, 2.0]\nlast = 3.0": "[aging]: expected times or last, got both",
    "[[protocol]]\nkind = 'hold'\nduration = 1.0\nmobilty = 2.0": "protocol[0] mobilty: no such key; try",
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
    assert "not a TOML file: too many digits, or brackets within each other" in problems_of(digits)[0]
    gc.collect()  # finalizers of what other tests left cannot run where the stack ends
    deep = written(tmp_path, f"a = {'[' * 5000}")
    assert "too many digits, or brackets within each other" in problems_of(deep)[0]


def test_a_mistake_in_a_flag_is_named_as_the_flag(tmp_path: Path) -> None:
    flags = flags_of("surface", rms="-1.0", hurst="0.5")
    problems = problems_of(written(tmp_path, "[solid]\nk0 = -1"), flags)
    assert problems[0] == (
        "--hurst: not a key of a surface of kind 'gaussian', but of 'self_affine' and 'spectral'; "
        "try --surface self_affine"
    )
    assert problems[1] == "--rms: expected a finite number > 0, got -1.0"
    assert problems[2].endswith("run.toml: [solid] k0: expected a finite number >= 0 and <= 1e+30, got -1")


def test_flags_override_the_file(tmp_path: Path) -> None:
    path = written(tmp_path, "[solid]\nk0 = 2.0\nk1 = 5.0\n[contact]\nseparation = 1.0\n[aging]\nlast = 7.0")
    flags = flags_of("solid", k1="4") | flags_of("aging", times=["1,2,", "3"]) | flags_of("contact", load="9")
    config = read_config(path, flags)
    assert config.solid == SpringLattice(k0=2.0, k1=4.0)
    assert (config.contact.load, config.contact.separation) == (9.0, None)
    assert (config.aging.times, config.end) == ([1.0, 2.0, 3.0], 3.0)
    for word in ("0.1,1,10", "0.1 1 10"):
        assert flagged("aging", times=[word]).aging.times == [0.1, 1.0, 10.0]


def test_a_file_without_a_kind_has_no_keys_of_other_kinds(tmp_path: Path) -> None:
    path = written(tmp_path, "[surface]\npath = 'scan.npy'\nshape = [3, 3]")
    assert "[surface] shape: not a key of a surface of kind 'file'" in problems_of(path)[0]


def test_a_flag_for_another_kind_takes_the_keys_of_the_old_kind_away(tmp_path: Path) -> None:
    path = written(tmp_path, "[surface]\nkind = 'self_affine'\nsize = 64\nhurst = 0.8\nseed = 5")
    config = read_config(path, flags_of("surface", kind="gaussian", shape=["32x16"]))
    assert config.surface == Gaussian(shape=[32, 16], seed=5)
    (problem,) = problems_of(path, flags_of("surface", kind="gaussian", hurst="0.5"))
    assert problem.startswith("--hurst: not a key of a surface of kind 'gaussian'")
    written(tmp_path, "[solid]\nkind = 'layer'\nmodulus = 2.0\npoisson = 0.3\nthickness = 1.0\n")
    config = read_config(path, {"solid": {"kind": "half_space", "poisson": [0.3], "young": [1.0]}})
    assert config.solid == HalfSpace(young=[1.0], poisson=[0.3])
    assert HalfSpace(young=[1.0]) == HalfSpace(young=[1.0], poisson=[0.35])
    # So does one for another measure of the roughness.
    written(tmp_path, "[surface]\nkind = 'spectral'\nspacing = 0.5\nrms_height = 2.0")
    surface = read_config(path, flags_of("surface", rms_slope="0.1")).surface
    assert surface == Spectral(rms_slope=0.1, spacing=[0.5])
    with pytest.raises(ConfigError, match="--surface: expected --rms-slope or --rms-curvature, got both"):
        flagged("surface", kind="spectral", rms_slope="0.1", rms_curvature="2")


def test_a_flag_switches_the_creep_of_a_file_off_or_to_another() -> None:
    solid = {"kind": "half_space", "modulus": 4e9, "creep": "eyring", "temperature": 300.0}
    solid |= {"creep_energy": 2e-19, "creep_volume": 5e-28, "creep_prefactor": 1.0}
    law: dict[str, object] = {"creep_rate": 2.0, "creep_stress": 3.0}
    norton = law | {"creep": "norton", "creep_exponent": 4.0}
    none: dict[str, object] = {"creep": "none"}
    for flags, left in ((none, {}), (law, law | {"creep": "eyring"}), (norton, norton)):
        found = config_from({"solid": solid}, {"solid": flags}, None).solid.table
        assert {key: value for key, value in found.items() if "creep" in key or key == "temperature"} == left


def test_other_branches_are_not_those_of_the_data_of_a_file() -> None:
    solid = {
        "kind": "half_space",
        "modulus": 1.0,
        "branches": [[0.3, 1.0]],
        "data_first": 0.1,
        "data_last": 9.0,
    }
    others: list[dict[str, object]] = [{"branches": [[0.2, 30.0]]}, {"flow": [1.0, 1.0]}]
    for flags in others:
        assert config_from({"solid": solid}, {"solid": flags}, None).solid.known is None
    later = config_from({"solid": solid}, {"solid": {"data_last": 90.0}}, None)
    assert later.solid.known == (0.1, 90.0)


def test_a_surface_file_is_looked_for_beside_the_configuration_and_how_it_is_prepared_is_checked(tmp_path):
    surface = configured(tmp_path, "[surface]\npath = 'a.npy'").surface
    assert isinstance(surface, MeasuredSurface)
    assert Path(surface.path) == tmp_path / "a.npy"
    words: Any = flags_for("surface", "preparation")
    flags = words(surface_path="a.npy", surface_channel="2", surface_unit="µm")
    assert read_config(None, given(flags)).surface == MeasuredSurface(path="a.npy", channel=2, unit="um")
    both: dict[str, Any] = {"pixel_size": ["250 nm", "0.5 um"], "length_unit": "um"}
    for keys, sides in ((both, [0.25, 0.5]), ({"pixel_size": "0.25 um"}, [0.25])):
        measured = MeasuredSurface(path="a.npy", **keys)
        assert (measured.pixel_size, measured.length_unit) == (pytest.approx(sides), "um")
    assert file_surface(Path("a.npy"), {"tilt": "mean"}).tilt == "mean"
    with pytest.raises(ConfigError, match=r"--max-undefined: .*got 2\.0"):
        file_surface(Path("a.npy"), {"max_undefined": 2.0})


def test_surfaces_know_their_lattice_their_law_their_lengths_and_where_they_come_from() -> None:
    nanometers = Spectral(shape=[8, 4], spacing=[0.5, 0.25], unit="nm")
    surfaces: list[tuple[Any, Any]] = [
        (Gaussian(shape=[4, 6], rms=2.0), GaussianHeights(2.0)),
        (Exponential(shape=[9], rms=0.5), ExponentialHeights(0.5)),
        (SelfAffine(size=8), None),
        (nanometers, None),
    ]
    for surface, law in surfaces:
        built = surface.build()
        assert built.shape == surface.lattice
        assert repr(height_law(surface)) == repr(law)
        assert surface.table.items() <= built.provenance.items()
    built = nanometers.build()
    assert (built.unit, built.pixel_size, built.length_unit) == ("nm", (0.5, 0.25), "nm")
    assert built.provenance["pixel_size"] == [0.5, 0.25]
    bare = Spectral(shape=[8], spacing=[0.5]).build()
    assert (bare.has_lengths, bare.pixel_size) == (False, (0.5,))


def test_what_is_written_reads_back_as_the_very_same(tmp_path: Path) -> None:
    ramps = [{"kind": "ramp", "duration": 1.0, "load": load} for load in (3.0, 1.0)]
    repeated = [{"kind": "repeat", "count": 2, "legs": ramps}]
    from_no_load = RunConfig.read({"contact": {"load": 0.0}, "protocol": repeated})
    assert [leg.arguments["load"] for leg in from_no_load.written_out] == [3.0, 1.0, 3.0, 1.0]
    for config in (
        RunConfig(),
        RunConfig(surface=SelfAffine(size=64, hurst=1 / 3, delta=1e-17)),
        RunConfig(surface=MeasuredSurface(path="/a", crop=[0.0, 1.5], crop_unit="um", pixel_size=[0.25])),
        RunConfig(surface=MeasuredSurface(path='/a "b"\\c\tü\x7f\n.npy', channel=0, unit="rms")),
        RunConfig(aging=Aging(times=[0.1, 1 / 3, 1e29]), output=Output(maps_at=[], figures=["svg", "pdf"])),
        from_no_load,
    ):
        assert configured(tmp_path, to_toml(config)) == config
        assert RunConfig.read(json.loads(json.dumps(to_tables(config)))) == config
        assert pickle.loads(pickle.dumps(config)) == config  # as it goes to other processes


def spectra(solid: Solid) -> list[Any]:
    return list(vars(solid.on(Lattice((8, 8), (0.5, 0.25)))).values())


def test_pairs_are_one_word_or_two() -> None:
    config = flagged("solid", kind="half_space", modulus="3.8GPa", branches=["0.3 10 ms", "0.3,1"])
    assert config.solid == HalfSpace(modulus=3.8e9, branches=[(0.3, 0.01), (0.3, 1.0)])


def test_numbers_with_units_are_in_si_and_remembered_as_such() -> None:
    config = flagged("contact", pressure="1.5 MPa")
    assert config.contact.pressure == 1.5e6
    assert [one.written for one in written_with_units(config.tables)] == ["1.5 MPa"]
    assert list(written_with_units(RunConfig().tables)) == []
    assert tomllib.loads(to_toml(config))["contact"] == {"pressure": 1.5e6}
    assert flagged("aging", times=["1s", "1 h"]).aging.times == [1.0, 3600.0]
    with_units = [word for word in ("1e5", "10 ms", "1e5Pa", "3", "0,5", "1 µm", "m") if has_unit(word)]
    assert with_units == ["10 ms", "1e5Pa", "1 µm"]
    assert numbers(["10 ms", "3"], whole=False) == ["10 ms", 3]
    zero = {"contact": {"load": 1.0}, "output": {"maps_at": ["0 s"]}}
    config = config_from(zero | {"solid": {"kind": "half_space", "modulus": 1.0}}, {}, None)
    assert [(one, one.written) for one in written_with_units(config.tables)] == [(0.0, "0 s")]
    with refuses("quantities", "'0 s'"):
        execute(config, Progress())


def test_times_follow_the_relaxation_times() -> None:
    branches = ["0.3 10 ms", "0.3 100"]
    assert flagged("solid", kind="half_space", modulus="1", branches=branches).span == (1e-3, 1e3)
    assert flagged("solid", kind="half_space", modulus="1").span == (1e-3, 1e6)
    assert flagged("aging", first="1 ms", last="10").span == (1e-3, 10.0)


def with_a_table(folder: Path, last: float) -> str:
    """A half-space of which a table up to a last time is known."""
    series, times = asp.relaxation.PronySeries(3e9, ((0.2, 0.1), (0.3, 10.0))), np.geomspace(0.01, last, 40)
    rows = "\n".join(f"{t:.6e},{e / 1e6:.10g}" for t, e in zip(times, series.modulus_at(times), strict=True))
    (folder / "pmma.csv").write_text(f"time_s,E_MPa\n{rows}\n")
    return "[solid]\nkind = 'half_space'\nrelaxation = 'pmma.csv'\npoisson = 0.5\n"


def test_a_table_of_relaxation_gives_branches_and_modulus(tmp_path: Path) -> None:
    text = f"{with_a_table(tmp_path, 1e4)}per_decade = 2.0"
    config: Any = configured(tmp_path, text)
    fitted = asp.relaxation.fit(asp.relaxation.read(tmp_path / "pmma.csv"), per_decade=2).series
    assert config.solid.resolved().branches == list(fitted.branches)
    assert config.solid.build().modulus == pytest.approx(fitted.modulus / 0.75, rel=1e-12)
    resolved = config.solid.resolved()
    assert (resolved.relaxation, resolved.poisson, resolved.known) == (None, [0.5], (0.01, 1e4))
    usual: Any = configured(tmp_path, text.replace("poisson = 0.5", "")).solid
    assert usual.build().modulus == pytest.approx(fitted.modulus / (1 - 0.35**2), rel=1e-12)
    for here, there in zip(spectra(resolved.build()), spectra(config.solid.build()), strict=True):
        np.testing.assert_array_equal(here, there)
    assert config.span == (0.01, 1e4)
    for late in ("last = 2e4", "times = [1e-3, 1.0]", "first = 1e-3"):
        with pytest.raises(ConfigError, match="relaxation: "):
            configured(tmp_path, f"{text}\n[aging]\n{late}")
    stiffer: Any = configured(tmp_path, f"{text}\nyoung = 4e9").solid
    assert stiffer.resolved().build().modulus == pytest.approx(4e9 / 0.75)
    assert stiffer.resolved().branches == config.solid.resolved().branches


def test_a_hold_longer_than_its_table_needs_a_plateau(tmp_path: Path) -> None:
    text = with_a_table(tmp_path, 100.0)
    with pytest.raises(ConfigError, match='try extrapolate = "plateau", or branches'):
        configured(tmp_path, f"{text}[aging]\nlast = 500.0")
    text += "extrapolate = 'plateau'\n"
    assert configured(tmp_path, text).span == pytest.approx((0.01, 100.0))
    config = configured(tmp_path, f"{text}[aging]\nlast = 500.0\nper_decade = 1\n[surface]\nshape = [16, 16]")
    outcome = execute(config, Progress())
    assert "the modulus is assumed to stay after the last time of the table, 100 s" in outcome.remarks
    assert "extrapolate" not in to_toml(outcome.config)  # the branches hold it
    with pytest.raises(ConfigError, match=r"got 0.01 to inf s$"):
        configured(tmp_path, f"{text}[aging]\nfirst = 0.001\nlast = 500.0")


def test_every_key_has_one_flag() -> None:
    sections = ("surface", "preparation", "solid", "contact", "aging", "friction", "carried", "output")
    keys = {(section, key.name) for section, key in flags_for(*sections).keys.values()}
    known = {(section, key) for section in ORDER for one in SECTIONS[section].values() for key in one.keys}
    known |= {("surface", "kind"), ("solid", "kind")}
    assert keys == known - {("solid", "draws")}  # which are for files alone


def test_of_many_mistakes_the_first_are_told_at_once_and_one_of_any_length_is_a_line(tmp_path: Path) -> None:
    count = 10_000
    keys, sections = ("\n".join(form.format(n) for n in range(count)) for form in ("m{} = 1", "[m{}]"))
    leg = "[[protocol]]\nkind = 'hold'\nduration = 1.0"
    path = written(tmp_path, f"[solid]\n{keys}\n{leg}\n{keys}\n{sections}")
    begin = time.process_time()
    with pytest.raises(ConfigError) as raised:
        read_config(path, {})
    assert time.process_time() - begin < 2.0  # comparing each with all names takes longer
    problems = raised.value.problems
    assert len(problems) == 3 * count
    assert raised.value.shown == [*problems[:10], f"... and {len(problems) - 10:,} more"]
    assert str(raised.value) == "; ".join(raised.value.shown)
    name = "k" * 300_000
    first, second = problems_of(written(tmp_path, f"[solid]\n{name} = 1\n[{name}]\n"))
    assert max(len(first), len(second)) < 500
    assert first.endswith("creep_exponent")


def test_what_a_terminal_does_not_show_is_escaped(tmp_path: Path) -> None:
    for read in (asp.surfaces.read, asp.campaign.read_plan, asp.campaign.open):
        with pytest.raises(InputError) as raised:
            read(tmp_path / "a\0b")
        assert "a\\x00b" in str(raised.value)
        assert "digits" not in str(raised.value)
        assert str(raised.value).isprintable()


MAXWELL = {"kind": "half_space", "modulus": 3.1e9, "branches": [[0.3, 0.1], [0.2, 7.0]]}
SHORT = {"first": 0.1, "last": 20.0, "per_decade": 2}
RAMPS = [{"kind": "ramp", "duration": 0.7, "load": 30.0}]
RAMPS += [{"kind": "ramp", "duration": 0.1, "load": 20.0, "mobility": 0.5}]
LEGS = [{"kind": "hold", "duration": 3.0, "hold": "area"}, {"kind": "step", "load": 15.0}]
RUNS: dict[str, dict[str, Any]] = tomllib.loads((JUDGES / "questions.toml").read_text("utf-8"))["run"] | {
    "repeated": {
        "surface": {"shape": [24, 24], "rms": 0.7, "seed": 3},
        "contact": {"load": 60.0},
        "aging": {"per_decade": 2},
        "protocol": [*LEGS, {"kind": "repeat", "count": 2, "legs": RAMPS}],
        "quick": True,
    }
}


def completed(tables: dict[str, Any]) -> tuple[RunConfig, Any]:
    tables = {"aging": {} if "protocol" in tables else SHORT, **tables}
    outcome = execute(config_from(tables, {}, None), Progress())
    return outcome.config, outcome.dataset


def repeated(tables: dict[str, Any]) -> dict[str, Any]:
    """What the Python text of a run leaves, whose numbers are those of the run."""
    config, dataset = completed(tables)
    text = to_python(config, recorded_times(config).tolist())
    assert max(map(len, text.splitlines())) <= 110
    found: dict[str, Any] = {}
    exec(compile(text, "<copied>", "exec"), found)
    again = found["history"].dataset
    for name in ("time", "area", "energy", "load", "separation"):
        assert np.array_equal(again[name].values, dataset[name].values)
    if "limit" in found:
        assert found["limit"].energy == dataset.attrs["relaxed_energy"]
    return found


@pytest.mark.filterwarnings("ignore::asperity.errors.Remark")
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[] if RUNS[name].get("quick") else [pytest.mark.slow]) for name in RUNS],
)
def test_the_text_gives_the_same_numbers(name, capsys, monkeypatch) -> None:
    monkeypatch.chdir(JUDGES)
    repeated({part: keys for part, keys in RUNS[name].items() if part != "quick"})
    assert capsys.readouterr().out.startswith("<History: ")


def test_a_measured_surface_and_a_spectrum_are_read_again(tmp_path: Path) -> None:
    path = tmp_path / "it's a 'scan'.npy"
    np.save(path, np.random.default_rng(0).normal(size=(14, 12)))
    surface: dict[str, Any] = {"kind": "file", "path": str(path), "periodic": "taper", "file_unit": "nm"}
    surface |= {"crop": [0, 12, 0, 12], "pixel_size": [3e-8], "length_unit": "m"}
    repeated({"surface": surface, "solid": MAXWELL})
    for shape in ([16, 12], [64]):
        power = 2 + len(shape)
        (tmp_path / "psd.csv").write_text(f"q_1/um,C_nm^{power}\n0.1,4e12\n1,4e12\n4,1e10\n")
        surface = {"kind": "spectrum", "path": str(tmp_path / "psd.csv"), "shape": shape, "unit": "um"}
        found = repeated({"surface": surface | {"spacing": [0.5], "seed": 2}, "solid": MAXWELL})
        assert found["rough"].heights.std() > 0.01 * 10.0 ** (-3 * (power - 2) / 2)


def test_a_load_that_is_left_open_is_refused() -> None:
    with refuses("contact", "none"):
        to_python(config_from({}, {}, None), [1.0])


def accepts(home: tuple[str, str], key: Key, value: object) -> bool:
    """Whether a section takes a value for a key, whatever it says of others."""
    section, kind = home
    keys = keys_of_maker(KINDS_OF_LEGS[kind]) if section == "protocol" else SECTIONS[section][kind].keys
    try:
        keys[key.name].read(key.name, value)
    except InputError:
        return False
    return True


def listed(key: Key, value: object) -> object:
    return [value] * (2 if key.name == "crop" else 1) if key.several else value


def value_of(key: Key, value: float) -> object:
    return listed(key, int(value) if key.what in ("whole", "wholes") else float(value))


def test_what_is_said_of_a_key_is_what_its_model_takes() -> None:
    everything = {
        (section, kind): keys for section, kinds in sections().items() for kind, keys in kinds.items()
    }
    for model, keys in everything.items():
        for key in keys.values():
            assert key.description
            check_bounds(model, key)
            check_values(model, key)
            if key.unit:
                assert accepts(model, key, listed(key, f"2 {key.unit}"))
                assert not accepts(model, key, listed(key, "2 Pa" if key.unit == "K" else "2 K"))
    assert [next(iter(kinds)) for kinds in sections().values()][:2] == ["gaussian", "spring_lattice"]


def check_bounds(model: tuple[str, str], key: Key) -> None:
    for bound, excluded, outside in (
        (key.least, key.above, lambda x: x - max(1, abs(x) / 10)),
        (key.most, key.below, lambda x: x + max(1, abs(x) / 10)),
    ):
        if bound is not None:
            assert accepts(model, key, value_of(key, bound)) is not excluded
            assert not accepts(model, key, value_of(key, outside(bound)))


def check_values(model: tuple[str, str], key: Key) -> None:
    if key.choices:
        assert all(accepts(model, key, listed(key, word)) for word in key.choices)
        assert not accepts(model, key, listed(key, "nonsense"))
    if key.default is not None:
        assert accepts(model, key, key.default)
    assert not accepts(model, key, {"a": "table"})
    whole = key.what in ("whole", "wholes", "text or whole")
    if whole or key.what in ("number", "numbers"):
        between = 0.5 * (max(key.least or 0.0, -1.0) + min(key.most or 1.0, 1.0))
        assert accepts(model, key, listed(key, between)) is not whole
    assert accepts(model, key, "1 nonsense") is (key.what in ("path", "text", "texts", "text or whole"))


def test_mistakes_of_a_question_and_of_its_sections_come_together(tmp_path):
    file = tmp_path / "law.toml"
    file.write_text("[law]\npressurs = [1.0]\n[contact]\nlode = 3.0\n[sweep]\nseed = [1]\n")
    with pytest.raises(ConfigError) as refused:
        config_at(Door({}, file), question="law")
    assert [one.path for one in refused.value.mistakes] == [
        ("sweep",),
        ("contact", "lode"),
        ("law", "pressurs"),
        ("law", "pressures"),
    ]
