"""Results: frozen states become one self-describing Dataset, on disk and back."""

from asperity.base.calls import answered as _answered
from asperity.progress import Checkpoint
from asperity.results.contacts import load_contact
from asperity.results.history import History
from asperity.results.pulling import Pull
from asperity.results.store import load, save, whole_file, whole_folder
from asperity.sheets.tables import read_table

__all__ = [
    "Checkpoint",
    "History",
    "Pull",
    "load",
    "load_contact",
    "read_table",
    "save",
    "whole_file",
    "whole_folder",
]
__dir__ = _answered(globals())
