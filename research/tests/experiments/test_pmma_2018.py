"""PMMA on PMMA: the effective load by a sum of small loads, and the analysis on areas that are known."""

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

import asperity as asp
from asperity_research.experiments import comparing, pmma_2018
from asperity_research.studies.evidence import Evidence

DATA = Path(os.environ.get("ASPERITY_DATA", Path(__file__).resolve().parents[3].parent / "shared" / "data"))


def test_the_effective_load_is_that_of_an_integrator():
    # J by its relaxation integral: tau_b dL_b/dt = L - L_b with L = F + sum g_b L_b.
    shares, times = np.transpose(pmma_2018.SERIES.branches)

    def rate(time, internal):
        return (min(time / 2.4, 1.0) + shares @ internal - internal) / times

    at = np.array(pmma_2018._TIMES)
    found = solve_ivp(rate, (0.0, 1000.0), [0.0, 0.0], "LSODA", at, rtol=1e-9, atol=1e-12, max_step=0.5)
    known = np.minimum(at / 2.4, 1.0) + shares @ found.y
    assert np.allclose(pmma_2018.effective(), known, rtol=2e-5)
    assert pmma_2018.growth_of_effective_load() == pytest.approx(1.1746, abs=5e-5)


GROWTH = {"fit": 1.1746, "longer": 1.240, "eyring": 1.0}
DROP = {"fit": 0.2636, "longer": 0.30, "eyring": 0.2636}
SURFACES = np.array([990.0, 1000.0, 1010.0])[:, np.newaxis]


def known(name):
    """Areas whose growth, drop and rest are known: all solids but the second like what was measured."""
    held = np.array([0.0, *pmma_2018._TIMES])
    after = 1000.0 + np.array([0.0, *pmma_2018._AFTER])
    legs = np.repeat([0, 1, 2, 3], [2, held.size - 2, 1, after.size - 1])
    course = 1 + (GROWTH[name] - 1) * np.log10(np.maximum(held, 1e-3) / 10) / 2
    areas = SURFACES * np.append(course, np.full(after.size, DROP[name]))
    where = {"seed": np.arange(3), "time": np.append(held, after), "leg": ("time", legs)}
    return xr.Dataset({"contact_area_corrected": (("seed", "time"), areas)}, where)


def test_the_verdicts_on_known_areas():
    axes, elastic = ("seed", "pressure", "time"), (SURFACES * [1.0, 1.1746])[..., np.newaxis]
    pressed = xr.Dataset({"contact_area_corrected": (axes, elastic)}, {"seed": np.arange(3), "time": [0.0]})
    outcome = pmma_2018.analyse(
        Evidence(Path(), {name: known(name) for name in GROWTH} | {"elastic": pressed})
    )
    verdicts = {finding.key: finding.verdict for finding in outcome.findings}
    assert len(verdicts) == 12
    assert set(verdicts.values()) == {"agrees", "differs"}
    differ = {key for key, verdict in verdicts.items() if verdict == "differs"}
    assert differ == {"growth fit", "growth eyring", "drop longer"}
    (share,) = (m.estimate for f in outcome.findings if f.key == "growth fit" for m in f.measured)
    assert share.value == pytest.approx(0.1746 / (3.20 / 2.58 - 1))
    # The error of the reading alone: 0.007 mm^2 of both areas.
    error = 3.20 / 2.58 * np.hypot(0.007 / 3.20, 0.007 / 2.58) / (3.20 / 2.58 - 1)
    assert share.high - share.value == pytest.approx(1.96 * error * share.value, rel=1e-6)
    assert len(pmma_2018.draw(outcome.tables).axes) == 2


def test_scans_of_ones_own(tmp_path):
    rough = asp.surfaces.spectral((48, 48), hurst=0.8, rms_slope=0.1, seed=3)
    np.save(tmp_path / "a.npy", rough)
    with pytest.raises(asp.errors.InputError, match="unit of length"):
        comparing.comparison_of("pmma-2018", [tmp_path / "a.npy"])
    with pytest.raises(asp.errors.InputError, match="not about a scan"):
        comparing.comparison_of("ptfe-2009", [tmp_path / "a.npy"])


def test_a_whole_comparison_on_scans_by_the_command(tmp_path, asperity):
    topography = pytest.importorskip("SurfaceTopography")
    for seed in (1, 2):
        rough = asp.surfaces.spectral(
            (64, 64), hurst=0.8, rms_slope=0.1, roll_off=32.0, cutoff=4.0, seed=seed
        )
        topography.Topography(rough, (64.0, 64.0), unit="um").to_netcdf(tmp_path / f"{seed}.nc")
    scans = [word for seed in (1, 2) for word in ("--surface", tmp_path / f"{seed}.nc")]
    words = ("experiment", "pmma-2018", "--out", tmp_path / "own", *scans, "--workers", "1")
    status, out, error = asperity(*words, "--dry-run")
    assert status == 0, error
    assert "10 runs" in out.splitlines()[-1]
    status, out, error = asperity(*words, "--quiet")
    assert (status, out) == (0, ""), error
    verdicts = pd.read_csv(tmp_path / "own" / "verdicts.csv")
    assert " ".join(verdicts.columns) == "claim what value low high expected_low expected_high verdict"
    of = verdicts.set_index("claim")
    assert 1.0 < of["value"]["At light load the area grows like the effective load"] < 1.3
    elastic = of.loc["The area is that of an elastic solid at the effective load"]
    assert set(elastic["verdict"]) <= {"agrees", "undecided"}
    assert np.allclose(elastic["value"], 1.0, atol=2e-3)
    assert (tmp_path / "own" / "figure.png").stat().st_size > 10_000
