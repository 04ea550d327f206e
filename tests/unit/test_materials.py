"""Materials: a half-space with what is known of it, from a table, a series, a solid, or a file."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.relaxation import PronySeries, Relaxation, material
from asperity.relaxation.materials import relaxing_of
from tests.refusals import refuses

TIME = np.geomspace(1e-2, 1e3, 21)
SERIES = PronySeries(2e9, ((0.3, 0.1), (0.4, 10.0)))
DATA = Relaxation(TIME, SERIES.modulus_at(TIME))
WARM = {"temperature": 300, "reference": 290}
SOLID = asp.solids.half_space(modulus="3 GPa", branches=[(0.2, 3.0)])


@pytest.mark.parametrize(
    ("how", "modulus"),
    [
        ({}, 2e9 / (1 - 0.35**2)),
        ({"poisson": 0.5}, 2e9 / 0.75),
        ({"modulus": "shear", "poisson": 0.4}, 2 * 2e9 / 0.6),  # 2 G/(1 - nu)
        ({"modulus": "contact"}, 2e9),
        ({"young": "3 GPa", "poisson": 0.3}, 3e9 / 0.91),  # the table gives the shares
        ({"modulus": "5 GPa"}, 5e9),
    ],
)
def test_tables_and_series_give_the_contact_modulus_and_its_branches(how, modulus):
    for source in (DATA, SERIES):
        made = material(source, **how)
        found = relaxing_of(made.solid)
        assert found.modulus == pytest.approx(modulus, rel=1e-6)
        np.testing.assert_allclose(found.branches, SERIES.branches, rtol=1e-5)
        assert (made.fit is None) == (source is SERIES)
        assert made.span == (DATA.span if source is DATA else (0.0, np.inf))
    table = material(DATA, hardness="0.1 GPa")
    assert table.solid.hardness == 1e8
    assert len(table.spread) == 1 + 200


def test_another_temperature_shifts_all_times():
    # Q/R (1/T - 1/T_ref) by hand; WLF at T_ref + c2 is a factor 10^(-c1/2).
    energy = {"temperature": "313.15 K", "reference": 293.15, "activation_energy": "100 kJ/mol"}
    arrhenius = np.exp(1e5 / 8.31446261815324 * (1 / 313.15 - 1 / 293.15))
    wlf = {"temperature": 350.0, "reference": "300 K", "wlf": (2.0, 50.0)}
    for source in (DATA, SERIES):
        for how, factor in ((energy, arrhenius), (wlf, 0.1), ({"shift": 3.0}, 3.0)):
            times = np.array(relaxing_of(material(source, **how).solid).branches)[:, 1]
            np.testing.assert_allclose(times, factor * np.array([0.1, 10.0]), rtol=1e-5)


def test_a_solid_a_file_and_draws(tmp_path):
    draws: Any = [[(0.1, 2.0)], [(0.3, "1 min")]]
    text = 'kind = "half_space"\nyoung = "3 GPa"\npoisson = 0.5\nbranches = [[0.2, "3 s"]]\n'
    file = tmp_path / "solid.toml"
    file.write_text(f'[solid]\n{text}draws = [[[0.1, "2 s"]], [[0.3, "1 min"]]]\nhardness = "1 GPa"\n')
    for made, modulus in ((material(SOLID, draws=draws), 3e9), (material(file), 4e9)):
        own, *others = made.spread
        assert own.branches == ((0.2, 3.0),)
        assert [one.branches for one in others] == [((0.1, 2.0),), ((0.3, 60.0),)]
        assert own.modulus == pytest.approx(modulus)
    assert material(file).solid.hardness == 1e9
    assert material(SOLID).spread == ()
    elastic = material(young="3 GPa", poisson=0.5).solid
    assert relaxing_of(elastic).modulus == pytest.approx(4e9)
    assert not elastic.branches
    file.write_text('[solid]\nkind = "half_space"\nmodulus = 3e9\ncreep = "none"')
    assert material(file).solid.creep is None


def test_a_file_is_read_as_that_of_a_run_and_arguments_replace_its_keys(tmp_path):
    times = np.geomspace(1e-2, 1e2, 20)
    rows = "".join(f"{t},{9 + 3 * np.exp(-t)}\n" for t in times.tolist())
    (tmp_path / "table.csv").write_text(f"time_s,G_MPa\n{rows}")
    file = tmp_path / "run.toml"
    file.write_text(
        '[solid]\nkind = "half_space"\nrelaxation = "table.csv"\npoisson = 0.5\n[contact]\nload = 1.0\n'
    )
    # Of a relaxing G at nu = 0.5 the contact modulus is 4 G.
    assert relaxing_of(material(file).solid).modulus == pytest.approx(48e6, rel=1e-3)
    assert relaxing_of(material(file, poisson=0.0).solid).modulus == pytest.approx(24e6, rel=1e-3)
    assert material(file).fit is not None
    file.write_text('[solid]\nkind = "half_space"\nyoung = 3.0\nhardnes = 1.0\n')
    with refuses("run.toml: [solid] hardnes", advice="hardness"):
        material(file)


@pytest.mark.parametrize(
    ("name", "got", "source", "how"),
    [
        ("material", "float", 3.5, {}),
        ("modulus and young", "none", None, {}),
        ("shift", "2.0", None, {"young": 1e9, "shift": 2.0}),
        ("draws", "(0.1, 1.0)", DATA, {"draws": [[(0.1, 1.0)]] * 2}),
        ("columns", "0 1", DATA, {"columns": "0 1"}),
        ("poisson", "0.3", SOLID, {"poisson": 0.3}),
        ("branches", "2", SERIES, {"branches": 2}),
        ("draws", "none", material(young=1.0).solid, {"draws": [[(0.1, 1.0)]] * 2}),
        ("modulus", "shape (2,)", DATA, {"modulus": np.array([1e9, 2e9])}),
        ("modulus", "'bulk'", DATA, {"modulus": "bulk"}),
        ("poisson", "0.6", DATA, {"modulus": "contact", "poisson": 0.6}),
        ("reference", "none", DATA, {"temperature": "20 degC"}),
        ("wlf", "(1,)", DATA, WARM | {"wlf": (1,)}),
        ("activation_energy", "neither", DATA, {"temperature": "20 degC", "reference": "0 degC"}),
        ("activation_energy", "both", DATA, WARM | {"wlf": (1, 50), "shift": 2}),
        ("configuration", "solid.toml: No such file", "solid.toml", {}),
    ],
)
def test_what_is_no_material(name, got, source, how):
    with refuses(name, got):
        material(source, **how)


@pytest.mark.parametrize(
    ("text", "name", "got"),
    [
        ("[solid", "configuration", "a.toml: not a TOML file"),
        ('[solid]\nkind = "layer"', "a.toml: [solid] kind", "'layer'"),
        ("[solid]\nmodulus = 1.0", "a.toml: [solid] kind", "None"),
        ('[solid]\nkind = "half_space"\ncreep = "glide"', "a.toml: [solid] creep", "'glide'"),
    ],
)
def test_a_file_of_something_else(text, name, got, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(text)
    with refuses(name, got):
        material("a.toml")


def test_predict_takes_what_a_material_is_made_of():
    heights = asp.surfaces.spectral((16, 16), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    scan = asp.surfaces.Surface(heights, "nm", (50.0, 50.0), "nm")
    how: dict[str, Any] = {"load": "10 uN", "first": "1 s", "last": "100 s", "per_decade": 2}
    made, bare = (asp.predict(one, scan, **how) for one in (material(DATA), DATA))
    assert made.growth == bare.growth
    series = asp.predict(material(SERIES), scan, instrument={"pixel": "0.2 um"}, **how)
    np.testing.assert_array_equal(series.series("area"), made.series("area"))
    assert series.growth.of_table == (series.growth.per_decade,) * 2
    assert series.observed[0].threshold == 0.5
