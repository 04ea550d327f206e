"""The ledger: every claim is judged, from the data, by code; areas of known laws give the known numbers."""

import math
import re
import tomllib
from collections import Counter
from pathlib import Path
from typing import cast

import jinja2
import numpy as np
import pytest
import xarray as xr

from asperity.base.version import __version__
from asperity.surfaces import gaussian
from asperity.theory import (
    GaussianHeights,
    exponential_growth,
    exponential_growth_paper,
    site_stiffness,
    winkler_area,
)
from asperity_research.paper import claims
from asperity_research.paper.claims import CLAIMS, ledger
from asperity_research.paper.wording import spelled
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Verdict
from asperity_research.studies.typeset import plain

pytestmark = pytest.mark.xdist_group("reproduction")  # one process computes it

DOCUMENTED = Path(__file__).parents[3] / "docs" / "data" / "paper" / "ledger.md"
EXACT = {"a0", "a1", "relaxed-full", "compliance-engine", "mean-u0", "exponential-dip", "line", "b-mobility"}


class Altered(Evidence):
    """Evidence with variables of one study replaced; each change takes the study's Dataset."""

    def __init__(self, evidence, study, **changes):
        super().__init__(evidence.folder)
        data = evidence[study]
        new = {
            name: xr.broadcast(change(data), data[name])[0].transpose(*data[name].dims)
            for name, change in changes.items()
        }
        self._opened[study] = data.assign(new)


def judged(name, evidence):
    return CLAIMS[name].judge(evidence)


def numbers(measured):
    return [float(one.estimate.value) for one in measured]


@pytest.fixture(scope="module")
def findings(evidence):
    return {finding.key: finding for finding in ledger(evidence)}


def test_every_claim_has_its_sentences():
    texts = [tomllib.loads(path.read_text("utf-8")) for path in Path(claims.__path__[0]).glob("*.toml")]
    assert sorted(name for text in texts for name in text) == sorted(CLAIMS)
    for claim in CLAIMS.values():
        spoken = claim.sentences
        assert {*spoken["measured"], *spoken.get("corrected", {})} == {*claim.ranges}, claim.name
        assert ("corrected" in spoken) == ("correction" in spoken), claim.name


def test_a_sentence_holds_its_facts():
    with_facts = spelled("{{LOAD}} at\n{{ratio(k1)}}, {{'%.3f' % theory}}", {"k1": 1e6, "theory": 0.25})
    assert plain(with_facts) == "F_N at k_1/k_0 = 1e+06, 0.250"
    assert spelled("{{per_site(8.0, 1600.0)}}").endswith(" = 0.005")
    with pytest.raises(jinja2.UndefinedError, match="theory"):
        spelled("{{theory}}")


def test_every_claim_is_judged_by_numbers(findings):
    assert len(findings) > 35
    for key, finding in findings.items():
        assert all((finding.place, finding.claim, finding.measured)), key
        for one in (*finding.measured, *finding.corrected):
            assert math.isfinite(float(one.estimate.value)), (key, one.what)
            assert one.low <= one.high
            assert math.isfinite(one.low) or math.isfinite(one.high)
    assert all(findings[key].verdict is Verdict.AGREES for key in EXACT), "without chance, on any lattice"
    assert findings["viscous-slope"].verdict is Verdict.CORRECTED


def test_the_documented_table_is_of_these_claims_and_of_a_present_version(findings):
    page = DOCUMENTED.read_text(encoding="utf-8")
    ((major, minor),) = re.findall(r"^The full reproduction, Asperity (\d+)\.(\d+)\.", page, re.MULTILINE)
    now, present = __version__.split(".")[:2]
    # As other numbers of the pages: of this minor version or of the one before.
    assert (major, int(present) - int(minor)) in [(now, 0), (now, 1)], "run the reproduction again"
    rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("| ")][1:]
    claims = [(plain(finding.claim), plain(finding.place)) for finding in findings.values()]
    assert sorted(tuple(row[:2]) for row in rows) == sorted(claims)
    counts = Counter(row[2] for row in rows)
    stated = "\n".join(f"{verdict.value.capitalize()}: {counts[verdict.value]}" for verdict in Verdict)
    assert f"simulations, {len(rows)} claims.\n{stated}" in page.replace(";\n", "\n")


@pytest.mark.parametrize(
    ("claim", "study", "name", "change"),
    [
        # Areas that shrink, that stop on the way, that stay below full contact: each claim must notice.
        ("relaxed-larger", "load", "relaxed_area", lambda d: d["relaxed_area"] * 0),
        ("relaxed-k1", "aging", "relaxed_area", lambda d: d["relaxed_area"] * 1.5),
        ("relaxed-full", "load", "relaxed_area", lambda d: d["relaxed_area"] - 1),
        ("no-lateral", "no_lateral", "area", lambda d: d["area"] * 0.9),
        ("load-drift", "separation", "load", lambda d: xr.ones_like(d["load"])),
        ("viscous-load", "separation", "load", lambda d: xr.ones_like(d["load"])),
        ("line", "line_point", "approach", lambda d: d["approach"] ** 2),
        ("compliance-engine", "point", "approach", lambda d: d["approach"] * 1.01),
        ("mean-u0", "separation", "separation", lambda d: d["separation"] + 1e-6 * d["time"]),
        ("b-mobility", "mobility", "area", lambda d: 1 + d["R"] * np.log1p(d["time"])),
    ],
)
def test_a_claim_that_is_wrong_differs(evidence, claim, study, name, change):
    assert judged(claim, Altered(evidence, study, **{name: change})).verdict is Verdict.DIFFERS


def test_exponents_of_the_load_curves(evidence):
    def power(exponent):
        return lambda d: d["sites"] * (d["load"] / d["sites"] / 30) ** exponent

    finding = judged("slope-1", Altered(evidence, "load", initial_area=power(0.7)))
    assert numbers(finding.measured) == pytest.approx([0.7] * 5, abs=1e-12)
    assert finding.verdict is Verdict.DIFFERS
    relaxed = Altered(evidence, "load", relaxed_area=power(0.8))
    assert numbers(judged("relaxed-0.8", relaxed).measured) == pytest.approx([0.8, 0], abs=1e-12)
    steep = Altered(evidence, "self_affine_load", initial_area=power(0.6))
    assert numbers(judged("self-affine-0.8", steep).measured) == pytest.approx([0.6, 0.6], abs=1e-12)
    sized = Altered(evidence, "self_affine_load", initial_area=lambda d: d["load"] ** 0.8 * d["size"] / 32)
    smaller, larger = evidence.values("self_affine_load", "size")
    assert numbers(judged("self-affine-size", sized).measured) == pytest.approx([larger / smaller], rel=1e-12)


def test_crossover_and_independent_springs(evidence):
    load = np.array(evidence.values("load", "load")) / evidence.sites("load")

    def of_springs(d, stiffness):
        k1 = d["k1"].values
        areas = np.array([winkler_area(load, stiffness(k), GaussianHeights()) for k in k1])
        return xr.DataArray(areas, dims=("k1", "load"), coords={"k1": k1}) * d["sites"]

    # Springs of stiffness k1 + 1: the crossover goes with the stiffer one.
    both = Altered(evidence, "load", initial_area=lambda d: of_springs(d, lambda k: k + 1))
    soft, stiff = numbers(judged("crossover", both).measured)
    assert soft == pytest.approx(1.01 / 1.1, rel=0.01)  # read between loads half a decade apart
    assert stiff == pytest.approx(1.01, rel=0.01)
    alone = Altered(evidence, "load", initial_area=lambda d: of_springs(d, lambda k: k))
    full, over = numbers(judged("winkler", alone).measured)
    seeds, side = evidence["load"]["seed"].values, round(evidence.sites("load") ** 0.5)
    lowest = np.mean([gaussian((side, side), seed=int(seed)).min() for seed in seeds])
    assert full == pytest.approx(-lowest, rel=0.05)  # to k0/k1 = 1/100, and the surface's own mean
    assert over == pytest.approx(1.0, abs=1e-12)


def test_parameters_of_the_saturation_law(evidence):
    def law(d):
        a, q = 1 + 0.4 / (d["load"] / 1600) ** 0.5, (d["load"] / 1600) ** 0.5
        return 100 * (a - (a - 1) / (1 + d["time"] / 0.5) ** q)

    altered = Altered(evidence, "aging", area=law, relaxed_area=lambda d: d["load"] * 0 + 200.0)
    assert max(numbers(judged("saturation", altered).measured)) < 1e-6
    assert numbers(judged("q-beta", altered).measured) == pytest.approx([0.5, 0.5], abs=1e-5)
    assert numbers(judged("c-finite", altered).measured) == pytest.approx([0, 0], abs=1e-5)
    loads = np.array(evidence.values("aging", "load"))[[0, -1]] / 1600
    fitted = (1 + 0.4 / loads**0.5) / 2  # over a limit of twice A(0)
    limits = numbers(judged("saturation-limit", altered).measured)
    assert limits == pytest.approx([*fitted, *fitted], rel=1e-4)


def test_logarithms_are_even_and_powers_are_not(evidence):
    def logarithm(d):
        return 10 * (1 + 0.3 * np.log1p(1e3 * d["time"]))

    altered = Altered(evidence, "aging", area=logarithm)
    assert numbers(judged("logarithm", altered).measured) == pytest.approx([1, 1], rel=1e-3)
    assert numbers(judged("b-load", altered).measured) == pytest.approx([0, 0], abs=1e-12)
    for claim, study in (("slope-load", "self_affine_aging"), ("hurst", "hurst")):
        late_over_early = numbers(judged(claim, Altered(evidence, study, area=logarithm)).measured)[1::2]
        assert late_over_early == pytest.approx([1] * len(late_over_early), rel=1e-3)
        power = Altered(evidence, study, area=lambda d: 10 * (1 + d["time"] ** 0.25))
        late_over_early = numbers(judged(claim, power).measured)[1::2]
        assert late_over_early == pytest.approx([10 ** (1.5 / 4)] * len(late_over_early), rel=0.02)


def growing(d, slope):
    """A/A(0) = 1 + slope ln t, late."""
    return 10 * (1 + slope * np.log1p(1e4 * d["time"]))


@pytest.mark.parametrize(
    ("claim", "study"), [("slope-stiffness", "self_affine_aging"), ("b-stiffness", "aging")]
)
def test_slopes_against_stiffness(evidence, claim, study):
    k1 = evidence.values(study, "k1")
    finding = judged(claim, Altered(evidence, study, area=lambda d: growing(d, d["k1"] / 10)))
    assert finding.verdict is Verdict.AGREES
    assert numbers(finding.measured) == pytest.approx([k1[-1] / k1[0]], rel=1e-3)
    stiffness = site_stiffness(np.array(k1))
    by_site = xr.DataArray(stiffness, dims="k1", coords={"k1": k1})
    finding = judged(claim, Altered(evidence, study, area=lambda d: growing(d, by_site / 20)))
    assert finding.verdict is Verdict.CORRECTED
    assert numbers(finding.corrected) == pytest.approx([stiffness[-1] / stiffness[0]], rel=1e-3)


def test_slope_that_depends_on_the_load(evidence):
    def steeper(d):
        return growing(d, 0.1 * (d["load"] / d["load"][0]) ** 0.3)

    for finding in (
        judged("b-load", Altered(evidence, "aging", area=steeper)),
        judged("slope-load", Altered(evidence, "self_affine_aging", area=steeper)),
    ):
        assert numbers(finding.measured)[0] == pytest.approx(0.3, rel=1e-3)
        assert finding.verdict is Verdict.DIFFERS


def test_few_contacts(evidence):
    load = float(evidence["exponential"]["held"].max())

    def start(d):
        return 1 + xr.DataArray(load / site_stiffness(d["k1"].values), coords={"k1": d["k1"].values})

    def law(d, growth_law):
        grown = [growth_law(k1, d["time"].values) for k1 in d["k1"].values]
        return 1 + (start(d) - 1) * xr.DataArray(grown, dims=("k1", "time"), coords={"k1": d["k1"].values})

    finding = judged("n-start", Altered(evidence, "exponential", initial_area=start))
    assert numbers(finding.corrected) == pytest.approx([1, 1], abs=1e-12)
    k1 = np.array(evidence.values("exponential", "k1"))
    letter = (1 + load / site_stiffness(k1)) * k1 / load
    assert numbers(finding.measured) == pytest.approx(letter, rel=1e-12)
    true = Altered(evidence, "exponential", area=lambda d: law(d, exponential_growth))
    assert numbers(judged("n-growth", true).corrected) == pytest.approx([1, 1], abs=1e-12)
    assert numbers(judged("n-slope", true).corrected) == pytest.approx([1, 1], rel=0.05)
    assert judged("n-growth", true).verdict is Verdict.CORRECTED
    printed = Altered(evidence, "exponential", area=lambda d: law(d, exponential_growth_paper))
    assert numbers(judged("n-growth", printed).measured) == pytest.approx([1, 1], abs=1e-12)
    assert numbers(judged("n-slope", printed).measured) == pytest.approx([1, 1], rel=0.05)


def test_viscous_creep(evidence):
    def tripled(d):
        return 1 + growing(d, 0.1 * (1 + 2 * (d["R_viscous"] > 0)))

    measured = numbers(judged("b-viscous", Altered(evidence, "exponential", area=tripled)).measured)
    assert measured == pytest.approx([2, 3], rel=1e-3)


class Spotted:
    """Evidence of maps: a square of 8 x 8 sites that grows by a rim and 40 strewn sites, then scatters."""

    def __init__(self):
        self.rng = np.random.default_rng(1)

    def __getitem__(self, study):
        return {"seed": xr.DataArray([0, 1], dims="seed")}

    def fields(self, study, seed):
        first, grown, relaxed = np.zeros((3, 64, 64), dtype=bool)
        first[8:16, 8:16] = True
        grown[7:17, 7:17] = True  # a rim of 36
        grown[24::5, :60:12] = True  # 8 x 5 sites apart
        relaxed.flat[self.rng.choice(np.flatnonzero(~first), 400, replace=False)] = True
        relaxed[8:16, 8:12] = True  # half of the square stays
        maps = (("field_time", "y", "x"), np.stack([first, first, grown, grown]))
        times = {"field_time": [0.0, 1.0, 100.0, 1e4]}
        return xr.Dataset({"in_contact": maps, "in_contact_relaxed": (("y", "x"), relaxed)}, coords=times)


def test_spots():
    evidence = cast(Evidence, Spotted())
    grow, detach, scattered = (judged(f"spots-{what}", evidence) for what in ("grow", "detach", "scattered"))
    assert numbers(grow.measured) == pytest.approx([36 / 76])
    assert numbers(detach.measured) == pytest.approx([0.5, 0.0])
    assert scattered.measured[0].what.startswith("index of dispersion in boxes of 2 × 2")


def test_a_number_says_the_loads_that_it_is_of(evidence):
    """Those of the effort, which differ between the quick and the full one."""
    for name in ("saturation", "saturation-limit", "q-beta", "c-finite", "b-load"):
        loads = "0.3" if name == "saturation-limit" else "0.01 to 0.3"
        assert plain(judged(name, evidence).measured[-1].what).endswith(f" = {loads}")
