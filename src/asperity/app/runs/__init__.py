"""Runs, predictions, laws and steady sliding: from a configuration to all that is found."""

from asperity.app.runs.answers import answer
from asperity.app.runs.outcome import Outcome
from asperity.app.runs.pipeline import execute, recorded_times
from asperity.progress import Progress

__all__ = ["Outcome", "Progress", "answer", "execute", "recorded_times"]
