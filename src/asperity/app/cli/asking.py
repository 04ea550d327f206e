"""Commands that answer the question of a configuration in a folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.app.cli.new_files import check_free
from asperity.app.cli.options import Results

if TYPE_CHECKING:
    from asperity.app.config import RunConfig
    from asperity.app.config.mistakes import Door

_CHECKPOINT_EVERY = 20.0
"""Seconds between checkpoints: shorter computations leave none."""


def answer_into(
    out: Path,
    door: Door,
    results: Results,
    question: str = "",
    check: Callable[[RunConfig], object] = lambda _: None,
    **how: Any,
) -> None:
    """Answer what came through a door in a folder; `how` are facts for what it writes.

    `check` refuses what is asked of the files before hours have passed.
    """
    from asperity.app.config.reading import config_at

    config = config_at(door, question=question)
    check(config)
    folder = check_free(out, results)
    # The engine takes a second to import: mistakes are reported before.
    from asperity.app.cli.computing import compute_into
    from asperity.app.config import to_toml
    from asperity.app.runs import answer

    with door.answering(config):
        compute_into(
            config.asked or "run",
            folder,
            to_toml(config),
            lambda **progress: answer(config, **progress),
            rows=lambda outcome: outcome.rows(),
            write=lambda outcome, place: outcome.write(place, **how),
            every=_CHECKPOINT_EVERY,
        )
