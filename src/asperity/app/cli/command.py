"""The command ``asperity``, to which modules add their commands.

Another distribution adds some by an entry point in the group ``asperity.commands``: a module that, when it is
imported, gives its functions to `command`. Such a module may also take `flags.Out`, `Switch`, `Whole` and
`naming`; `options.Work` and `flags_of_fields`; `campaign.tally_shown`, `output.write_figure`;
`new_files.check_new_file` and `FIGURE_SUFFIXES`; `asperity.app.config.RunConfig` and `config_from`; of
`asperity.base.words` `counted`, `data_size`, `duration`, `power` and `thousands`; of `asperity.base.rows`
`Row`, `aligned` and `words_of`; and `asperity.base.checks.instance` and `asperity.base.calls.showing`. These
names stay.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable
from typing import ParamSpec

from cyclopts import App

from asperity.app.cli.flags import flags_for
from asperity.app.cli.options import paragraphs
from asperity.base.version import __version__

app = App(
    name="asperity",
    help="How the real contact between rough solids grows old.",
    version=__version__,
    version_flags=("--version", "-V"),
    help_format="plaintext",
    suppress_keyboard_interrupt=False,
)


_P = ParamSpec("_P")


def command(
    *sections: str, name: str | None = None, of: App = app
) -> Callable[[Callable[_P, None]], Callable[_P, None]]:
    """Add a command; its parameter ``keys`` takes the flags for the keys of sections of the configuration."""

    def add(command: Callable[_P, None]) -> Callable[_P, None]:
        command.__doc__ = paragraphs(command.__doc__ or "")
        usage = None
        if sections:
            place = next(iter(inspect.signature(command).parameters.values()))
            words = f"[{place.name}]" if place.default is None else place.name
            # The library would find all flags once more to say this.
            usage = f"Usage: asperity {command.__name__} [OPTIONS] {words.upper()}"
        of.command(command, name=name, usage=usage)
        if sections:
            # Words, which are read when the command is used: to add it would read all at once.
            vars(sys.modules[command.__module__])["flags_for"] = flags_for
            command.__annotations__["keys"] = f"flags_for{sections} | None"
        return command

    return add
