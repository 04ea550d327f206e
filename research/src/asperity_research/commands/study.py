"""The command ``asperity study``, and the words that go with campaigns of a study."""

import shlex
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path

from asperity import campaign
from asperity.app.cli.campaign import tally_shown
from asperity.app.cli.options import Work
from asperity.base.rows import aligned
from asperity.base.words import data_size
from asperity_research.commands.ensembles import Ensembles
from asperity_research.studies import STUDIES, Concluded, Study, conclude
from asperity_research.studies.campaigns import Home, Prepared, run_campaigns
from asperity_research.studies.typeset import interval, plain

Preparing = AbstractContextManager[tuple[Prepared, ...]]
"""Writes campaigns into a folder, and keeps others out of it."""


def say_studies() -> None:
    """List the studies and their questions."""
    rows = [(study.name, study.question) for study in STUDIES.values()]
    sys.stdout.write(f"{aligned(rows)}\n\nasperity study NAME --quick answers one in minutes\n")


def say_estimate(home: Home, out: Path, prepare: Callable[[Path], Preparing]) -> None:
    """Say how many runs and how much disk each campaign takes, and all, without leaving anything behind.

    Some of them may be done in the folder.
    """
    home.check(out)
    with tempfile.TemporaryDirectory() as nowhere, prepare(Path(nowhere)) as prepared:
        judged = [campaign.estimate(one.plan, out / home.inside / one.campaign.name) for one in prepared]
        rows = [
            (one.campaign.name, *_total([it]), one.campaign.purpose)
            for one, it in zip(prepared, judged, strict=True)
        ]
        sys.stdout.write(f"{aligned([*rows, ('all', *_total(judged), 'every campaign')])}\n")


def _total(judged: Sequence[campaign.Estimate]) -> tuple[str, str]:
    return f"{sum(one.runs for one in judged)} runs", f"about {data_size(sum(one.bytes for one in judged))}"


def answer(one: Study, words: list[str], out: Path, ensembles: Ensembles, work: Work) -> Concluded | None:
    """Run what is missing of a study, write its report, and say what was found; or say what that takes.

    ``words`` are those of the command, for the report. `AsperityError` if the folder cannot be used, the disk
    or the scheduler refused, or some runs failed.
    """
    prepare = partial(one.prepared_in, quick=ensembles.quick, seed=ensembles.seed)
    if work.dry_run:
        say_estimate(one.home, out, prepare)
        return None
    command = command_of(words, out, ensembles)
    with worked_through("campaign", prepare(out), work) as (prepared, say):
        say(f"computing the numbers and drawing the figure{f', {one.takes}' if one.takes else ''}")
        done = conclude(one, out, prepared, quick=ensembles.quick, command=command, seed=ensembles.seed)
    if not work.quiet:
        for finding in done.outcome.findings:
            rows = [("", plain(m.what), plain(str(interval(m.estimate)))) for m in finding.measured]
            sys.stdout.write(f"{finding.verdict.value}: {plain(finding.claim)}\n{aligned(rows)}\n")
        sys.stdout.write(f"\n{done.report}\n")
    return done


def command_of(words: list[str], out: Path, ensembles: Ensembles) -> str:
    """Return the command line that runs a study or a reproduction."""
    return shlex.join(["asperity", *words, "--out", str(out), *ensembles.flags])


@contextmanager
def worked_through(
    what: str, preparing: Preparing, work: Work
) -> Iterator[tuple[tuple[Prepared, ...], Callable[[str], None]]]:
    """Do what is missing of some campaigns; give them, and what prints a line of progress.

    Who interrupts that, or what follows, is told what is kept.
    """

    def say(text: str) -> None:
        if not work.quiet:
            print(text, file=sys.stderr, flush=True)

    @contextmanager
    def watch(one: Prepared) -> Iterator[Callable[[campaign.Tally], None]]:
        if begins:
            say(", ".join(_total([campaign.estimate(each.plan, each.folder) for each in begins])))
            begins.clear()
        number = 1 + [each.folder for each in prepared].index(one.folder)
        say(f"{what} {number} of {len(prepared)}: {one.campaign.purpose}")
        with tally_shown(quiet=work.quiet) as show:
            yield show

    try:
        with preparing as prepared:
            begins = [*prepared]
            run_campaigns(
                prepared,
                workers=work.workers,
                scheduler=work.scheduler,
                retry_failed=work.retry_failed,
                watch=watch,
            )
            yield prepared, say
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            "interrupted; finished runs are kept, and the same command does the rest"
        ) from None
