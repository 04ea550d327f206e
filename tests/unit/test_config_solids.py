"""Solids in the configuration: what each kind takes, numbers with units, and how mistakes are named."""

import json
import tomllib

import numpy as np
import pytest

import asperity as asp
from asperity.app.cli.flags import flags_for, given
from asperity.app.config import config_from
from asperity.app.config.models import RunConfig
from asperity.app.config.reading import from_tables, read_config, to_tables, to_toml
from asperity.app.config.solids import HalfSpace, Layer, SpringLattice
from asperity.app.runs import Progress, execute
from asperity.base.words import has_unit, numbers, written_with_units
from asperity.errors import ConfigError
from asperity.lattice import Lattice
from tests.refusals import refuses

LATTICE = Lattice((8, 8), (0.5, 0.25))


def configured(folder, text):
    path = folder / "run.toml"
    path.write_text(text, encoding="utf-8")
    return read_config(path, {})


def flagged(section, **words):
    return read_config(
        None, given(flags_for(section)(**{f"{section}_{key}": word for key, word in words.items()}))
    )


def spectra(solid):
    return list(vars(solid.on(LATTICE)).values())


@pytest.mark.parametrize(
    ("text", "solid"),
    [
        ("[solid]\nk1 = 5.0", asp.solids.spring_lattice(k0=1.0, k1=5.0)),
        ("[solid]\nkind = 'half_space'\nmodulus = 3.0", asp.solids.half_space(modulus=3.0)),
        (
            "[solid]\nkind = 'half_space'\nmodulus = '3.8 GPa'\nbranches = [[0.3, '10 ms'], [0.3, 1]]",
            asp.solids.half_space(modulus=3.8e9, branches=[(0.3, 0.01), (0.3, 1.0)]),
        ),
        (
            "[solid]\nkind = 'half_space'\nyoung = [2.0, 4.0]\npoisson = [0.5, 0.0]\napparatus = inf",
            asp.solids.half_space(modulus=1 / (0.75 / 2 + 1 / 4), apparatus=np.inf),
        ),
        (
            "[solid]\nkind = 'half_space'\nmodulus = 2.0\nflow = [0.1, -1.0]",
            asp.solids.half_space(modulus=2.0, flow=(0.1, -1.0)),
        ),
        (
            "[solid]\nkind = 'layer'\nyoung = 2.0\npoisson = 0.3\nthickness = '2 um'\nfrictionless = true",
            asp.solids.layer(modulus=2 / (1 - 0.09), poisson=0.3, thickness=2e-6, bonded=False),
        ),
        (
            "[solid]\nkind = 'coated_half_space'\nmodulus = 2.0\npoisson = 0.3\nthickness = 1.0\n"
            "base_modulus = 9.0\nbase_poisson = 0.5\nbranches = [[0.5, 1.0]]",
            asp.solids.coated_half_space(
                modulus=2.0,
                poisson=0.3,
                thickness=1.0,
                base_modulus=9.0,
                base_poisson=0.5,
                branches=[(0.5, 1.0)],
            ),
        ),
    ],
)
def test_a_table_makes_the_solid_that_python_makes_and_is_written_back_the_same(tmp_path, text, solid):
    config = configured(tmp_path, text)
    assert config.solid.build().kind == solid.kind
    for here, there in zip(spectra(config.solid.build()), spectra(solid), strict=True):
        np.testing.assert_allclose(here, there, rtol=1e-12)
    again = configured(tmp_path, to_toml(config))
    assert again == config
    assert from_tables(json.loads(json.dumps(to_tables(config)))) == config


def test_flags_say_the_same():
    config = flagged("solid", kind="half_space", modulus="3.8GPa", branches=["0.3 10 ms", "0.3,1"])
    assert config.solid == HalfSpace(modulus=3.8e9, branches=[(0.3, 0.01), (0.3, 1.0)])
    assert flagged("solid", kind="half_space", modulus="1", flow=["0.1 2"]).solid.flow == (0.1, 2.0)
    two = flagged("solid", kind="half_space", young=["3.8 GPa", "2e11"], poisson=["0.37", "0.3"]).solid
    assert two.young == [3.8e9, 2e11]
    layer = flagged("solid", kind="layer", modulus="1", poisson="0.5", thickness="2 um", frictionless=True)
    assert layer.solid == Layer(modulus=1.0, poisson=[0.5], thickness=2e-6, frictionless=True)
    assert flagged("solid", k1="4").solid == SpringLattice(k1=4.0)


def test_a_flag_for_another_kind_takes_the_keys_of_the_old_kind_away(tmp_path):
    path = tmp_path / "run.toml"
    path.write_text("[solid]\nkind = 'layer'\nmodulus = 2.0\npoisson = 0.3\nthickness = 1.0\n")
    config = read_config(path, {"solid": {"kind": "half_space", "poisson": [0.3], "young": [1.0]}})
    assert config.solid == HalfSpace(young=[1.0], poisson=[0.3])


def test_numbers_with_units_are_in_si_and_remembered_as_such():
    config = flagged("contact", pressure="1.5 MPa")
    assert config.contact.pressure == 1.5e6
    assert [one.written for one in written_with_units(config.model_dump())] == ["1.5 MPa"]
    assert list(written_with_units(from_tables(to_tables(RunConfig())).model_dump())) == []
    assert tomllib.loads(to_toml(config))["contact"] == {"pressure": 1.5e6}
    assert flagged("aging", times=["1s", "1 h"]).aging.times == [1.0, 3600.0]
    assert [has_unit(word) for word in ("1e5", "10 ms", "1e5Pa", "3", "0,5", "1 µm", "m")] == [
        *(False, True, True, False, False, True, False)
    ]
    assert numbers(["10 ms", "3"], whole=False) == ["10 ms", 3]


def test_times_follow_the_relaxation_times():
    branches = ["0.3 10 ms", "0 1e-9", "0.3 100"]
    assert flagged("solid", kind="half_space", modulus="1", branches=branches).span == (1e-3, 1e3)
    assert flagged("solid", kind="half_space", modulus="1").span == (1e-3, 1e6)
    assert flagged("aging", first="1 ms", last="10").span == (1e-3, 10.0)


def with_a_table(folder, last):
    """A half-space of which a table up to a last time is known."""
    series, times = asp.relaxation.PronySeries(3e9, ((0.2, 0.1), (0.3, 10.0))), np.geomspace(0.01, last, 40)
    rows = "\n".join(f"{t:.6e},{e / 1e6:.10g}" for t, e in zip(times, series.modulus_at(times), strict=True))
    (folder / "pmma.csv").write_text(f"time_s,E_MPa\n{rows}\n")
    return "[solid]\nkind = 'half_space'\nrelaxation = 'pmma.csv'\npoisson = 0.5\n"


def test_a_table_of_relaxation_gives_branches_and_modulus(tmp_path):
    text = f"{with_a_table(tmp_path, 1e4)}per_decade = 2.0"
    config = configured(tmp_path, text)
    fitted = asp.relaxation.fit(asp.relaxation.read(tmp_path / "pmma.csv"), per_decade=2).series
    assert config.solid.maxwell == list(fitted.branches)
    assert config.solid.contact_modulus == pytest.approx(fitted.modulus / 0.75, rel=1e-12)
    resolved = config.solid.resolved()
    assert (resolved.relaxation, resolved.poisson) == (None, None)
    for here, there in zip(spectra(resolved.build()), spectra(config.solid.build()), strict=True):
        np.testing.assert_array_equal(here, there)
    assert config.span == (0.01, 1e4)
    for late in ("last = 2e4", "times = [1e-3, 1.0]", "first = 1e-3"):
        with pytest.raises(ConfigError, match="relaxation: expected a table of the times to record"):
            configured(tmp_path, f"{text}\n[aging]\n{late}")
    stiffer = configured(tmp_path, f"{text}\nyoung = 4e9")
    assert stiffer.solid.resolved().contact_modulus == pytest.approx(4e9 / 0.75)
    assert stiffer.solid.maxwell == config.solid.maxwell


def test_mistakes_in_flags_are_named_as_flags():
    for words, line in (
        ({"kind": "layer", "modulus": "1", "poisson": "0.3"}, "--thickness: expected a value, got none"),
        (
            {"modulus": "1"},
            "--modulus: not a key of a solid of kind 'spring_lattice', but of 'half_space'",
        ),
        ({"kind": "half_space", "modulus": "1", "branches": ["0.5"]}, "--branch: expected pairs of numbers"),
    ):
        with pytest.raises(ConfigError) as caught:
            flagged("solid", **words)
        assert caught.value.problems[0].startswith(line)


def test_a_zero_with_a_unit_has_a_unit(tmp_path):
    text = "[solid]\nkind = 'half_space'\nmodulus = 1.0\n[contact]\nload = 1.0\n[output]\nmaps_at = ['0 s']\n"
    config = configured(tmp_path, text)
    (found,) = written_with_units(config.model_dump())
    assert (found, found.written) == (0.0, "0 s")
    with refuses("units"):
        execute(config, Progress())


def test_a_flag_switches_the_creep_of_a_file_off_or_to_another():
    solid = {"kind": "half_space", "modulus": 4e9, "creep": "eyring", "temperature": 300.0}
    solid |= {"creep_energy": 2e-19, "creep_volume": 5e-28, "creep_prefactor": 1.0}
    law: dict[str, object] = {"creep_rate": 2.0, "creep_stress": 3.0}
    norton = law | {"creep": "norton", "creep_exponent": 4.0}
    none: dict[str, object] = {"creep": "none"}
    for flags, left in ((none, {}), (law, law | {"creep": "eyring"}), (norton, norton)):
        found = config_from({"solid": solid}, {"solid": flags}, None).solid.model_dump(exclude_none=True)
        assert {key: value for key, value in found.items() if "creep" in key or key == "temperature"} == left


def test_a_hold_longer_than_its_table_needs_a_plateau(tmp_path):
    text = with_a_table(tmp_path, 100.0)
    with pytest.raises(ConfigError, match='try extrapolate = "plateau"'):
        configured(tmp_path, f"{text}[aging]\nlast = 500.0")
    text += "extrapolate = 'plateau'\n"
    assert configured(tmp_path, text).span == pytest.approx((0.01, 100.0))
    config = configured(tmp_path, f"{text}[aging]\nlast = 500.0\nper_decade = 1\n[surface]\nshape = [16, 16]")
    outcome = execute(config, Progress())
    assert "beyond the last time of the table, 100 s, the modulus is assumed to stay" in outcome.remarks
    assert "extrapolate" not in to_toml(outcome.config)  # the branches hold it
    with pytest.raises(ConfigError, match=r"got one of 0.01 to inf$"):
        configured(tmp_path, f"{text}[aging]\nfirst = 0.001\nlast = 500.0")
