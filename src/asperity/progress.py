"""Progress of a run: a bar in notebooks and on terminals, a line for each decade elsewhere; and its place."""

from __future__ import annotations

import math
import sys
import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from html import escape
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from asperity.base import checks
from asperity.errors import printable

if TYPE_CHECKING:
    from rich.progress import Progress as Bar

_EVERY = 0.1
"""Seconds between changes of a bar in a notebook."""

LINE_EVERY = 10.0
"""Seconds between two plain lines, unless more is to be said."""


def listener(
    progress: Progress | Callable[[Any], None] | bool | None,
) -> AbstractContextManager[Progress]:
    """A context with the `Progress` of a run: a bar for True, the user's own, or none."""
    if progress is True:
        return progress_shown()
    return nullcontext(_Call(progress) if callable(progress) else progress or Progress())


@contextmanager
def progress_shown() -> Iterator[Progress]:
    """Show progress in the notebook, or else on the error stream, until the run ends."""
    notebook = _notebook()
    if notebook is not None:
        shown = _InNotebook(notebook)
        try:
            yield shown
        finally:
            shown.end()
    elif sys.stderr is None or not sys.stderr.isatty():
        yield _Lines()
    else:
        from rich.console import Console
        from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn
        from rich.progress import Progress as Shown

        stage, state = map(TextColumn, ("{task.description}", "{task.fields[state]}"))
        columns = SpinnerColumn(), stage, BarColumn(), state, TimeElapsedColumn()
        with Shown(*columns, console=Console(stderr=True), transient=True) as bar:
            yield _OnTerminal(bar)


class Progress:
    """Listener to the progress of a run; this one shows nothing."""

    times: Sequence[float] = ()
    """Times that aging will record."""

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        """Begin a stage; aging passes the times that it will record."""

    def completed(self, config: Any) -> None:
        """The configuration is complete, with load and times."""

    def remark(self, text: str) -> None:
        """A remark to show before the run ends."""

    def reached(self, frame: Any) -> None:
        """Aging has reached this `asperity.Frame`."""

    def _done(self, frame: Any) -> int:
        """Number of times recorded so far."""
        return sum(time <= frame.time for time in self.times)

    def _state(self, frame: Any) -> str:
        return f"t = {frame.time:.3g} of {self.times[-1]:.3g}, {_area(frame)}"


class _Call(Progress):
    """Calls a function of the user with each `asperity.Frame`."""

    def __init__(self, call: Callable[[Any], None]) -> None:
        self._call = call

    def reached(self, frame: Any) -> None:
        self._call(frame)


class _Lines(Progress):
    """Plain lines, for logs."""

    _decade = _said = -math.inf

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        span = f" to t = {times[-1]:g}" if times else ""
        self._say(f"{name}{span}")

    def remark(self, text: str) -> None:
        self._say(f"remark: {text}")

    def reached(self, frame: Any) -> None:
        # The epsilon puts 10^k, however rounded, at the start of its decade.
        decade = math.floor(math.log10(frame.time) + 1e-9) if frame.time > 0 else -math.inf
        is_late = clock.monotonic() - self._said > LINE_EVERY
        if frame.time == 0 or decade > self._decade or is_late:
            self._decade = decade
            self._say(f"  t = {frame.time:<8.4g} {_area(frame)}")

    def _say(self, text: str) -> None:
        print(printable(text), file=sys.stderr, flush=True)
        self._said = clock.monotonic()


class _OnTerminal(Progress):
    """A bar whose length is the number of times recorded."""

    def __init__(self, bar: Bar) -> None:
        self._bar = bar
        self._task = bar.add_task("", total=None, state="")

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        self.times = times
        self._bar.reset(self._task, description=printable(name), total=len(times) or None, state="")

    def remark(self, text: str) -> None:
        self._bar.console.print(f"remark: {printable(text)}", highlight=False, markup=False)

    def reached(self, frame: Any) -> None:
        self._bar.update(self._task, completed=self._done(frame), state=self._state(frame))


class _InNotebook(Progress):
    """A bar as HTML below the cell, which changes in place without widgets."""

    def __init__(self, display: ModuleType) -> None:
        self._display = display
        self._handle = display.display(display.HTML(""), display_id=True)
        self._name, self._inside, self._changed = "", "", -math.inf
        self._remarks: list[str] = []

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        self._name, self.times = name, times
        self._change("<progress></progress>" if not times else self._bar(0, ""), now=True)

    def remark(self, text: str) -> None:
        self._remarks.append(f"<div>remark: {escape(text)}</div>")
        self._change(self._inside, now=True)

    def reached(self, frame: Any) -> None:
        self._change(self._bar(self._done(frame), self._state(frame)))

    def end(self) -> None:
        """Show the last state, also if it came within `_EVERY`."""
        self._change(self._inside, now=True)

    def _bar(self, done: int, state: str) -> str:
        return f'<progress max="{len(self.times)}" value="{done}"></progress> {escape(state)}'

    def _change(self, inside: str, *, now: bool = False) -> None:
        self._inside = inside
        if now or clock.monotonic() - self._changed > _EVERY:
            self._changed = clock.monotonic()
            html = f"<div>{escape(self._name)} {inside}</div>{''.join(self._remarks)}"
            self._handle.update(self._display.HTML(html))


def _notebook() -> ModuleType | None:
    """IPython's module for display in a notebook; None elsewhere, also in IPython on a terminal."""
    ipython, display = sys.modules.get("IPython"), sys.modules.get("IPython.display")
    shell = ipython.get_ipython() if ipython is not None else None
    return display if hasattr(shell, "kernel") else None


def _area(frame: Any) -> str:
    contact = frame.contact
    return f"area {contact.area} sites ({100 * contact.contact_fraction:.3g} %)"


@dataclass(frozen=True)
class Checkpoint:
    """File in which a computation keeps its place, and how often.

    Parameters
    ----------
    path
        The file; it appears under its name only when it is complete, and stays after the computation.
    every
        Least number of seconds between two writes.
    """

    path: str | Path
    every: float = 10.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "every", checks.number("every", self.every, least=0))
