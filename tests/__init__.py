"""Tests, in folders that say the kind."""
