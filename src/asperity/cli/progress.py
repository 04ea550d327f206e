"""Progress as the commands show it: not at all if quiet."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

import asperity.progress as progress
from asperity.runs import Progress, Silent


def progress_shown(*, quiet: bool) -> AbstractContextManager[Progress]:
    """Choose how progress is shown, until the run ends."""
    return nullcontext(Silent()) if quiet else progress.progress_shown()
