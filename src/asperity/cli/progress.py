"""Progress: a bar on a terminal, a line for each decade elsewhere, nothing if quiet."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from asperity.aging import Frame
from asperity.runs import Progress, Silent
from asperity.words import printable


@contextmanager
def progress_shown(*, quiet: bool) -> Iterator[Progress]:
    """Choose how progress is shown, on the error stream, until the run ends."""
    if quiet:
        yield Silent()
    elif not sys.stderr.isatty():
        yield _Lines()
    else:
        columns = (
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[state]}"),
            TimeElapsedColumn(),
        )
        with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
            yield _OnTerminal(bar)


class _Lines(Silent):
    """Plain lines, for logs."""

    def __init__(self) -> None:
        self._decade = -math.inf

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        span = f" to t = {times[-1]:g}" if times else ""
        self._say(f"{name}{span}")

    def remark(self, text: str) -> None:
        self._say(f"remark: {text}")

    def reached(self, frame: Frame) -> None:
        # The epsilon puts 10^k, however rounded, at the start of its decade.
        decade = math.floor(math.log10(frame.time) + 1e-9) if frame.time > 0 else -math.inf
        if frame.time == 0 or decade > self._decade:
            self._decade = decade
            self._say(f"  t = {frame.time:<8.4g} {_state(frame)}")

    def _say(self, text: str) -> None:
        print(printable(text), file=sys.stderr, flush=True)


class _OnTerminal(Silent):
    """A bar whose length is the number of times recorded: even in the decades."""

    def __init__(self, bar: Bar) -> None:
        self._bar = bar
        self._task = bar.add_task("", total=None, state="")
        self._times: Sequence[float] = ()

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        self._times = times
        self._bar.reset(self._task, description=printable(name), total=len(times) or None, state="")

    def remark(self, text: str) -> None:
        self._bar.console.print(f"remark: {printable(text)}", highlight=False, markup=False)

    def reached(self, frame: Frame) -> None:
        done = sum(time <= frame.time for time in self._times)
        state = f"t = {frame.time:.3g} of {self._times[-1]:.3g}, {_state(frame)}"
        self._bar.update(self._task, completed=done, state=state)


def _state(frame: Frame) -> str:
    contact = frame.contact
    return f"area {contact.area} sites ({100 * contact.area / contact.heights.size:.3g} %)"
