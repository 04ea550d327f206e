"""Commands that compute into a folder, and resume if they are interrupted and given again."""

from __future__ import annotations

import hashlib
import sys
import time as clock
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.app.cli.options import Results
from asperity.app.cli.report import Row, aligned
from asperity.base.files import MARKER, Standing, beside, mark, marker_of
from asperity.progress import listener
from asperity.results import Checkpoint
from asperity.results.store import PlaceTakenError, whole_folder, write_into

_SHOWN = ("prediction.html", "inference.html", "aging", "history", "contacts", "friction", "law")
"""Files of results that ``--open`` shows, the first that exists: a page, or a picture in any format."""


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
    """Compute, and write the dataset, if there is one, the summary and all else to a folder, or nothing.

    A long computation writes a checkpoint beside the folder every so many seconds. `replaceable` is from
    `check_free`, called before the engine was imported.
    """
    with _place_beside(out, asked) as place, listener(not results.quiet) as progress:
        resumed, started = place.exists(), clock.perf_counter()
        if resumed:
            progress.stage(f"resuming from {place}")
        result = compute(progress=progress, checkpoint=Checkpoint(place, every=every))
        rows = report(result, seconds=clock.perf_counter() - started, resumed=resumed)
        progress.stage("writing the results")
        with folder_of_results(kind, out, rows, replaceable) as folder:
            if isinstance(dataset := getattr(result, "dataset", None), xr.Dataset):
                write_into(dataset, folder / "history.zarr")
            rows += [("remark", remark) for remark in write(result, folder) or ()]
    tell_results(rows, out, results)


@contextmanager
def folder_of_results(kind: str, out: Path, rows: Sequence[Row], replaceable: Standing) -> Iterator[Path]:
    """The folder to write to, which gets its marker, and its name when all is written."""
    with whole_folder(out, overwrite=replaceable) as folder:
        yield folder
        (folder / "summary.txt").write_text(f"{aligned(rows)}\n", encoding="utf-8")
        mark(folder / MARKER, kind, (path.name for path in folder.iterdir()), rows=rows)


@contextmanager
def _place_beside(out: Path, asked: str) -> Iterator[Path]:
    """The checkpoint of this computation beside the folder of results; removed when that is written."""
    mark = hashlib.sha256(asked.encode()).hexdigest()[:8]
    place = beside(out, f".{mark}.checkpoint")
    try:
        yield place
    except KeyboardInterrupt:
        kept = f"the same command resumes from {place}" if place.exists() else "nothing was written"
        raise KeyboardInterrupt(f"interrupted; {kept}") from None
    except PlaceTakenError:  # the results are complete
        place.unlink(missing_ok=True)
        raise
    place.unlink(missing_ok=True)


def tell_results(rows: Sequence[Row], out: Path, results: Results) -> None:
    """Print a report and the files written; open the results if asked."""
    if not results.quiet:
        files = ", ".join(marker_of(out)["files"])
        sys.stdout.write(f"{aligned([*rows, ('written', f'{out}: {files}')])}\n")
    if results.show:
        open_results(out)


def open_results(out: Path) -> None:
    """Open the page or the picture of results; print its path if no program opens it."""
    files = [file for name in _SHOWN for file in sorted(out.glob(f"{name}*")) if file.is_file()]
    shown = next((path for path in files if path.suffix not in (".csv", ".toml")), out).resolve()
    if not webbrowser.open(shown.as_uri()):
        print(f"remark: no program opens {shown}", file=sys.stderr)
