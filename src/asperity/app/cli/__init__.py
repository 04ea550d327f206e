"""The command line: arguments in, the package's verbs called, words out."""

from asperity.app.cli.app import main

__all__ = ["main"]
