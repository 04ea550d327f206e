"""Runs: from a configuration to all that a run finds."""

from asperity.runs.pipeline import Outcome, Progress, Silent, cores, execute, hold_times_of, measured_surface

__all__ = ["Outcome", "Progress", "Silent", "cores", "execute", "hold_times_of", "measured_surface"]
