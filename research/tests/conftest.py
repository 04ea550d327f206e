"""The command as a function, and profiles of the property tests, as the tests of the library have them."""

from pathlib import Path

import pytest
from tests.cli.conftest import asperity

__all__ = ["asperity"]

FOLDER = Path(__file__).parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Leave all to `make test-all`."""
    for item in items:
        if FOLDER in item.path.parents:
            item.add_marker(pytest.mark.slow)
