"""The print and the spheres: on areas that are known, and the spheres as they are computed."""

from pathlib import Path

import numpy as np
import xarray as xr

from asperity_research.experiments import printed_2017, ptfe_2009, run
from asperity_research.studies.evidence import Evidence


def pressed(layer):
    """Areas like the pressure until they saturate; on the layer less by 15 %, and gaps more by 5 %."""
    pressure, surfaces = np.array(printed_2017.PRESSURES), np.array([0.99, 1.0, 1.01])[:, np.newaxis]
    part = 0.9 * pressure / (pressure + 0.9) * (0.85 if layer else 1.0)
    gap = np.full(part.shape, 1.05e-3 if layer else 1e-3) * surfaces**0.1
    axes = ("seed", "pressure", "time")
    columns = {"contact_area_corrected": 1e-2 * part * surfaces, "mean_gap": gap}
    where = {"seed": np.arange(3), "pressure": pressure, "time": [0.0]}
    return xr.Dataset({name: (axes, values[..., np.newaxis]) for name, values in columns.items()}, where)


def test_the_verdicts_on_a_print_that_is_known():
    known = {kind: pressed(kind == "layer") for kind in printed_2017.SOLIDS}
    outcome = printed_2017.analyse(Evidence(Path(), known))
    verdicts = {finding.key: finding.verdict for finding in outcome.findings}
    assert verdicts == dict.fromkeys(("lightest", "heaviest", "area"), "differs") | {"gap": "agrees"}
    assert np.allclose(outcome.tables["areas"]["ratio"], 0.85)
    assert len(printed_2017.draw(outcome.tables).axes) == 2


def test_spheres_follow_lee_and_radok(tmp_path):
    done = run("ptfe-2009", tmp_path / "spheres", quick=True, workers=1)
    assert [finding.verdict for finding in done.outcome.findings] == ["agrees"]
    # The closed form itself, by the numbers of the series: J(0) = 1/E and J(infinity) = 1/(0.4 E).
    form = done.outcome.tables["areas"]["form"]
    assert np.allclose([form.min(), form.max()], [1.0, 0.4 ** (-2 / 3)], rtol=1e-3)
    assert len(ptfe_2009.draw(done.outcome.tables).axes) == 1
    assert (tmp_path / "spheres" / "verdicts.csv").is_file()
