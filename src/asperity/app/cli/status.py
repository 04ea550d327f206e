"""The command ``asperity status``: the progress of a campaign."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from asperity.app.cli.command import command
from asperity.base.files import kind_of, named
from asperity.errors import InputError


@command()
def status(out: Path, /) -> None:
    """Count the runs of a campaign that are done, running, failed (and why), and left.

    Parameters
    ----------
    out
        Folder of the campaign.
    """
    check_campaign("status", out)
    from asperity.app.campaign import load_plan, tally
    from asperity.app.cli.campaign import tally_table

    plan = load_plan(out)
    sys.stdout.write(f"{tally_table(plan, tally(plan, out))}\n")


def check_campaign(command: str, out: Path) -> None:
    """Refuse a folder of anything but a campaign, and name what it is."""
    if (kind := kind_of(out)) == "campaign":
        return
    word, inside = shlex.quote(str(out)), next((path.parent for path in out.glob("*/seed")), None)
    advice = f"asperity {command} {word}/studies/NAME for one of its studies, "
    advice += f"or asperity reproduce --out {word} for what is missing"
    for wrong, expected, advised in (
        ((out / "studies").is_dir(), "a reproduction", advice),
        (inside is not None, "a study", f"asperity {command} {shlex.quote(str(inside))}/CAMPAIGN"),
        (bool(kind), named(kind or "folder"), "its summary.txt"),
    ):
        if wrong:
            got = f"{out}, the folder of {expected}"
            raise InputError(command, expected="the folder of a campaign", got=got, advice=advised)
