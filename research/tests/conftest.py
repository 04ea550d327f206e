"""The command as a function, and profiles of the property tests, as the tests of the library have them."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from tests.campaign.conftest import do_here as do_campaign
from tests.cli.conftest import asperity

from asperity_research.studies.campaigns import Prepared

__all__ = ["asperity"]

FOLDER = Path(__file__).parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave all to `make test-all`."""
    for item in items:
        if FOLDER in item.path.parents:
            item.add_marker(pytest.mark.slow)


def do_here(prepared: Sequence[Prepared]) -> None:
    """Do campaigns in this process."""
    for one in prepared:
        reports = do_campaign(one.plan, one.folder)
        assert {state for _, state, _ in reports} == {"done"}, (one.campaign.name, reports)
