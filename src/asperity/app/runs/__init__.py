"""Runs: from a configuration to all that a run finds."""

from asperity.app.runs.pipeline import Outcome, execute, recorded_times
from asperity.progress import Progress

__all__ = ["Outcome", "Progress", "execute", "recorded_times"]
