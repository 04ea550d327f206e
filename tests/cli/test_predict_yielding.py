"""``asperity predict`` of solids that creep by a local law, or yield: against simulations, and refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asperity as asp
from asperity.analysis.prediction import Prediction
from asperity.app.predict.words import report
from asperity.figures.page import prediction_page
from tests.cli.conftest import Asperity, Refused
from tests.refusals import refuses

SURFACE = {"hurst": 0.8, "roll_off": 3.2, "cutoff": 1.6, "rms_height": 0.05, "spacing": 0.2}
MODULUS = asp.solids.contact_modulus(3.3e9, 0.35)
LAW = asp.solids.Eyring(rate="1e-5 nm/s", stress="20 MPa")
SPAN: dict[str, Any] = {"first": 1e-2, "last": 1e3, "per_decade": 2}
TIMES = np.geomspace(1e-2, 1e3, 11)

ACTIVATED = (
    *("--young", "3.3GPa", "--creep", "eyring", "--creep-energy", "130 kJ/mol", "--creep-volume", "0.34nm^3"),
    *("--creep-prefactor", "1e4 m/s", "--temperature", "25degC", "--hardness", "0.5 GPa"),
)
"""Creep by its activation, as flags."""

TOML = """
[surface]
kind = "spectral"
shape = [64, 64]
hurst = 0.8
roll_off = 3.2
cutoff = 1.6
rms_height = 0.05
spacing = 0.2
unit = "um"
[solid]
kind = "half_space"
young = "3.3 GPa"
poisson = 0.35
creep = "eyring"
creep_rate = "1e-5 nm/s"
creep_stress = "20 MPa"
[contact]
pressure = "10 MPa"
[aging]
first = 1e-2
last = 1e3
per_decade = 2
"""


def rough(seed: int, sites: int = 64) -> asp.surfaces.Surface:
    heights = asp.surfaces.spectral((sites, sites), **SURFACE, seed=seed)
    return asp.surfaces.Surface(heights, unit="um", pixel_size=(0.2, 0.2), length_unit="um")


def solids() -> dict[str, asp.solids.Solid]:
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


def slope(area: Any) -> float:
    return float(np.polyfit(np.log10(TIMES), area / area[0], 1)[0])


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["eyring", "norton", "permanent", "hard"])
def test_other_surfaces_grow_within_the_band(kind: str) -> None:
    # The band stands for other scans of the same size: their mean is the slope of the whole surface.
    solid, others = solids()[kind], []
    for seed in range(100, 124):
        contact = asp.press(rough(seed), solid, pressure="10 MPa")
        history = asp.age(contact, TIMES, rtol=1e-3)
        others.append(slope(history.dataset["contact_area_corrected"].values[1:]))
    mean = np.mean(others)
    inside, widths = [], []
    for seed in range(12):
        growth = asp.predict(solid, rough(seed), pressure="10 MPa", **SPAN).growth
        inside.append(growth.band[0] <= mean <= growth.band[1])
        widths.append(growth.band[1] - growth.band[0])
        assert growth.of_table == (growth.per_decade, growth.per_decade)
    assert sum(inside) >= 9  # of twelve; 95 % each
    assert np.mean(widths) == pytest.approx(2 * 1.96 * np.std(others, ddof=1), rel=0.35)


def test_steps_in_time_add_little_to_the_band() -> None:
    for kind in ("eyring", "permanent", "hard"):
        ours = asp.predict(solids()[kind], rough(1), pressure="10 MPa", **SPAN)
        finer = asp.age(asp.press(rough(1), solids()[kind], pressure="10 MPa"), TIMES, rtol=2e-4)
        exact = slope(finer.dataset["contact_area_corrected"].values[1:])
        low, high = ours.growth.band
        assert ours.growth.per_decade == pytest.approx(exact, abs=0.02 * (high - low))


def test_a_law_of_its_own_is_followed_as_eyrings() -> None:
    one, other = (
        asp.predict(solids()[kind], rough(2), pressure="10 MPa", **SPAN) for kind in ("eyring", "of its own")
    )
    np.testing.assert_allclose(other.series("contact_area"), one.series("contact_area"), rtol=1e-3)
    assert one.theory is not None
    assert other.theory is None
    assert "creeps by a law of its own" in prediction_page(other, {})
    assert "v0 sinh(s/s0), v0 = 0.01 pm/s, s0 = 20 MPa" in prediction_page(one, {})


def test_where_contacts_flow_they_grow_as_theory_has_it() -> None:
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


def test_another_table_under_a_hardness_has_the_area_of_its_compliance() -> None:
    # What the band of the table takes for granted there.
    time = np.geomspace(1e-2, 1e3, 26)
    modulus = 3e9 * (0.4 + 0.3 * np.exp(-time / 0.3) + 0.3 * np.exp(-time / 30))
    noise = 1 + 0.05 * np.random.default_rng(0).normal(size=26)
    tables = [asp.relaxation.Relaxation(time, modulus * by, noise=0.5) for by in (1.0, noise)]
    one, other = (asp.predict(table, rough(4), pressure="10 MPa", hardness="0.1 GPa") for table in tables)
    assert one.fit is not None
    assert other.fit is not None
    assert one.series("yielding_area")[0] > 50
    known, wanted = (p.fit.series.compliance_at(p.time) for p in (one, other) if p.fit is not None)
    inside = (known[0] <= wanted) & (wanted <= known[-1])
    area = np.exp(np.interp(np.log(wanted), np.log(known), np.log(one.series("contact_area_corrected"))))
    np.testing.assert_allclose(area[inside], other.series("contact_area_corrected")[inside], rtol=0.013)


def test_a_file_flags_and_python_agree(undrawn: list[Prediction], tmp_path: Path, asperity: Asperity) -> None:
    whole = rough(0)
    np.savetxt(tmp_path / "scan.txt", whole.heights)
    (tmp_path / "run.toml").write_text(TOML)
    file = ("predict", tmp_path / "run.toml", "--quiet", "--out", tmp_path / "out")
    lengths = ("--file-unit", "um", "--pixel-size", "0.2", "--length-unit", "um", "--tilt", "none")
    flags = ("--young", "3.3GPa", "--creep", "eyring", "--creep-rate", "1e-5nm/s", "--creep-stress", "20MPa")
    more = ("--pressure", "10MPa", "--first", "10ms", "--last", "1000s", "--per-decade", "2")
    surface = ("predict", "--surface", tmp_path / "scan.txt", *lengths, "--periodic", "wrap")
    assert asperity(*file) == (0, "", "")
    assert asperity(*surface, *flags, *more, "--quiet", "--out", tmp_path / "out") == (0, "", "")
    assert asperity(*file, "--permanent", "0.3", "--shear-strength", "40MPa") == (0, "", "")
    undrawn.append(asp.predict(solids()["eyring"], whole, pressure="10 MPa", **SPAN))
    from_file, from_flags, shared, in_python = undrawn
    for ours in (from_file, from_flags):
        np.testing.assert_allclose(ours.time, in_python.time)
        np.testing.assert_allclose(ours.series("contact_area"), in_python.series("contact_area"), rtol=1e-9)
        assert ours.growth.band == pytest.approx(in_python.growth.band, rel=1e-6)
    assert asperity(*surface, *ACTIVATED, *more, "--quiet", "--out", tmp_path / "out") == (0, "", "")
    law = undrawn[-1].solid.creep
    assert isinstance(law, asp.solids.Eyring)
    assert law.stress == pytest.approx(1.380649e-23 * 298.15 / 0.34e-27)
    assert shared.friction is not None
    assert shared.words[2] == "a share of 0.3 does not creep"
    again = asp.predict(solids()["permanent"], whole, pressure="10 MPa", **SPAN)
    np.testing.assert_allclose(shared.series("contact_area"), again.series("contact_area"), rtol=1e-9)


def test_a_table_in_a_file_is_the_table(
    undrawn: list[Prediction], tmp_path: Path, asperity: Asperity
) -> None:
    time = np.geomspace(1e-2, 1e3, 16)
    lines = [f"{t:.8g},{1000 + 2000 * np.exp(-t):.8g}" for t in time]
    (tmp_path / "table.csv").write_text("\n".join(["time_s,E_MPa", *lines]))
    solid = "relaxation = 'table.csv'\npoisson = 0.35\nhardness = '0.2 GPa'"
    text = TOML[: TOML.index("young")] + solid + TOML[TOML.index("\n[contact]") :]
    (tmp_path / "run.toml").write_text(text)
    assert asperity("predict", tmp_path / "run.toml", "--quiet", "--out", tmp_path / "out") == (0, "", "")
    ours = asp.predict(tmp_path / "table.csv", rough(0), pressure="10 MPa", hardness="0.2 GPa", per_decade=2)
    np.testing.assert_allclose(undrawn[0].series("contact_area"), ours.series("contact_area"), rtol=1e-9)
    assert undrawn[0].growth == ours.growth
    assert undrawn[0].assumed["table"] == "table.csv"


def test_what_a_file_may_not_ask(refused: Refused) -> None:
    times, law = (
        "first = 1e-2\nlast = 1e3\nper_decade = 2",
        'creep_rate = "1e-5 nm/s"\ncreep_stress = "20 MPa"',
    )
    slide = "\n[[protocol]]\nkind = 'slide'\ndistance = '1 um'\nvelocity = '1 um/s'"
    scan = (
        '[surface]\nkind = "file"\npath = "scan.txt"\nfile_unit = "um"\npixel_size = 0.2\nlength_unit = "um"'
    )
    np.savetxt("scan.txt", rough(0, 16).heights)
    of_a_file = (TOML[: TOML.index("[solid]")], f"{scan}\n"), ('pressure = "10 MPa"', 'load = "1 mN"')
    for changes in (
        [("last = 1e3\nper_decade = 2", slide)],
        [("per_decade = 2", "per_decade = 2\nhold = 'separation'")],
        [("[aging]", "[friction]\nrate_coefficient = 0.1\n[aging]")],
        [("last = 1e3\nper_decade = 2", "last = 0.1\nper_decade = 2")],
        [(times, "times = [0.1, 1, 10]")],
        [(times, "times = [1, 2, 3, 4, 5]")],
        [(times, "first = 1\nlast = 9\nper_decade = 20")],
        [("poisson = 0.35\n", "")],
        [('creep = "eyring"', 'creep = "none"\npermanent = 0.3')],
        [(f'creep = "eyring"\n{law}', "permanent = 0.3")],
        [("half_space", "spring_lattice"), (TOML[TOML.index("young") : TOML.index("[contact]")], "")],
        [*of_a_file],
        [*of_a_file, ("pixel_size = 0.2", 'pixel_size = 0.2\nperiodic = "mirror"')],
    ):
        text = TOML
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        Path("run.toml").write_text(text)
        refused("predict", "run.toml", "-q")


def test_edges_of_a_scan_are_those_of_the_file(
    undrawn: list[Prediction], tmp_path: Path, asperity: Asperity
) -> None:
    np.savetxt(tmp_path / "scan.txt", rough(0, 16).heights)
    lengths = 'path = "scan.txt"\nfile_unit = "um"\npixel_size = 0.2\nlength_unit = "um"'
    surface = f'[surface]\nkind = "file"\n{lengths}\nperiodic = "wrap"\n'
    text = surface + TOML[TOML.index("[solid]") :]
    file = tmp_path / "run.toml"
    file.write_text(text + "[output]\nmaps_at = [1.0]\n")
    call = ("predict", file, "--surface", tmp_path / "scan.txt", "--quiet", "--out", tmp_path / "out")
    assert asperity(*call) == (0, "", "")
    assert undrawn[0].origin["periodic_rule"] == "wrap"
    assert "a prediction does not use [output] maps_at" in undrawn[0].remarks
    file.write_text(text)
    assert asperity(*call[:-1], tmp_path / "other") == (0, "", "")
    assert not any("does not use" in remark for remark in undrawn[1].remarks)


def test_what_does_not_grow_is_remarked() -> None:
    slow = asp.solids.half_space(modulus=MODULUS, creep=asp.solids.Eyring(rate="1e-30 m/s", stress="90 MPa"))
    for solid, said in (
        (asp.solids.half_space(modulus=MODULUS), "nothing grows: the solid is elastic"),
        (slow, "the contact does not grow by 1000 s: creep has not begun"),
    ):
        ours = asp.predict(solid, rough(0, 32), pressure="10 MPa", **SPAN)
        assert ours.growth.per_decade == 0
        assert said in ours.remarks


def test_single_decades_and_yielding_are_told() -> None:
    # One relaxation time: the first decades grow by nothing, and no decade by the mean.
    solid = asp.solids.half_space(modulus="3.8 GPa", branches=[(0.5, 100.0)])
    ours = asp.predict(solid, rough(0), pressure="10 MPa", **SPAN)
    slopes = [slope for *_, slope in ours.growth.decades]
    assert min(slopes) < ours.growth.band[0]
    told = dict(report(ours, seconds=1.0))
    assert told["in each decade"].startswith(
        f"{100 * min(slopes):.3g} to {100 * max(slopes):.3g} % of the first area, {100 * slopes[-1]:.3g} % in"
    )
    soft = solids()["hard"].with_hardness("0.1 GPa")
    hard = asp.predict(soft, rough(0, 32), pressure="10 MPa", **SPAN)
    lowered = hard.dataset["permanent_indentation"].values
    first, last = (int((one > 0).sum()) for one in lowered[[0, -1]])
    assert first > 1
    words = dict(report(hard, seconds=1.0))["yields"].split()
    assert (int(words[0]), int(words[7])) == (first, last)


def test_what_python_refuses() -> None:
    solid = solids()["eyring"]
    with refuses("protocol"):
        asp.predict(solid, rough(0), pressure=1e7, protocol=[asp.protocols.Slide(1e-6, 1e-6)], **SPAN)  # type: ignore[arg-type]
    with refuses("first"):
        asp.predict(solid, rough(0), pressure=1e7)
    with refuses("poisson"):
        asp.predict(solid, rough(0), pressure=1e7, poisson=0.3, **SPAN)
    with refuses("material"):
        asp.predict(asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0), rough(0), pressure=1e7, **SPAN)
    weak = asp.solids.half_space(modulus="3 GPa", creep=asp.solids.Eyring("1 nm/s", "1 kPa"))
    with refuses("creep"):
        asp.predict(weak, rough(0), pressure=1e7, **SPAN)
