"""The command ``asperity reproduce``."""

from __future__ import annotations

import shlex
import sys
import tempfile
import time as clock
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import asperity.campaign as campaign
from asperity.campaign import Estimate, Tally
from asperity.cli.campaign import tally_shown
from asperity.cli.report import aligned
from asperity.paper.ledger import Finding, Verdict
from asperity.paper.reproduce import STUDIES, Prepared, check_folder, conclude, prepared_in, run_studies
from asperity.paper.studies import FULL, QUICK
from asperity.runs import cores
from asperity.words import data_size, duration


def say_what_it_takes(out: Path, *, quick: bool, seed: int, workers: int) -> None:
    """Say how many runs, how long, and how much disk, without leaving anything behind."""
    effort = QUICK if quick else FULL
    check_folder(out)
    with tempfile.TemporaryDirectory() as nowhere, prepared_in(nowhere, effort, seed=seed) as prepared:
        judged = [campaign.estimate(one.plan, out / STUDIES / one.study.name) for one in prepared]
    rows = [
        (one.study.name, f"{it.runs} runs", f"about {duration(it.wall(workers))}", one.study.purpose)
        for one, it in zip(prepared, judged, strict=True)
    ]
    rows.append(("all", *_total(judged, workers)))
    sys.stdout.write(f"{aligned(rows)}\n")


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
            voice = _Voice(prepared, workers=workers or cores(), quiet=quiet)
            run_studies(
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


class _Voice:
    """Says which study begins, and at first how long it all will take."""

    def __init__(self, prepared: Sequence[Prepared], *, workers: int, quiet: bool) -> None:
        self._prepared = prepared
        self._workers = workers
        self._quiet = quiet
        self._announced = False

    @contextmanager
    def watch(self, one: Prepared) -> Iterator[Callable[[Tally], None]]:
        if not self._announced and not self._quiet:
            self._announced = True
            self.say("judging how long it will take")
            judged = [campaign.estimate(each.plan, each.folder) for each in self._prepared]
            self.say(", ".join(_total(judged, self._workers)))
        number = 1 + [each.folder for each in self._prepared].index(one.folder)
        self.say(f"study {number} of {len(self._prepared)}: {one.study.purpose}")
        with tally_shown(quiet=self._quiet) as show:
            yield show

    def say(self, text: str) -> None:
        if not self._quiet:
            print(text, file=sys.stderr, flush=True)


def _total(judged: Sequence[Estimate], workers: int) -> tuple[str, str, str]:
    seconds = sum(one.wall(workers) for one in judged)
    return (
        f"{sum(one.runs for one in judged)} runs",
        f"about {duration(seconds)} on {workers} workers",
        f"about {data_size(sum(one.bytes for one in judged))}",
    )


def _verdicts(findings: Sequence[Finding]) -> list[tuple[str, ...]]:
    counts = Counter(finding.verdict for finding in findings)
    rows: list[tuple[str, ...]] = [("claims", str(len(findings)))]
    rows += [(verdict.value, str(counts[verdict])) for verdict in Verdict]
    return rows
