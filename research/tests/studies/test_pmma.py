"""The study of PMMA, on contacts all of whose load is borne by sites that flow."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.constants import Boltzmann

from asperity_research.studies import pmma
from asperity_research.studies.evidence import Evidence

TIMES = np.concatenate([[0.0], np.geomspace(1.0, 1e5, 21)])


def flowing(parameter, values):
    """Contacts of 1 um: A = F/s with s = s0 arsinh(L/(v0 t)), a little different a surface."""
    lengths, areas = 1e-6 * np.array([0.8, 1.0, 1.2]), []
    for value in values:
        kelvin = value if parameter == "temperature" else pmma.ROOM
        joules = value if parameter == "creep_energy" else pmma.energy(4e8)
        flown = pmma.PREFACTOR * np.exp(-joules / (Boltzmann * kelvin)) * np.maximum(TIMES, 1e-3)
        s = Boltzmann * kelvin / pmma.VOLUME * np.arcsinh(lengths[:, np.newaxis] / flown)
        areas.append(pmma.PRESSURE * pmma._SIDE**2 / s)
    where = {parameter: list(values), "seed": np.arange(3), "time": TIMES}
    return xr.Dataset({"area": ((parameter, "seed", "time"), np.array(areas))}, where)


@pytest.fixture(scope="module")
def outcome():
    known = {name: flowing(*sweep) for name, sweep in pmma._FAMILIES.items()}
    return pmma.analyse(Evidence(Path(), known))


def test_a_contact_that_flows_has_its_closed_form(outcome):
    numbers = outcome.tables["numbers"].set_index("family")
    softest = numbers.loc["B = 0.02", "pressure"]
    numbers = numbers.drop("B = 0.02")
    assert np.allclose(numbers["share"], 1.0, rtol=0.02)
    assert np.allclose(numbers["B"], numbers["s0"] / numbers["pressure"], rtol=0.02)
    at_room = Boltzmann * pmma.ROOM / pmma.VOLUME
    assert np.isclose(outcome.findings[0].measured[0].estimate.value, at_room / 3e8, rtol=0.02)
    assert np.isclose(softest, 1e-9 * at_room / 0.02, rtol=0.02)


def test_the_verdicts_on_it(outcome):
    verdicts = {finding.key: finding.verdict for finding in outcome.findings}
    # s falls with the temperature, so that B grows faster than in proportion to it.
    assert {key for key, verdict in verdicts.items() if verdict == "agrees"} == {"flow", "roughness"}
    assert {key for key, verdict in verdicts.items() if verdict == "differs"} == {"friction", "temperature"}
    assert len(pmma.draw(outcome.tables).axes) == 2


def test_the_energy_of_activation_is_that_of_the_hardness():
    for hardness in pmma._HARDNESSES:
        thermal = Boltzmann * pmma.ROOM
        v0 = pmma.PREFACTOR * np.exp(-pmma.energy(hardness) / thermal)
        assert np.isclose(v0 * np.sinh(hardness * pmma.VOLUME / thermal), 1e-9, rtol=0.02)
