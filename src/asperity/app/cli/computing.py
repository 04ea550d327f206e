"""What commands share that compute into a folder, and go on when they are interrupted and given again."""

from __future__ import annotations

import hashlib
import sys
import time as clock
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from asperity.app.cli.options import Results
from asperity.app.cli.report import Row, aligned
from asperity.base.files import MARKER, Standing, beside, mark, marker_of
from asperity.progress import listener
from asperity.results import Checkpoint
from asperity.results.store import PlaceTakenError, whole_folder, write_into

_SHOWN = ("prediction.html", "inference.html", "aging", "history", "contacts", "friction", "law")
"""What of a folder of results is opened, the first that is there: a page, or a picture in any format."""


def compute_into(
    kind: str,
    out: Path,
    asked: str,
    compute: Callable[..., Any],
    *,
    report: Callable[..., list[Row]],
    write: Callable[[Any, Path], Sequence[str] | None],
    every: float,
    results: Results,
    replaceable: Standing,
) -> None:
    """Compute what is asked, and write its dataset, its summary and all else to a folder, or nothing.

    A long computation keeps its place, every so many seconds, in a file beside the folder. What is
    `replaceable` there, `check_free` has said before all this was imported.
    """
    with place_beside(out, asked) as place, listener(not results.quiet) as progress:
        resumed, started = place.exists(), clock.perf_counter()
        if resumed:
            progress.stage(f"going on from {place}")
        result = compute(progress=progress, checkpoint=Checkpoint(place, every=every))
        rows = report(result, seconds=clock.perf_counter() - started, resumed=resumed)
        progress.stage("writing the results")
        with folder_of_results(kind, out, rows, replaceable) as folder:
            write_into(result.dataset, folder / "history.zarr")
            rows += [("remark", remark) for remark in write(result, folder) or ()]
    tell_results(rows, out, results)


@contextmanager
def folder_of_results(kind: str, out: Path, rows: Sequence[Row], replaceable: Standing) -> Iterator[Path]:
    """The folder to write to, with its marker: it appears when all is written, and replaces nothing else."""
    with whole_folder(out, overwrite=replaceable) as folder:
        yield folder
        (folder / "summary.txt").write_text(f"{aligned(rows)}\n", encoding="utf-8")
        mark(folder / MARKER, kind, (path.name for path in folder.iterdir()), rows=rows)


@contextmanager
def place_beside(out: Path, asked: str) -> Iterator[Path]:
    """The file beside the folder of results in which this computation, and no other, keeps its place."""
    mark = hashlib.sha256(asked.encode()).hexdigest()[:8]
    place = beside(out, f".{mark}.checkpoint")
    try:
        yield place
    except KeyboardInterrupt:
        kept = f"the same command goes on from {place}" if place.exists() else "nothing was written"
        raise KeyboardInterrupt(f"interrupted; {kept}") from None
    except PlaceTakenError:  # the results are complete
        place.unlink(missing_ok=True)
        raise
    place.unlink(missing_ok=True)


def tell_results(rows: Sequence[Row], out: Path, results: Results) -> None:
    """Print a report, and which files were written; open what shows them."""
    if not results.quiet:
        files = ", ".join(marker_of(out)["files"])
        sys.stdout.write(f"{aligned([*rows, ('written', f'{out}: {files}')])}\n")
    if results.show:
        open_results(out)


def open_results(out: Path) -> None:
    """Open the page of a prediction or the picture of a run; where nothing can show it, say where it is."""
    files = [file for name in _SHOWN for file in sorted(out.glob(f"{name}*")) if file.is_file()]
    shown = next((path for path in files if path.suffix not in (".csv", ".toml")), out).resolve()
    if not webbrowser.open(shown.as_uri()):
        print(f"remark: nothing here opens {shown}", file=sys.stderr)
