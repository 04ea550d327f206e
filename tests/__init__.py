"""Tests, in folders that say the kind."""

import os

CASES = min(100, int(os.environ.get("CURVES", "40")))
"""Synthetic cases by which intervals are judged; `make release` asks for more."""
