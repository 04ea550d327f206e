"""The command line: arguments in, the package's verbs called, words out."""

import os
import signal
import sys
import threading
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line on words, by default those after ``asperity``; return the exit status."""
    came: list[int] = []

    def stop(number: int, _: object) -> None:
        came.append(number)
        raise KeyboardInterrupt

    if threading.current_thread() is threading.main_thread():
        usual = {signal.SIGTERM: signal.SIG_DFL, signal.SIGINT: signal.default_int_handler}
        for number, handler in usual.items():  # termination ends with what Ctrl-C says
            if signal.getsignal(number) == handler:
                signal.signal(number, stop)
    if arguments is None:  # no window opens, whatever a notebook has left for its own pictures
        os.environ["MPLBACKEND"] = "agg"
    try:  # an interruption may come while the commands are imported
        from asperity.app.cli.app import answer

        return answer(sys.argv[1:] if arguments is None else list(arguments))
    except BaseException as error:  # of whatever an import has made of the interruption
        interrupted = isinstance(error, KeyboardInterrupt)
        if not came and not interrupted:
            raise
        reason = interrupted and str(error)
        print(f"asperity: {reason or 'interrupted; nothing was written'}", file=sys.stderr)
        return 130


__all__ = ["main"]
