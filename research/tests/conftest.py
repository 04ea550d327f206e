"""The command as a function, and profiles of the property tests, as the tests of the library have them."""

from tests.cli.conftest import asperity

__all__ = ["asperity"]
