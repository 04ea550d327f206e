"""From the configuration of a run to friction and contact area against speed."""

from __future__ import annotations

from typing import Any

from asperity.app.config import RunConfig
from asperity.app.runs.pipeline import Outcome, check_units, completed, unused, without_copies
from asperity.ask.run import Aging, Carried, Output
from asperity.base.calls import remarks_made
from asperity.errors import InputError
from asperity.progress import Checkpoint, Progress
from asperity.sliding import steady_sliding

_UNUSED = {
    "solid": ("draws",),
    "aging": tuple(Aging.keys),
    "carried": tuple(Carried.keys),
    "output": ("maps_at", "measured", "pixel", "blur", "threshold"),
}
"""Keys that steady sliding does not use, by section."""


def sliding_of_config(
    config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None, **asked: Any
) -> Outcome:
    """Slide a configuration's surface over its solid, with arguments of `asperity.steady_sliding`.

    It takes seconds a speed, and keeps no checkpoint. The outcome's configuration gives the same curve.
    """
    del checkpoint
    if config.protocol:
        expected, advice = "none for steady sliding, which is at a speed for ever", "asperity run"
        raise InputError("[[protocol]]", expected=expected, got="some", advice=advice)
    if config.contact.separation is not None:
        expected, path = "a load or a pressure, under which the profile slides", ("contact", "separation")
        raise InputError("separation", expected=expected, got=config.contact.separation, path=path)
    held: dict[str, Any] = {name: load for name, load in config.contact.table.items() if load}
    if not held:
        path = ("contact", "pressure")
        raise InputError("pressure", expected="a pressure or a load", got="neither", path=path)
    material, surface = config.solid.material, without_copies(config)
    progress.stage("reading the scan")
    scan = surface.build()
    check_units(config, material.solid, scan)
    not_used = unused(config, "steady sliding", _UNUSED)
    config, remarks = completed(config.but(surface=surface), material.solid, scan)
    with remarks_made() as made:
        dataset = steady_sliding(
            material, scan, shear_strength=config.friction.strength, progress=progress, **held, **asked
        )
    output = Output(figures=config.output.figures)
    return Outcome(
        config.but(aging=Aging(), carried=Carried(), output=output),
        dataset,
        None,
        (*dict.fromkeys((*remarks, *made)), *not_used),
    )
