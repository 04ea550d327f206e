"""The process that computes: runs come through its input, and how far each has come goes to its output.

It imports and compiles everything once, and then takes one run after the other. It ends with its input.
Whoever does not want a run any more kills it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
from collections.abc import Callable, Sequence
from dataclasses import replace
from queue import SimpleQueue
from time import perf_counter

from asperity.aging import Frame
from asperity.app.config import RunConfig, to_toml
from asperity.app.config.python import to_python
from asperity.app.explore.folders import PICTURED
from asperity.app.explore.mistakes import Shown, failed, mistakes_of
from asperity.app.explore.scene import Header, Recording, ending, mapped, of_frame, pictured, started
from asperity.app.runs import Progress, answer
from asperity.app.runs.loops import compile_loops
from asperity.base.machine import end_with
from asperity.base.rows import Row, remarks, words_of

Tell = Callable[[str, object], None]
"""Sends what kind of message it is, and its content."""


def work() -> None:
    """Compute one run after the other: the body of the process."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no answer
    with contextlib.suppress(AttributeError, OSError):
        os.nice(5)  # the server answers first

    def tell(sort: str, content: object) -> None:
        message = pickle.dumps((sort, content))
        answers.write(len(message).to_bytes(8, "little") + message)
        answers.flush()

    runs: SimpleQueue[tuple[RunConfig, Shown, str]] = SimpleQueue()

    def listen() -> None:
        with open(0, "rb", closefd=False) as asked:
            while True:
                runs.put(pickle.load(asked))

    end_with(listen)
    with contextlib.suppress(BrokenPipeError):
        compile_loops(lambda text: tell("stage", text), lambda _: None)
        while True:
            run = runs.get()
            tell("taken", None)
            tell("end", _computed(tell, *run))


def _renamed(config: RunConfig, shown: Shown, which: int) -> RunConfig:
    """A configuration whose files have their names in the form of the page (0), or in texts (1)."""
    names = {section: shown[file][which] for section, file in config.files.items() if file in shown}
    return config.with_files(names)


class _Teller(Progress):
    """Tells how far a run has come."""

    def __init__(self, tell: Tell, asked: RunConfig, shown: Shown, title: str) -> None:
        self._tell, self._asked, self._shown, self._title = tell, asked, shown, title
        self._recording = Recording("")
        self._config = asked
        self._times: Sequence[float] = ()
        self._mapped: set[float] = set()

    def stage(self, name: str, times: Sequence[float] = ()) -> None:
        self._times = times
        self._tell("stage", name)

    def completed(self, config: RunConfig) -> None:
        self._config = config

    def reached(self, frame: Frame) -> None:
        if self._recording.scene is None:
            written = self._config.but(output=self._asked.output)
            page, user = (_renamed(written, self._shown, which) for which in (0, 1))
            python = "" if user.asked else to_python(user, list(self._times))
            texts = {"toml": to_toml(user), "python": python}
            self._recording.begin(started(frame, written), page, self._title, last_time=written.end, **texts)
            scene: Header = self._recording.scene or {}
            moments = [*scene["switches"], *(written.output.maps_at or ())]
            self._mapped = mapped(self._times, moments, frame.contact.heights.size)
            self._tell("scene", (scene, self._recording.heights))
        row, new_map = of_frame(frame)
        self._recording.add_row(row)
        wanted = any(abs(frame.time - time) <= 1e-9 * time for time in self._mapped)
        self._tell("row", (self._recording.rows[-1], new_map if wanted else None))


def _computed(tell: Tell, config: RunConfig, shown: Shown, title: str) -> Header:
    begun, teller = perf_counter(), _Teller(tell, config, shown, title)
    # The page takes its maps from the moments as they come, unless an instrument looks at those of the run.
    if not config.asked and config.output.maps_at is None and not config.output.instrument:
        output = config.output.but(maps_at=[])
        config = config.but(output=output)
    try:
        outcome = answer(config, teller)
        rows = [*outcome.rows(), Row("cost", f"{perf_counter() - begun:.1f} s"), *remarks(*outcome.remarks)]
        if config.asked in PICTURED:
            page, user = (_renamed(outcome.config, shown, which) for which in (0, 1))
            return pictured(replace(outcome, config=page), title, words_of(rows), to_toml(user))
    except BrokenPipeError:
        raise
    except Exception as error:  # said to the user, in the page
        return failed(mistakes_of(error, shown))
    return ending(outcome.dataset, words_of(rows))
