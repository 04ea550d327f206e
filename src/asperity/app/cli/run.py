"""The command ``asperity run``: configuration in, a folder of results out."""

from __future__ import annotations

import time as clock
from pathlib import Path

from asperity.app.cli.output import check_free, write_results
from asperity.app.cli.report import aligned, run_report
from asperity.app.cli.resuming import place_beside, tell_results
from asperity.app.config import RunConfig, to_toml
from asperity.app.runs import execute
from asperity.progress import listener
from asperity.results import Checkpoint

_CHECKPOINT_EVERY = 20.0
"""Seconds between checkpoints: shorter runs leave none."""


def run(config: RunConfig, *, out: Path, overwrite: bool, quiet: bool) -> None:
    """Compute, and write the results to a folder; a long run keeps its place in a file beside it.

    `AsperityError` as the engine; or the folder cannot be written. No results are left then.
    """
    check_free(out, overwrite=overwrite)
    with place_beside(out, to_toml(config)) as place, listener(not quiet) as progress:
        resumed = place.exists()
        started = clock.perf_counter()
        if resumed:
            progress.stage(f"going on from {place}")
        checkpoint = Checkpoint(place, every=_CHECKPOINT_EVERY)
        outcome = execute(config, progress, checkpoint=checkpoint)
        rows = run_report(outcome, seconds=clock.perf_counter() - started, resumed=resumed)
        progress.stage("writing the results")
        remarks = write_results(outcome, out, text=aligned(rows), overwrite=overwrite)
    if not quiet:
        tell_results([*rows, *(("remark", remark) for remark in remarks)], out)
