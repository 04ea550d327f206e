"""``asperity predict`` of solids that creep by a local law, yield, or have draws of their branches."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.app.config import read_config
from asperity.app.config.python import to_python
from asperity.app.runs import Progress, execute
from asperity.base.rows import words_of
from asperity.base.words import tables_to_toml
from asperity.errors import ConfigError, Remark
from asperity.figures.page import prediction_page
from tests.refusals import refuses

SURFACE: dict[str, Any] = {"hurst": 0.8, "roll_off": 3.2, "cutoff": 1.6, "rms_height": 0.05, "spacing": 0.2}
MODULUS = asp.solids.contact_modulus(3.3e9, 0.35)
LAW = asp.solids.Eyring(rate="1e-5 nm/s", stress="20 MPa")
SPAN: dict[str, Any] = {"first": 1e-2, "last": 1e3, "per_decade": 2}
TIMES = np.geomspace(1e-2, 1e3, 11)

TABLES: dict[str, Any] = {
    "surface": {"kind": "spectral", "shape": [64, 64], "unit": "um", **SURFACE},
    "solid": {
        **{"kind": "half_space", "young": "3.3 GPa", "poisson": 0.35},
        **{"creep": "eyring", "creep_rate": "1e-5 nm/s", "creep_stress": "20 MPa"},
    },
    "contact": {"pressure": "10 MPa"},
    "aging": SPAN,
}
LENGTHS: dict[str, Any] = {"file_unit": "um", "pixel_size": 0.2, "length_unit": "um"}
BRANCHES = [(0.2, 3.0), (0.2, 40.0)]
HELD: dict[str, Any] = {"pressure": "2 MPa", "first": "0.3 s", "last": "400 s"}
BRANCHED: dict[str, Any] = {"kind": "half_space", "modulus": "3 GPa", "branches": [[0.2, "3 s"], [0.2, 40.0]]}
DRAWN = {**BRANCHED, "draws": [[[0.3, "2 s"]], [[0.1, "50 s"], [0.2, 4]], [[0.3, "0.01 h"]]]}


def write(**changed):
    """The file of a run, with some sections in place of these."""
    Path("run.toml").write_text(tables_to_toml({**TABLES, **changed}))
    return Path("run.toml")


def rough(seed, sites=64):
    heights = asp.surfaces.spectral((sites, sites), **SURFACE, seed=seed)
    return asp.surfaces.Surface(heights, unit="um", pixel_size=(0.2, 0.2), length_unit="um")


def half_space(branches):
    return asp.solids.half_space(modulus="3 GPa", branches=branches)


def solids():
    branches = [(0.2, 0.1), (0.2, 10.0), (0.2, 1e3)]
    own = asp.solids.CreepLaw(
        lambda s: 1e-14 * np.sinh(np.clip(s / 2e7, -600, 600)),
        lambda s: 1e-14 / 2e7 * np.cosh(np.clip(s / 2e7, -600, 600)),
    )
    return {
        "eyring": asp.solids.half_space(modulus=MODULUS, creep=LAW),
        "norton": asp.solids.half_space(modulus=MODULUS, creep=asp.solids.Norton(1e-11, 1e8, 8)),
        "permanent": asp.solids.half_space(modulus=MODULUS, creep=LAW, permanent=0.3),
        "of its own": asp.solids.half_space(modulus=MODULUS, creep=own),
        "hard": asp.solids.half_space(modulus=MODULUS, branches=branches, hardness="0.3 GPa"),
    }


def slope(area):
    return float(np.polyfit(np.log10(TIMES), area / area[0], 1)[0])


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["eyring", "norton", "permanent", "hard"])
def test_other_surfaces_grow_within_the_band(kind):
    # The band stands for other scans of the same size: their mean is the slope of the whole surface.
    solid, others = solids()[kind], []
    for seed in range(100, 124):
        contact = asp.press(rough(seed), solid, pressure="10 MPa")
        history = asp.age(contact, TIMES, rtol=1e-3)
        others.append(slope(history.dataset["contact_area_corrected"].values[1:]))
    growths = [asp.predict(solid, rough(seed), pressure="10 MPa", **SPAN).growth for seed in range(12)]
    assert all(growth.of_table == (growth.per_decade, growth.per_decade) for growth in growths)
    low, high = np.array([growth.band for growth in growths]).T
    assert ((low <= np.mean(others)) & (np.mean(others) <= high)).sum() >= 9  # of twelve; 95 % each
    assert np.mean(high - low) == pytest.approx(2 * 1.96 * np.std(others, ddof=1), rel=0.35)


@pytest.mark.slow
def test_steps_in_time_add_little_to_the_band():
    for kind in ("eyring", "permanent", "hard"):
        ours = asp.predict(solids()[kind], rough(1), pressure="10 MPa", **SPAN)
        finer = asp.age(asp.press(rough(1), solids()[kind], pressure="10 MPa"), TIMES, rtol=2e-4)
        exact = slope(finer.dataset["contact_area_corrected"].values[1:])
        low, high = ours.growth.band
        assert ours.growth.per_decade == pytest.approx(exact, abs=0.02 * (high - low))


def test_a_law_of_its_own_is_followed_as_eyrings():
    one, other = (
        asp.predict(solids()[kind], rough(2), pressure="10 MPa", **SPAN) for kind in ("eyring", "of its own")
    )
    np.testing.assert_allclose(other.series("contact_area"), one.series("contact_area"), rtol=1e-3)
    assert one.theory is not None
    assert other.theory is None
    assert "creeps by a law of its own" in prediction_page(other, {})
    assert "v0 sinh(s/s0), v0 = 0.01 pm/s, s0 = 20 MPa" in prediction_page(one, {})


def test_where_contacts_flow_they_grow_as_theory_has_it():
    # d ln A/d ln t is at most s0/s, for contacts that do not flow yet bear a part of the load.
    law = asp.solids.Eyring(rate="1e-4 pm/s", stress="5 MPa")
    solid = asp.solids.half_space(modulus="3.8 GPa", creep=law)
    ours = asp.predict(solid, rough(3, 96), pressure="3 MPa", first=1.0, last=1e4)
    assert ours.theory is not None
    _, flowing = ours.theory
    ratio = flowing / ours.series("contact_area")
    assert ratio[-1] == pytest.approx(1.0)
    assert (ratio < 1.01).all()
    assert ratio[0] > 0.8
    grown = np.log(ours.series("contact_area")[-1] / ours.series("contact_area")[8]) / np.log(100)
    pressure = 3e6 * (96 * 0.2e-6) ** 2 / ours.series("contact_area")[12]
    assert 0.6 < grown * pressure / law.stress < 1.0


def test_another_table_under_a_hardness_has_the_area_of_its_compliance():
    # What the band of the table takes for granted there.
    time = np.geomspace(1e-2, 1e3, 26)
    modulus = 3e9 * (0.4 + 0.3 * np.exp(-time / 0.3) + 0.3 * np.exp(-time / 30))
    noise = 1 + 0.05 * np.random.default_rng(0).normal(size=26)
    tables = [asp.relaxation.Relaxation(time, modulus * by, noise=0.5) for by in (1.0, noise)]
    materials = [asp.relaxation.material(table, hardness="0.1 GPa") for table in tables]
    one, other = (asp.predict(material, rough(4), pressure="10 MPa") for material in materials)
    assert one.series("yielding_area")[0] > 50
    known, wanted = (p.fit.series.compliance_at(p.time) for p in (one, other) if p.fit is not None)
    inside = (known[0] <= wanted) & (wanted <= known[-1])
    area = np.exp(np.interp(np.log(wanted), np.log(known), np.log(one.series("contact_area_corrected"))))
    np.testing.assert_allclose(area[inside], other.series("contact_area_corrected")[inside], rtol=0.013)


def test_a_file_flags_and_python_agree(undrawn, asperity):
    whole = rough(0)
    np.savetxt("scan.txt", whole.heights)
    file = ("predict", write(), "--quiet")
    flags = ("--young", "3.3GPa", "--creep", "eyring", "--creep-rate", "1e-5nm/s", "--creep-stress", "20MPa")
    scan = "predict --surface scan.txt --file-unit um --pixel-size 0.2 --length-unit um --tilt none"
    more = "--periodic wrap --pressure 10MPa --first 10ms --last 1000s --per-decade 2 --quiet"
    for call in (
        file,
        (*scan.split(), *more.split(), *flags),
        (*file, "--permanent", "0.3", "--shear-strength", "40MPa"),
    ):
        assert asperity(*call) == (0, "", "")
    in_python = asp.predict(solids()["eyring"], whole, pressure="10 MPa", **SPAN)
    from_file, from_flags, shared = undrawn
    for ours in (from_file, from_flags):
        np.testing.assert_allclose(ours.time, in_python.time)
        np.testing.assert_allclose(ours.series("contact_area"), in_python.series("contact_area"), rtol=1e-9)
        assert ours.growth.band == pytest.approx(in_python.growth.band, rel=1e-6)
    listed = asp.predict(solids()["eyring"], whole, pressure="10 MPa", times=in_python.time)
    np.testing.assert_array_equal(listed.series("contact_area"), in_python.series("contact_area"))
    times = ("--times", *(f"{time!r}s" for time in in_python.time.tolist()))
    held = ("--periodic", "wrap", "--pressure", "10MPa", "--quiet")
    assert asperity(*scan.split(), *flags, *held, *times, "--overwrite") == (0, "", "")
    np.testing.assert_allclose(undrawn[3].series("contact_area"), from_file.series("contact_area"), rtol=1e-9)
    assert shared.friction is not None
    assert shared.words[2] == "a share of 0.3 does not creep"
    again = asp.predict(solids()["permanent"], whole, pressure="10 MPa", **SPAN)
    np.testing.assert_allclose(shared.series("contact_area"), again.series("contact_area"), rtol=1e-9)


def test_a_table_in_a_file_is_the_table(undrawn, asperity):
    time = np.geomspace(1e-2, 1e3, 16)
    columns = np.stack([time, 1000 + 2000 * np.exp(-time)], axis=-1)
    np.savetxt("table.csv", columns, delimiter=",", header="time_s,E_MPa", comments="", fmt="%.8g")
    solid = {"kind": "half_space", "relaxation": "table.csv", "poisson": 0.35, "hardness": "0.2 GPa"}
    assert asperity("predict", write(solid=solid), "--quiet") == (0, "", "")
    material = asp.relaxation.material("table.csv", hardness="0.2 GPa")
    ours = asp.predict(material, rough(0), pressure="10 MPa", per_decade=2)
    np.testing.assert_allclose(undrawn[0].series("contact_area"), ours.series("contact_area"), rtol=1e-9)
    assert undrawn[0].growth == ours.growth
    assert undrawn[0].assumed["table"] == "table.csv"
    # At 10 K more every time is shorter by Arrhenius, in a run too, whose file has the branches alone.
    warm = {"temperature": "30degC", "reference": "20degC", "activation_energy": "100 kJ/mol"}
    shifted = write(solid={**solid, **warm, "free_branches": 1}, aging={})
    section = read_config(shifted, {}).solid.resolved()
    factor = np.exp(1e5 / 8.31446261815324 * (1 / 303.15 - 1 / 293.15))
    assert section.build().relaxing[0][1] == pytest.approx(factor, rel=1e-3)
    assert not {*warm, "relaxation", "free_branches"} & section.table.keys()


def test_what_a_file_may_not_ask(refused):
    np.savetxt("scan.txt", rough(0, 16).heights)
    of_a_file: dict[str, Any] = {
        "surface": {"kind": "file", "path": "scan.txt", **LENGTHS},
        "contact": {"load": "1 mN"},
    }
    slide = {"kind": "slide", "distance": "1 um", "velocity": "1 um/s"}
    elastic = {"kind": "half_space", "young": "3.3 GPa", "poisson": 0.35}
    for changed in (
        {"aging": {"first": 1e-2}, "protocol": [slide]},
        {"aging": {**SPAN, "hold": "separation"}},
        {"aging": {**SPAN, "last": 0.1}},
        {"aging": {"times": [0.1, 1, 10]}},
        {"aging": {"times": [1, 2, 3, 4, 5]}},
        {"aging": {"first": 1, "last": 9, "per_decade": 20}},
        {"solid": {**elastic, "permanent": 0.3}},
        {"solid": {"kind": "spring_lattice"}},
        {**of_a_file, "surface": {**of_a_file["surface"], "periodic": "mirror"}},
    ):
        refused("predict", write(**changed), "-q")


def test_run_and_predict_find_the_same_on_a_scan_and_doubt_the_same(undrawn, asperity):
    scan = rough(0, 32).heights + 0.3 * np.random.default_rng(0).normal(size=(32, 1))
    scan[10:15, 4:7] = np.nan
    np.savetxt("scan.txt", scan)
    solid = {"kind": "half_space", "modulus": "3 GPa", "branches": [[0.5, "3 s"]]}
    carried = {"stiffness": True, "resistivity": "17 nOhm m"}
    file = {"surface": {"kind": "file", "path": "scan.txt", **LENGTHS}, "solid": solid, "carried": carried}
    config = read_config(write(**file), {})
    ran = execute(config, Progress())
    assert asperity("predict", "run.toml", "--quiet") == (0, "", "")
    (ours,) = undrawn
    names = ("contact_area", "contact_area_corrected", "normal_stiffness", "resistance", "separation")
    for name in names:
        np.testing.assert_allclose(ran.dataset[name].values, ours.dataset[name].values, rtol=1e-9)
    # The same pressure on four mirrored copies: the same contact on four times the area.
    copies = execute(
        read_config(write(**{**file, "surface": {**file["surface"], "periodic": "mirror"}}), {}), Progress()
    )
    for name, factor in zip(names, (4, 4, 4, 1 / 4, 1), strict=True):
        np.testing.assert_allclose(copies.dataset[name], factor * ran.dataset[name], rtol=2e-3)
    (remark,) = (one for one in copies.remarks if "copies" in one)
    assert "stiffness and resistance are those of 4 mirrored copies" in remark
    for remarks in (ran.remarks, copies.remarks, ours.remarks):
        for doubt in ("heights change", "(Persson's theory)"):
            assert len([one for one in remarks if doubt in one and "lines = 'median'" in one]) == 1
    # Levelled line by line it is no longer doubted.
    levelled = read_config(write(**{**file, "surface": {**file["surface"], "lines": "median"}}), {})
    assert not [one for one in execute(levelled, Progress()).remarks if "lines" in one]


def test_edges_of_a_scan_are_those_of_the_file(undrawn, asperity):
    np.savetxt("scan.txt", rough(0, 16).heights)
    surface = {"kind": "file", "path": "scan.txt", "periodic": "wrap", **LENGTHS}
    for output in ({"maps_at": [1.0]}, {}):
        call = ("predict", write(surface=surface, output=output), "--surface", "scan.txt", "--quiet")
        assert asperity(*call) == (0, "", "")
        assert undrawn[-1].origin["periodic_rule"] == "wrap"
        unused = "the prediction does not use [output] maps_at"
        assert (unused in undrawn[-1].remarks) == bool(output)


def test_what_does_not_grow_is_remarked():
    slow = asp.solids.half_space(modulus=MODULUS, creep=asp.solids.Eyring(rate="1e-30 m/s", stress="90 MPa"))
    for solid, said in (
        (asp.solids.half_space(modulus=MODULUS), "the contact does not grow: the solid is elastic"),
        (slow, "the contact does not grow by 1000 s: creep has not begun"),
    ):
        ours = asp.predict(solid, rough(0, 32), pressure="10 MPa", **SPAN)
        assert ours.growth.per_decade == 0
        assert said in ours.remarks


def test_single_decades_and_yielding_are_told():
    # One relaxation time: the first decades grow by nothing, and no decade by the mean.
    solid = asp.solids.half_space(modulus="3.8 GPa", branches=[(0.5, 100.0)])
    ours = asp.predict(solid, rough(0), pressure="10 MPa", **SPAN)
    slopes = [slope for *_, slope in ours.growth.decades]
    assert min(slopes) < ours.growth.band[0]
    told = dict(words_of(ours.rows()))
    ends = f"{100 * min(slopes):.3g} to {100 * max(slopes):.3g} % in each decade"
    assert f"); {ends}, {100 * slopes[-1]:.3g} % in" in told["growth per decade"]
    soft = solids()["hard"].with_hardness("0.1 GPa")
    hard = asp.predict(soft, rough(0, 32), pressure="10 MPa", **SPAN)
    data = hard.dataset
    first, last = (int(data["yielding_area"][at]) for at in (0, -1))
    lowered = int((data["permanent_indentation"].values[-1] > 0).sum())
    assert lowered >= first > 1
    said = f"{first} sites at t = 0, {last} at the end; lowered for good: {lowered} sites, by up to "
    assert dict(words_of(hard.rows()))["yielding"].startswith(said)


def test_what_python_refuses():
    springs = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
    weak = asp.solids.half_space(modulus="3 GPa", creep=asp.solids.Eyring("1 nm/s", "1 kPa"))
    for name, got, solid, how in (
        ("first", "none", solids()["eyring"], {}),
        ("material", "spring_lattice", springs, SPAN),
        ("creep", "3.66e+08", weak, SPAN),
    ):
        with refuses(name, got):
            asp.predict(solid, rough(0), pressure=1e7, **how)


@pytest.mark.parametrize(
    ("name", "got", "draws"),
    [
        *(("draws", draws, draws) for draws in ([], [BRANCHES], 3, "x")),
        ("draws[1]: share of branch 1", 0.0, [BRANCHES, [(0.0, 1.0)]]),
        ("draws[1]: relaxation time of branch 1", "1 m", [BRANCHES, [(0.2, "1 m")]]),
        ("draws[1]: branches", "1.4 together", [BRANCHES, [(0.7, 1.0), (0.7, 2.0)]]),
        ("draws[1]: branches", "abc", [BRANCHES, "abc"]),
    ],
)
def test_draws_that_are_none(name, got, draws):
    with refuses(name, got):
        asp.relaxation.material(half_space(BRANCHES), draws=draws)


@pytest.mark.slow
@pytest.mark.parametrize("ramp", [None, "0.2 s"])
def test_the_band_is_that_of_a_prediction_for_each_draw(ramp):
    heights = asp.surfaces.spectral((256, 256), spacing=50.0, hurst=0.8, rms_height=20.0, seed=3)
    units: dict[str, Any] = {"unit": "nm", "length_unit": "nm"}
    scan = asp.surfaces.Surface(heights, pixel_size=(50.0, 50.0), edges="reflecting", **units)
    random = np.random.default_rng(0)
    shares, factors = random.uniform(0.1, 0.3, (10, 2)), np.exp(random.normal(0, 0.3, (10, 2)))
    draws = np.stack([shares, factors * (3.0, 40.0)], axis=-1)
    alone = [asp.predict(half_space(one.tolist()), scan, ramp=ramp, **HELD).growth for one in draws]
    bare = asp.predict(half_space(BRANCHES), scan, ramp=ramp, **HELD)
    drawn = [
        asp.relaxation.material(half_space(BRANCHES), draws=one)
        for one in (draws.tolist(), [BRANCHES[::-1]] * 3)
    ]
    ours = asp.predict(drawn[0], scan, ramp=ramp, **HELD)
    assert (bare.draws, ours.draws, ours.assumed["draws"]) == (0, 10, 10)
    np.testing.assert_array_equal(ours.series("area"), bare.series("area"))
    slopes = np.quantile(np.repeat([one.per_decade for one in alone], 20), (0.025, 0.975))
    np.testing.assert_allclose(ours.growth.of_table, slopes, rtol=0.03)
    ratios = [one.ratio for one in alone]
    low, high = ours.growth.ratio_band
    assert low < min(ratios)
    assert high > max(ratios)
    assert high - low > 2 * np.ptp(bare.growth.ratio_band)
    assert ours.growth.of_scan == bare.growth.of_scan == bare.growth.band
    same = asp.predict(drawn[1], scan, ramp=ramp, **HELD).growth
    np.testing.assert_allclose(same.band, bare.growth.band, rtol=1e-12)
    np.testing.assert_allclose(same.ratio_band, bare.growth.ratio_band, rtol=1e-12)


def test_draws_that_a_file_may_not_have(refused):
    one, wrong = [[0.3, 2.0]], ([[0.3, 2.0], [0.8, 1.0]], [[0.3, 0.0]], [[0.3, "1 m"]], [7])
    bare = {key: BRANCHED[key] for key in ("kind", "modulus")}
    for solid in (
        *({**BRANCHED, "draws": draws} for draws in ([], [one], *([one, other] for other in wrong), "many")),
        {**bare, "draws": DRAWN["draws"]},
        {**bare, "draws": DRAWN["draws"], "flow": [1e-20, 0]},
        {**bare, "draws": DRAWN["draws"], "creep": "eyring", "creep_rate": 1e-12, "creep_stress": 1e7},
        {**BRANCHED, "draws": DRAWN["draws"], "kind": "layer", "poisson": 0.3, "thickness": "1 um"},
    ):
        refused("predict", write(solid=solid), "--quiet")
    refused("predict", "--draws", "1")
    Path("table.csv").write_text("time_s,E_MPa\n" + "".join(f"1e{n},{2000 - 90 * n}\n" for n in range(-1, 8)))
    refused("run", write(solid={**bare, "draws": DRAWN["draws"], "relaxation": "table.csv"}), "--quiet")


def test_a_prediction_of_a_file_says_what_its_band_holds(undrawn, asperity):
    toml = write(solid=DRAWN)
    for flags in ((), ("--branch", "0.2 3s"), ("--hardness", "1GPa")):
        assert asperity("predict", toml, *flags, "--quiet") == (0, "", "")
    drawn, replaced, hard = undrawn
    draws = [[(0.3, 2.0)], [(0.1, 50.0), (0.2, 4.0)], [(0.3, 36.0)]]
    material = asp.relaxation.material(half_space(BRANCHES), draws=draws)
    ours = asp.predict(material, rough(0), pressure="10 MPa", **SPAN)
    assert drawn.growth == ours.growth
    assert drawn.assumed["draws"] == 3
    assert "the band includes 3 samples of the branches" in str(words_of(drawn.rows()))
    for found, words in (
        (drawn, "solid whose numbers were given with 3 draws of its branches, a scan"),
        (drawn, "the spread of 3 draws of its branches is in the band, errors of the others are not."),
        (drawn, "The 3 draws of the branches that were given are in them ("),
        (drawn, "of the other numbers of the solid or of"),
        (replaced, "their errors are not in the band"),  # a flag takes the draws of the branches away
        (hard, "The area is taken for a function of the compliance."),
    ):
        assert words in prediction_page(found, {})
    assert "their errors are not in the band" not in prediction_page(drawn, {})
    assert " draws" not in prediction_page(replaced, {})


def test_a_run_does_not_use_draws_and_says_so_once(says):
    toml = write(solid=DRAWN)
    unused = "the run does not use [solid] draws"
    said = says("run", toml)
    assert said.count("[solid] draws") == said.count(unused) == 1
    assert "draws =" not in Path("asperity-out/config.toml").read_text()
    config = read_config(toml, {})
    assert "draws" not in to_python(config, [1.0])
    bare = config.but(solid=config.solid.but(draws=None))
    theirs, ours = execute(bare, Progress()), asp.results.load("asperity-out")
    np.testing.assert_array_equal(ours["contact_area"], theirs.dataset["contact_area"])
    assert tomllib.loads(ours.attrs["config"]) == tomllib.loads(theirs.dataset.attrs["config"])
    assert unused not in theirs.remarks


@pytest.mark.slow
def test_a_campaign_does_not_use_draws_and_says_so_once():
    swept = {"pressure": ["20 MPa", "30 MPa"]}
    with pytest.warns(Remark, match="does not use .solid. draws") as remarks:
        plan = asp.campaign.read_plan(write(solid=DRAWN, sweep=swept))
    assert sum("draws" in str(one.message) for one in remarks) == 1
    bare = asp.campaign.read_plan(write(solid=BRANCHED, sweep=swept))
    assert [run.identity for run in plan.runs] == [run.identity for run in bare.runs]
    asp.campaign.sweep(plan, "campaign", workers=1)
    with pytest.raises(ConfigError, match=r"\[sweep\] draws: cannot be swept"):
        asp.campaign.read_plan(write(solid=DRAWN, sweep={"draws": [[[[0.1, 1.0]], [[0.2, 1.0]]], []]}))
