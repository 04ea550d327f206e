"""From the file of a run to friction and contact area against speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from asperity.app.config import RunConfig
from asperity.app.runs.outcome import Outcome
from asperity.app.runs.pipeline import check_units, completed, without_copies
from asperity.app.runs.words import read_rows
from asperity.base.calls import remarks_made
from asperity.base.rows import Row
from asperity.progress import Checkpoint, Progress
from asperity.sliding import steady_sliding
from asperity.sliding.rows import rows_of

if TYPE_CHECKING:
    from asperity.figures import Drawing


class Slid(Outcome):
    """Friction and contact area over speeds."""

    over = ("speed",)

    def rows(self) -> list[Row]:
        """See `Outcome`."""
        return [*read_rows(self.config), *rows_of(self.dataset)]

    def drawings(self) -> dict[str, Callable[[], Drawing]]:
        """See `Outcome`."""
        from asperity.figures import steady_sliding_figure

        return {"sliding": lambda: steady_sliding_figure(self.dataset)}


def slide(config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None) -> Slid:
    """Slide a configuration's surface over its solid; it takes seconds a speed, and keeps no checkpoint."""
    del checkpoint
    material, surface = config.solid.material, without_copies(config)
    progress.stage("reading the scan")
    scan = surface.build()
    check_units(config, material.solid, scan)
    held = {name: load for name, load in config.contact.table.items() if load}
    law = config.friction.strength
    config, remarks = completed(config.but(surface=surface), material.solid, scan)
    with remarks_made() as made:
        dataset = steady_sliding(
            material, scan, shear_strength=law, progress=progress, **held, **vars(config.own)
        )
    return Slid(config, dataset, (*dict.fromkeys((*remarks, *made)),))
