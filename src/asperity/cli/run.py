"""The command ``asperity run``: configuration in, a folder of results out."""

from __future__ import annotations

import hashlib
import sys
import time as clock
from pathlib import Path

from asperity.cli.output import check_free, write_results
from asperity.cli.progress import progress_shown
from asperity.cli.report import aligned, run_report
from asperity.config import RunConfig, to_toml
from asperity.results import Checkpoint
from asperity.runs import cores, execute
from asperity.runs.loops import compile_loops

_CHECKPOINT_EVERY = 20.0
"""Seconds between checkpoints: shorter runs leave none."""


def run(config: RunConfig, *, out: Path, overwrite: bool, quiet: bool) -> None:
    """Compute, and write the results.

    Parameters
    ----------
    config
        What to run.
    out
        Folder of the results. A long run keeps its place in a file beside it.
    overwrite
        Whether an earlier run's folder may be replaced.
    quiet
        Whether to say nothing.

    Raises
    ------
    AsperityError
        As the engine does; or the folder cannot be written. No results are left then.
    """
    check_free(out, overwrite=overwrite)
    place = _place(config, out)
    resumed = place.exists()
    try:
        with progress_shown(quiet=quiet) as progress:
            compile_loops(progress.stage, progress.remark)
            started = clock.perf_counter()
            if resumed:
                progress.stage(f"going on from {place}")
            checkpoint = Checkpoint(place, every=_CHECKPOINT_EVERY)
            outcome = execute(config, progress, checkpoint=checkpoint, threads=cores())
            rows = run_report(outcome, seconds=clock.perf_counter() - started, resumed=resumed)
            progress.stage("writing the results")
            remarks = write_results(outcome, out, text=aligned(rows), overwrite=overwrite)
            rows += [("remark", remark) for remark in remarks]
    except KeyboardInterrupt:
        kept = f"the same command goes on from {place}" if place.exists() else "nothing was written"
        raise KeyboardInterrupt(f"interrupted; {kept}") from None
    place.unlink(missing_ok=True)
    if not quiet:
        files = ", ".join(sorted(path.name for path in out.iterdir()))
        sys.stdout.write(f"{aligned([*rows, ('written', f'{out}: {files}')])}\n")


def _place(config: RunConfig, out: Path) -> Path:
    """Name the checkpoint after the run, so that a run with other parameters never meets it."""
    mark = hashlib.sha256(to_toml(config).encode()).hexdigest()[:8]
    return out.with_name(f"{out.name}.{mark}.checkpoint")
