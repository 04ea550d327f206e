"""Results: frozen states become one self-describing Dataset, on disk and back."""

from asperity.base.calls import answered as _answered
from asperity.progress import Checkpoint as Checkpoint
from asperity.results.contacts import load_contact as load_contact
from asperity.results.history import History as History
from asperity.results.pulling import Pull as Pull
from asperity.results.store import load as load
from asperity.results.store import save as save
from asperity.results.store import whole_file as whole_file
from asperity.results.store import whole_folder as whole_folder
from asperity.sheets.tables import read_table as read_table

__dir__ = _answered(globals())
