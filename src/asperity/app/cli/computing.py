"""Commands that compute into a folder, and resume if they are interrupted and given again."""

from __future__ import annotations

import hashlib
import os
import sys
import time as clock
import webbrowser
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import xarray as xr

from asperity.app.cli.new_files import NewFolder
from asperity.base.calls import remarks_made, showing
from asperity.base.files import MARKER, beside, mark, marker_of
from asperity.base.rows import Row, aligned, remarks, words_of
from asperity.errors import ConvergenceError, OutputError
from asperity.progress import listener
from asperity.results import Checkpoint
from asperity.results.store import PlaceTakenError, whole_folder, write_into

_SHOWN = ("prediction.html", "inference.html", "aging", "history", "contacts", "friction", "law", "sliding")
"""Files of results that ``--open`` shows, the first that exists: a page, or a picture in any format."""


def compute_into(
    kind: str,
    out: NewFolder,
    asked: str,
    compute: Callable[..., Any],
    *,
    rows: Callable[[Any], list[Row]],
    write: Callable[[Any, Path], None],
    every: float,
) -> None:
    """Compute, and write everything to a folder, or nothing.

    A long computation writes a checkpoint beside the folder every so many seconds.
    """
    with _place_beside(out.path, asked) as place, listener(not out.results.quiet) as progress:
        resumed, started = place.exists(), clock.perf_counter()
        if resumed:
            progress.stage(f"resuming from {place}")
        result = compute(progress=progress, checkpoint=Checkpoint(place, every=every))
        seconds = clock.perf_counter() - started
        progress.stage("writing the results")

        def write_all(folder: Path) -> None:
            if isinstance(dataset := getattr(result, "dataset", None), xr.Dataset):
                write_into(dataset, folder / "history.zarr")
            write(result, folder)

        cost = Row("cost", f"{seconds:.1f} s{' in this session' if resumed else ''}")

        def summary() -> list[Row]:
            return [*rows(result), cost, *remarks(*result.remarks)]

        said = write_results(kind, out, summary, write_all)
    tell_results(said, out)


def write_results(
    kind: str, out: NewFolder, summary: Callable[[], list[Row]], write: Callable[[Path], None]
) -> list[Row]:
    """Write files, a summary and a marker to a folder that gets its name when all is written.

    Returns the rows of the summary, with remarks that are made meanwhile, as on a figure that fails.
    """
    rows: list[Row] = []
    with whole_folder(out.path, overwrite=out.replaced) as folder:
        with remarks_made() as made:
            write(folder)
            with showing("the summary"):
                rows += summary()
        rows += remarks(*made)
        words = words_of(rows)
        (folder / "summary.txt").write_text(f"{aligned(words)}\n", encoding="utf-8")
        mark(folder / MARKER, kind, (path.name for path in folder.iterdir()), rows=words)
    return rows


@contextmanager
def _place_beside(out: Path, asked: str) -> Iterator[Path]:
    """The checkpoint of this computation beside the folder of results; removed when that is written."""
    mark = hashlib.sha256(os.fsencode(asked)).hexdigest()[:8]
    place = beside(out, f".{mark}.checkpoint")
    try:
        yield place
    except KeyboardInterrupt:
        kept = f"the same command resumes from {place}" if place.exists() else "nothing was written"
        raise KeyboardInterrupt(f"interrupted; {kept}") from None
    except PlaceTakenError:  # the results are complete
        place.unlink(missing_ok=True)
        raise
    except (OutputError, ConvergenceError) as error:
        if not place.exists():
            raise
        raise type(error)(f"{error}; the same command resumes from {place}") from error
    place.unlink(missing_ok=True)


def tell_results(rows: Sequence[Row], out: NewFolder) -> None:
    """Print a report and the files written; open the results if asked."""
    if not out.results.quiet:
        files = ", ".join(marker_of(out.path)["files"])
        sys.stdout.write(f"{aligned(words_of([*rows, Row('written', f'{out.path}: {files}')]))}\n")
    if out.results.show:
        open_results(out.path)


def open_results(out: Path) -> None:
    """Open the page or the picture of results; print its path if no program opens it."""
    files = [file for name in _SHOWN for file in sorted(out.glob(f"{name}*")) if file.is_file()]
    shown = next((path for path in files if path.suffix not in (".csv", ".toml")), out).resolve()
    if not webbrowser.open(shown.as_uri()):
        print(f"remark: no program opens {shown}", file=sys.stderr)
