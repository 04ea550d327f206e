"""The command line: arguments in, the package's verbs called, words out."""

import signal
import sys
import threading
from collections.abc import Sequence


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line on words, by default those after ``asperity``; return the exit status."""
    in_main = threading.current_thread() is threading.main_thread()
    if in_main and signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends with what Ctrl-C says
    try:  # an interruption may come while the commands are imported
        from asperity.app.cli.app import answer

        return answer(sys.argv[1:] if arguments is None else list(arguments))
    except KeyboardInterrupt as interrupt:
        print(f"asperity: {str(interrupt) or 'interrupted; nothing was written'}", file=sys.stderr)
        return 130


__all__ = ["main"]
