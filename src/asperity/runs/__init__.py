"""Runs: from a configuration to all that a run finds."""

from asperity.runs.execute import Outcome, Progress, execute

__all__ = ["Outcome", "Progress", "execute"]
