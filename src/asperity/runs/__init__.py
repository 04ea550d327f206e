"""Runs: from a configuration to all that a run finds."""

from asperity.runs.pipeline import Outcome, Progress, Silent, execute, recorded_times

__all__ = ["Outcome", "Progress", "Silent", "execute", "recorded_times"]
