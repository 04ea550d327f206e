"""What commands share whose computing may be interrupted, and goes on when they are given again."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from asperity.app.cli.report import Row, aligned


@contextmanager
def place_beside(out: Path, wanted: str) -> Iterator[Path]:
    """The file beside the folder of results in which a computation keeps its place; removed after it.

    It is named after what is wanted, so that a command with other parameters never meets it. An interruption
    is told with how to go on.
    """
    mark = hashlib.sha256(wanted.encode()).hexdigest()[:8]
    place = out.with_name(f"{out.name}.{mark}.checkpoint")
    try:
        yield place
    except KeyboardInterrupt:
        kept = f"the same command goes on from {place}" if place.exists() else "nothing was written"
        raise KeyboardInterrupt(f"interrupted; {kept}") from None
    place.unlink(missing_ok=True)


def tell_results(rows: Sequence[Row], out: Path) -> None:
    """Print a report, and which files were written."""
    files = ", ".join(sorted(path.name for path in out.iterdir()))
    sys.stdout.write(f"{aligned([*rows, ('written', f'{out}: {files}')])}\n")
