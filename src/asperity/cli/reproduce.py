"""The command ``asperity reproduce``."""

from __future__ import annotations

import shlex
import sys
import tempfile
import time as clock
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from asperity.cli.report import aligned
from asperity.cli.study import Voice, say_estimate
from asperity.paper.reproduce import HOME, STUDIES, conclude, prepared_in
from asperity.paper.studies import FULL, QUICK
from asperity.runs import cores
from asperity.studies.campaigns import run_campaigns
from asperity.studies.ledger import Finding, Verdict


def say_what_it_takes(out: Path, *, quick: bool, seed: int, workers: int) -> None:
    """Say how many runs, how long, and how much disk, without leaving anything behind."""
    effort = QUICK if quick else FULL
    HOME.check(out)
    with tempfile.TemporaryDirectory() as nowhere, prepared_in(nowhere, effort, seed=seed) as prepared:
        say_estimate(prepared, out / STUDIES, workers=workers)


def reproduce(
    out: Path,
    *,
    quick: bool,
    seed: int,
    workers: int | None,
    scheduler: str | None,
    retry_failed: bool,
    quiet: bool,
) -> None:
    """Run the studies that are missing, and write the report.

    Raises
    ------
    AsperityError
        The folder cannot be used; the disk or the scheduler refused; some runs failed.
    """
    effort = QUICK if quick else FULL
    words = [
        "asperity",
        "reproduce",
        "--out",
        str(out),
        *["--quick"] * quick,
        *(["--seed", str(seed)] if seed else []),
    ]
    command = shlex.join(words)
    started = clock.perf_counter()
    try:
        with prepared_in(out, effort, seed=seed) as prepared:
            voice = Voice("study", prepared, workers=workers or cores(), quiet=quiet)
            run_campaigns(
                prepared, workers=workers, scheduler=scheduler, retry_failed=retry_failed, watch=voice.watch
            )
            voice.say("drawing the figures and judging the claims")
            seconds = clock.perf_counter() - started
            done = conclude(out, prepared, effort=effort, command=command, seconds=seconds)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "interrupted; what is finished is kept, and the same command does the rest"
        ) from None
    if not quiet:
        sys.stdout.write(f"{aligned(_verdicts(done.findings))}\n\n{done.report}\n")


def _verdicts(findings: Sequence[Finding]) -> list[tuple[str, ...]]:
    counts = Counter(finding.verdict for finding in findings)
    rows: list[tuple[str, ...]] = [("claims", str(len(findings)))]
    rows += [(verdict.value, str(counts[verdict])) for verdict in Verdict]
    return rows
