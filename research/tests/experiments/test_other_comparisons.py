"""The print and the spheres: on areas that are known, and the spheres as they are computed."""

from pathlib import Path

import numpy as np
import xarray as xr

from asperity_research.experiments import printed_2017, ptfe_2009, run
from asperity_research.studies.evidence import Evidence
from asperity_research.studies.ledger import Verdict


class Pressed(Evidence):
    """Areas in proportion to the pressure until they saturate; a tenth and a half less on the layer."""

    def __getitem__(self, study):
        pressure = np.array(printed_2017.PRESSURES)
        part = 0.9 * pressure / (pressure + 0.9) * (0.85 if study == "layer" else 1.0)
        area = 1e-2 * part * np.array([0.99, 1.0, 1.01])[:, np.newaxis]
        gap = np.full_like(area, 1.05e-3 if study == "layer" else 1e-3) * np.array([[0.999], [1.0], [1.001]])
        where = {"seed": np.arange(3), "pressure": pressure, "time": [0.0]}
        axes = ("seed", "pressure", "time")
        columns = {
            "contact_area_corrected": (axes, area[..., np.newaxis]),
            "mean_gap": (axes, gap[..., np.newaxis]),
        }
        return xr.Dataset(columns, where)


def test_the_verdicts_on_a_print_that_is_known():
    outcome = printed_2017.analyse(Pressed(Path()))
    verdicts = {finding.key: finding.verdict for finding in outcome.findings}
    assert verdicts == {
        "lightest": Verdict.DIFFERS,
        "heaviest": Verdict.DIFFERS,
        "area": Verdict.DIFFERS,
        "gap": Verdict.AGREES,
    }
    assert np.allclose(outcome.tables["areas"]["ratio"], 0.85)
    assert len(printed_2017.draw(outcome.tables).axes) == 2


def test_spheres_follow_lee_and_radok(tmp_path):
    done = run("ptfe-2009", tmp_path / "spheres", quick=True, workers=1)
    (finding,) = done.outcome.findings
    assert finding.verdict is Verdict.AGREES
    # The closed form itself, by the numbers of the series: J(0) = 1/E and J(infinity) = 1/(0.4 E).
    form = done.outcome.tables["areas"]["form"]
    assert np.isclose(form.min(), 1.0)
    assert np.isclose(form.max(), 0.4 ** (-2 / 3), rtol=1e-3)
    assert len(ptfe_2009.draw(done.outcome.tables).axes) == 1
    assert (tmp_path / "spheres" / "verdicts.csv").is_file()
