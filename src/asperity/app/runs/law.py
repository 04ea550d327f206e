"""From the file of a run to the law of its contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from asperity.app.config import RunConfig
from asperity.app.runs.outcome import Outcome
from asperity.app.runs.pipeline import completed
from asperity.app.runs.words import read_rows
from asperity.base.calls import remarks_made
from asperity.base.rows import Row
from asperity.contact_law import law
from asperity.contact_law.programs import FILES, Program, law_for
from asperity.contact_law.rows import rows_of
from asperity.progress import Checkpoint, Progress

if TYPE_CHECKING:
    from asperity.figures import Drawing


class Tabulated(Outcome):
    """A law."""

    over = ("direction", "time", "pressure")

    def rows(self) -> list[Row]:
        """See `Outcome`."""
        return [*read_rows(self.config), *rows_of(self.dataset)]

    def drawings(self) -> dict[str, Callable[[], Drawing]]:
        """See `Outcome`."""
        from asperity.figures import law_figure

        return {"law": lambda: law_figure(self.dataset)}

    def write(self, folder: Path, *, programs: Sequence[Program] = (), **how: Any) -> None:
        """Write also files for other programs, as `law_for` takes it."""
        super().write(folder)
        for program in programs:
            for direction in self.dataset["direction"].values.tolist():
                text = law_for(program, self.dataset, direction=direction, **how)
                prefix = "" if direction == "loading" else f"{direction}_"
                (folder / f"{prefix}{FILES[program]}").write_text(text, encoding="utf-8")


def tabulate(config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None) -> Tabulated:
    """Tabulate the law of a configuration's surface and solid at its times.

    A half-space of one Poisson's ratio has a tangential stiffness, too.
    """
    solid, surface = config.solid.build(), config.surface.scan
    progress.stage("reading the scan")
    scan = surface.build()
    if solid.in_lengths:
        scan.in_meters()
    if solid.half_space:
        config = config.but(carried=config.carried.but(stiffness=True))
    asked = {"times": config.aging.times, "carried": config.carries, "rtol": config.aging.rtol}
    with remarks_made() as made:
        dataset = law(solid, scan, progress=progress, checkpoint=checkpoint, **vars(config.own) | asked)
    config, remarks = completed(config.but(surface=surface), solid, scan)
    aging = config.aging.but(times=dataset["time"].values.tolist())
    return Tabulated(config.but(aging=aging), dataset, (*dict.fromkeys((*remarks, *made)),))
