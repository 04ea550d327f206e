"""The command ``asperity reproduce``."""

from __future__ import annotations

import sys
import time as clock
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from asperity.app.cli.options import Work
from asperity.app.cli.report import aligned
from asperity_research.commands.ensembles import Ensembles
from asperity_research.commands.study import command_of, say_estimate, worked_through
from asperity_research.paper.reproduce import HOME, conclude, prepared_in
from asperity_research.paper.studies import FULL, QUICK
from asperity_research.studies.ledger import Finding, Verdict


def say_what_it_takes(out: Path, ensembles: Ensembles, _: Work) -> None:
    """Say how many runs and how much disk, without leaving anything behind."""
    effort = QUICK if ensembles.quick else FULL
    say_estimate(HOME, out, lambda folder: prepared_in(folder, effort, seed=ensembles.seed))


def reproduce(out: Path, ensembles: Ensembles, work: Work) -> None:
    """Run the studies that are missing, and write the report.

    `AsperityError` if the folder cannot be used, the disk or the scheduler refused, or some runs failed.
    """
    effort = QUICK if ensembles.quick else FULL
    command = command_of(["reproduce"], out, ensembles)
    started = clock.perf_counter()
    preparing = prepared_in(out, effort, seed=ensembles.seed)
    with worked_through("study", preparing, work) as (prepared, voice):
        voice.say("drawing the figures and judging the claims")
        seconds = clock.perf_counter() - started
        done = conclude(out, prepared, effort=effort, command=command, seconds=seconds)
    if not work.quiet:
        sys.stdout.write(f"{aligned(_verdicts(done.findings))}\n\n{done.report}\n")


def _verdicts(findings: Sequence[Finding]) -> list[tuple[str, ...]]:
    counts = Counter(finding.verdict for finding in findings)
    rows: list[tuple[str, ...]] = [("claims", str(len(findings)))]
    rows += [(verdict.value, str(counts[verdict])) for verdict in Verdict]
    return rows
