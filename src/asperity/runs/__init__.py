"""Runs: from a configuration to all that a run finds."""

from asperity.progress import Progress
from asperity.runs.pipeline import Outcome, execute, recorded_times

__all__ = ["Outcome", "Progress", "execute", "recorded_times"]
