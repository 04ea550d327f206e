"""The command ``asperity reproduce``."""

import sys
import time as clock
from collections import Counter
from functools import partial
from pathlib import Path

from asperity.app.cli.options import Work
from asperity.base.rows import aligned
from asperity_research.commands.ensembles import Ensembles
from asperity_research.commands.study import command_of, say_estimate, worked_through
from asperity_research.paper.reproduce import HOME, conclude, prepared_in
from asperity_research.paper.studies import FULL, QUICK
from asperity_research.studies.ledger import Verdict


def reproduce(out: Path, ensembles: Ensembles, work: Work) -> None:
    """Run the studies that are missing, and write the report; or say what that takes.

    `AsperityError` if the folder cannot be used, the disk or the scheduler refused, or some runs failed.
    """
    effort = QUICK if ensembles.quick else FULL
    prepare = partial(prepared_in, effort=effort, seed=ensembles.seed)
    if work.dry_run:
        say_estimate(HOME, out, prepare)
        return
    started = clock.perf_counter()
    with worked_through("study", prepare(out), work) as (prepared, say):
        say("drawing the figures and judging the claims")
        seconds, command = clock.perf_counter() - started, command_of(["reproduce"], out, ensembles)
        done = conclude(out, prepared, effort=effort, command=command, seconds=seconds)
    if not work.quiet:
        counts = Counter(finding.verdict for finding in done.outcome.findings)
        rows = [("claims", str(counts.total())), *((one.value, str(counts[one])) for one in Verdict)]
        sys.stdout.write(f"{aligned(rows)}\n\n{done.report}\n")
