"""Opening what was written, in the program that shows it."""

from __future__ import annotations

import sys
import webbrowser
from pathlib import Path

_SHOWN = ("prediction.html", "inference.html", "aging", "history", "contacts", "friction")
"""What of a folder of results is opened, the first that is there: a page, or a picture in any format."""


def open_results(out: Path) -> None:
    """Open the page of a prediction or the picture of a run; where nothing can show it, say where it is."""
    here = [found for name in _SHOWN for found in sorted(out.glob(f"{name}*")) if found.is_file()]
    shown = next((path for path in here if path.suffix not in (".csv", ".toml")), out).resolve()
    if not webbrowser.open(shown.as_uri()):
        print(f"remark: nothing here opens {shown}", file=sys.stderr)
