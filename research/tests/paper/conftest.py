"""A whole reproduction on tiny lattices, computed once."""

import dataclasses

import pytest

from asperity_research.paper.reproduce import PAPER
from asperity_research.paper.studies import Effort, studies
from asperity_research.studies.evidence import Evidence
from research.tests.conftest import do_here

_EFFORT = Effort(
    "tiny",
    seeds=2,
    aging_seeds=2,
    pressed_seeds=2,
    light_seeds=4,
    loads_per_decade=2,
    aging_loads=(1e-2, 1e-1, 3e-1),
    sizes=(32, 64),
    aging_sizes=(16, 32),
    maps_size=64,
    side=40,
)
TINY = dataclasses.replace(PAPER, quick=studies(_EFFORT))


@pytest.fixture(scope="session")
def reproduction(tmp_path_factory):
    """Folder of a tiny reproduction whose studies are done, and its studies."""
    folder = tmp_path_factory.mktemp("reproduction")
    with TINY.prepared_in(folder, quick=True, seed=3) as prepared:
        do_here(prepared)
    return folder, prepared


@pytest.fixture(scope="session")
def evidence(reproduction):
    return Evidence(reproduction[0] / PAPER.home.inside)
