"""Results: frozen states in, one self-describing Dataset out, and back from disk."""

from asperity.results.checkpoint import Checkpoint
from asperity.results.contacts import load_contact
from asperity.results.history import History
from asperity.results.store import load, save

__all__ = ["Checkpoint", "History", "load", "load_contact", "save"]
__dir__ = __all__.copy  # dir() lists the public names alone
