"""From the configuration of a run to the law of its contact."""

from __future__ import annotations

from typing import Any

from asperity.analysis import law
from asperity.app.config import MeasuredSurface, RunConfig
from asperity.app.config.models import Contact
from asperity.app.runs.pipeline import Outcome, check_units, completed
from asperity.carried import Carried
from asperity.errors import InputError
from asperity.progress import Progress


def law_of_config(config: RunConfig, progress: Progress, **asked: Any) -> Outcome:
    """The law of a configuration's surface and solid at its times; see `asperity.law` for what is asked.

    Where the solid is a half-space of one Poisson's ratio, the tangential stiffness is tabulated.
    """
    for name, put in (("[[protocol]]", config.protocol), ("[output] measured", config.output.measured)):
        if put:
            expected, advice = "none for a law, whose pressures are held", "asperity run"
            raise InputError(name, expected=expected, got="some", advice=advice)
    solid, chosen = config.solid.build(), config.surface
    if isinstance(chosen, MeasuredSurface) and chosen.rule == "mirror":
        chosen = chosen.model_copy(update={"periodic": "reflect"})
    progress.stage("reading the scan")
    scan = chosen.build()
    if solid.in_lengths:
        scan.in_meters()
    check_units(config, solid, scan)
    carried = config.carried.model_copy(update={"stiffness": True} if solid.half_space else {})
    facts = carried.asked(getattr(config.solid, "poisson", None))
    of_law = {"times": config.aging.times, "carried": facts and Carried(**facts), "rtol": config.aging.rtol}
    dataset = law(solid, scan, **of_law, progress=progress, **asked)  # type: ignore[arg-type]
    held = Contact(pressure=float(dataset["pressure"][-1]))
    used = config.model_copy(update={"surface": chosen, "carried": carried, "contact": held})
    used, remarks = completed(used, solid, scan)
    return Outcome(used, dataset, None, (*remarks, *[config.solid.unused] * bool(config.solid.unused)))
