"""The command ``asperity sweep``: a campaign, in one folder."""

from __future__ import annotations

from pathlib import Path

from asperity.app.cli.command import command
from asperity.app.cli.flags import Out
from asperity.app.cli.options import WORK, Work


@command()
def sweep(plan: Path, /, *, out: Out, work: Work = WORK) -> None:
    """Run a campaign: many runs from one file. The same command again does the remaining runs.

    Parameters
    ----------
    plan
        A TOML file as for asperity run, with lists in a section [sweep]: load = [200.0, 800.0], seeds = 32
    out
        Folder of the campaign, new or to continue.
    """
    work.check()
    from asperity.app.campaign import read_plan

    settings = read_plan(plan)
    from asperity.app.cli import campaign  # takes a second: mistakes are reported before

    (campaign.dry_run if work.dry_run else campaign.sweep)(settings, out, work)
