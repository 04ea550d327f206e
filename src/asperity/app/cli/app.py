"""The commands, and the one place where errors become words.

Exit status: 0 for success, 2 for bad input, 1 for any other failure, 130 when interrupted or
terminated. The engine is imported inside the commands, so that help and mistakes in the arguments appear
at once.
"""

from __future__ import annotations

import logging
import os
import re
import sys
import warnings
from collections.abc import Sequence
from typing import Any, Literal

from cyclopts import App
from cyclopts.exceptions import CycloptsError, UnknownCommandError

from asperity.app.cli import (
    explore,
    fit,
    friction,
    gather,
    infer,
    law,
    predict,
    run,
    sliding,
    status,
    surface,
    sweep,
)
from asperity.app.cli.command import app, command
from asperity.app.cli.flags import naming
from asperity.app.cli.terminal import complain, make_streams_safe, silence_output, widen
from asperity.base.calls import outside
from asperity.base.files import command_running
from asperity.errors import AsperityError, ConfigError, InputError, Remark

__all__ = ["answer", "app", "with_others"]

_COMMANDS = (run, predict, law, sliding, surface, fit, infer, friction, sweep, status, gather, explore)
"""Modules of the commands: each adds its own when it is imported."""


@command(name="--install-completion")
def install_completion(*, shell: Literal["bash", "zsh", "fish", "powershell"] | None = None) -> None:
    """Let the Tab key complete commands and flags, from the next start of the shell.

    Parameters
    ----------
    shell
        The shell. [default: the one that runs this command]
    """
    from cyclopts.completion.install import create_install_completion_command

    create_install_completion_command(app.install_completion, add_to_startup=True)(shell=shell)


def with_others() -> App:
    """The command with the commands of other installed distributions."""
    list(outside("asperity.commands"))  # each adds its commands when it is imported
    return app


_OWN = {*(name for name in app if not name.startswith("-")), *app.version_flags}
"""Words that begin a command of this distribution."""


def answer(arguments: list[str]) -> int:
    """Do what the words after ``asperity`` say, and return the exit status."""
    make_streams_safe()
    widen()
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # else it reports its cache of fonts
    with warnings.catch_warnings(), command_running():
        warnings.showwarning = _show_warning
        if not any(word in _OWN for word in arguments[:1]):
            with_others()
        # A shell leaves the ~ of --out=~/x, and quoted ones.
        words = (re.split("(?<==)(?=~)", word, maxsplit=1) for word in arguments)
        return _run(["".join(map(os.path.expanduser, parts)) for parts in words])


def _run(arguments: list[str]) -> int:
    try:
        try:
            if arguments[:1] and arguments[0] in app and arguments[1:] in (["--help"], ["-h"]):
                app.help_print(arguments[:1])  # at once: to parse it would find all flags of a command twice
            else:
                app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        except InputError:
            with naming(**_flags_of(arguments)):
                raise
        sys.stdout.flush()
    except CycloptsError as error:
        return complain(2, _usage(error))
    except ConfigError as error:
        return complain(2, *error.shown)
    except InputError as error:
        return complain(2, str(error))
    except AsperityError as error:
        return complain(1, str(error))
    except BrokenPipeError:
        silence_output()
        return 1
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return complain(1, f"{where}{error.strerror or error}")
    except MemoryError as error:
        return complain(1, f"not enough memory: {str(error) or 'try a smaller surface'}")
    except KeyboardInterrupt as interrupt:
        return complain(130, str(interrupt) or "interrupted; nothing was written")
    return 0


def _flags_of(words: Sequence[str]) -> dict[str, str]:
    """Flags of the command of these words, by the names of its arguments."""
    commands = [app[word] for word in words[:1] if word in app]
    arguments = [one for command in commands for one in command.assemble_argument_collection()]
    named = {one.field_info.name: one.names[0] for one in arguments if one.names and one.parse}
    return {name: flag for name, flag in named.items() if flag.startswith("--")}


def _show_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, *_: Any, **__: Any
) -> None:
    if issubclass(category, Remark):
        print("remark:", " ".join(str(message).split()), file=sys.stderr)
    else:
        sys.stderr.write(warnings.formatwarning(message, category, filename, lineno))


_OF_RESEARCH = ("challenge", "experiment", "reproduce", "study")
"""Commands of the distribution asperity-research."""


def _usage(error: CycloptsError) -> str:
    word = (error.unused_tokens or [""])[0]
    if isinstance(error, UnknownCommandError) and word in _OF_RESEARCH:
        from asperity.base.checks import installed_from

        source = installed_from("asperity-research")
        return f"asperity {word} comes with asperity-research; try pip install {source}"
    command = " ".join(("asperity", *(error.command_chain or ())))
    return f"{str(error).rstrip('.')} (see {command} --help)"
