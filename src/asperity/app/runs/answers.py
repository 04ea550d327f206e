"""The answer to any question of a file."""

from __future__ import annotations

from collections.abc import Callable

from asperity.app.config import RunConfig
from asperity.app.runs.law import tabulate
from asperity.app.runs.outcome import Outcome
from asperity.app.runs.pipeline import execute
from asperity.app.runs.prediction import foretell
from asperity.app.runs.sliding import slide
from asperity.progress import Checkpoint, Progress

ANSWERS: dict[str, Callable[..., Outcome]] = {
    "": execute,
    "prediction": foretell,
    "law": tabulate,
    "sliding": slide,
}
"""What answers each question, by its section; a run has none."""


def answer(config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None) -> Outcome:
    """Answer the question of a configuration; `AsperityError` as the verbs of the library raise it."""
    return ANSWERS[config.asked](config, progress, checkpoint=checkpoint)
