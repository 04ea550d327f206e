"""What runs campaigns for an answer: ``asperity study``, ``experiment`` and ``reproduce``."""

import shlex
import sys
import tempfile
import time as clock
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from asperity import campaign
from asperity.app.cli.campaign import tally_shown
from asperity.app.cli.options import Work
from asperity.base.rows import aligned, words_of
from asperity.base.words import data_size
from asperity_research.commands.ensembles import Ensembles
from asperity_research.studies import STUDIES, conclude
from asperity_research.studies.campaigns import Prepared, Told, run_campaigns
from asperity_research.studies.ledger import Finding
from asperity_research.studies.study import Inquiry


def say_studies() -> None:
    """List the studies and their questions."""
    rows = [(study.name, study.question) for study in STUDIES.values()]
    sys.stdout.write(f"{aligned(rows)}\n\nasperity study NAME --quick answers one in minutes\n")


def answer(one: Inquiry, words: list[str], out: Path, ensembles: Ensembles, work: Work) -> None:
    """Run what is missing, write the report, and say what was found; or say what that takes.

    ``words`` are those of the command, for the report. `AsperityError` if the folder cannot be used, the disk
    or the scheduler refused, or some runs failed.
    """
    if work.dry_run:
        _say_estimate(one, out, ensembles)
        return
    started = clock.perf_counter()
    command = shlex.join(["asperity", *words, "--out", str(out), *ensembles.flags])
    asked: dict[str, Any] = vars(ensembles)
    try:
        with one.prepared_in(out, **asked) as prepared:
            _run(prepared, work)
            _say(f"computing numbers and figures{f', {one.takes}' if one.takes else ''}", work)
            seconds = clock.perf_counter() - started
            done = conclude(one, out, prepared, command=command, seconds=seconds, **asked)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "interrupted; finished runs are kept, and the same command does the rest"
        ) from None
    if not work.quiet:
        found, counted = done.outcome.findings, done.outcome.tally()
        text = aligned(words_of(counted)) if one.brief else "\n".join(map(_in_words, found))
        sys.stdout.write(f"{text}\n\n{done.report}\n")


def _in_words(finding: Finding) -> str:
    head, *numbers = words_of(finding.rows())
    return aligned([(": ".join(head),), *(("", *one) for one in numbers)])


def _say_estimate(one: Inquiry, out: Path, ensembles: Ensembles) -> None:
    """Say how many runs and how much disk each campaign takes, and all, without leaving anything behind.

    Some of them may be done in the folder.
    """
    one.home.check(out)
    asked: dict[str, Any] = vars(ensembles)
    with tempfile.TemporaryDirectory() as nowhere, one.prepared_in(nowhere, **asked) as prepared:
        rows, judged = list[tuple[str, ...]](), list[campaign.Estimate]()
        for each in prepared:
            judged.append(campaign.estimate(each.plan, out / one.home.inside / each.campaign.name))
            rows.append((each.campaign.name, *_total(judged[-1:]), each.campaign.purpose))
        sys.stdout.write(f"{aligned([*rows, ('all', *_total(judged), 'every campaign')])}\n")


def _total(judged: Sequence[campaign.Estimate]) -> tuple[str, str]:
    return f"{sum(one.runs for one in judged)} runs", f"about {data_size(sum(one.bytes for one in judged))}"


def _say(text: str, work: Work) -> None:
    """Print a line of progress."""
    if not work.quiet:
        print(text, file=sys.stderr, flush=True)


def _run(prepared: Sequence[Prepared], work: Work) -> None:
    """Do what is missing of some campaigns."""
    begins = [*prepared]

    @contextmanager
    def watch(one: Prepared) -> Iterator[Told]:
        if begins:
            _say(", ".join(_total([campaign.estimate(each.plan, each.folder) for each in begins])), work)
            begins.clear()
        number = 1 + [each.folder for each in prepared].index(one.folder)
        _say(f"campaign {number} of {len(prepared)}: {one.campaign.purpose}", work)
        with tally_shown(quiet=work.quiet) as show:
            yield show

    run_campaigns(
        prepared,
        workers=work.workers,
        scheduler=work.scheduler,
        retry_failed=work.retry_failed,
        watch=watch,
    )
