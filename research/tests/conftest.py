"""The command as a function, and profiles of the property tests, as the tests of the library have them."""

import json
from collections.abc import Sequence
from pathlib import Path

import pytest
from tests.cli.conftest import asperity

from asperity.app.campaign.plan import plan_to_json
from asperity.app.campaign.store import Store
from asperity.app.campaign.worker import run_task
from asperity.app.config import to_tables
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
        Store(one.folder).prepare()
        (one.folder / "plan.json").write_text(plan_to_json(one.plan), encoding="utf-8")
        for run in one.plan.runs:
            config = json.dumps(to_tables(run.config))
            report = run_task(str(one.folder), run.identity, config, run.content)
            assert report[1] == "done", (one.campaign.name, report)
