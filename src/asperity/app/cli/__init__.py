"""The command line: reads arguments, calls the library, and prints."""

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
        for number, handler in usual.items():  # termination prints the message of Ctrl-C
            if signal.getsignal(number) == handler:
                signal.signal(number, stop)
    if arguments is None:  # no window opens, whatever backend a notebook set
        os.environ["MPLBACKEND"] = "agg"
    try:  # an interruption may come while the commands are imported
        from asperity.app.cli.app import answer

        return answer(sys.argv[1:] if arguments is None else list(arguments))
    except BaseException as error:  # an import may turn the interruption into any error
        interrupted = isinstance(error, KeyboardInterrupt)
        if not came and not interrupted:
            raise
        reason = interrupted and str(error)
        print(f"asperity: {reason or 'interrupted; nothing was written'}", file=sys.stderr)
        return 130


__all__ = ["main"]
