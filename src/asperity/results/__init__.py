"""Results: frozen states in, one self-describing Dataset out, and back from disk."""

from asperity.results.age import History, age
from asperity.results.store import load, save

__all__ = ["History", "age", "load", "save"]
