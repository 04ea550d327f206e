"""From the configuration of a run to the law of its contact."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr

from asperity.analysis import law
from asperity.app.config import MeasuredSurface, RunConfig
from asperity.app.config.models import Contact
from asperity.app.runs.pipeline import check_units, completed
from asperity.carried import Carried
from asperity.progress import Progress
from asperity.results import Checkpoint


def law_of_config(
    config: RunConfig,
    progress: Progress,
    *,
    pressures: Sequence[str],
    per_decade: int,
    checkpoint: Checkpoint | None = None,
) -> tuple[xr.Dataset, RunConfig, tuple[str, ...]]:
    """The law of the surface and the solid of a configuration, what was used of it, and remarks.

    Ages are its times to record. Where the solid is a half-space of one Poisson's ratio, the tangential
    stiffness is tabulated.
    """
    solid, chosen = config.solid.build(), config.surface
    if isinstance(chosen, MeasuredSurface) and chosen.rule == "mirror":
        chosen = chosen.model_copy(update={"periodic": "reflect"})
    progress.stage("reading the scan")
    scan = chosen.build()
    check_units(config, solid, scan)
    asked = config.carried.model_copy(update={"stiffness": True} if solid.half_space else {})
    facts = asked.asked(getattr(config.solid, "poisson", None))
    dataset = law(
        solid,
        scan,
        pressures=pressures,
        times=config.aging.times,
        per_decade=per_decade,
        carried=None if facts is None else Carried(**facts),
        rtol=config.aging.rtol,
        progress=progress,
        checkpoint=checkpoint,
    )
    held = {"contact": Contact(pressure=float(dataset["pressure"][-1])), "surface": chosen}
    used, remarks = completed(config.model_copy(update={**held, "carried": asked}), solid, scan)
    return dataset, used, (*remarks, *((config.solid.unused,) if config.solid.unused else ()))
