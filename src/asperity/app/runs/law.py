"""From the configuration of a run to the law of its contact."""

from __future__ import annotations

from typing import Any

from asperity.app.config import RunConfig
from asperity.app.runs.pipeline import Outcome, check_units, completed, unused
from asperity.ask.run import Aging, Contact, Friction, Output
from asperity.base.calls import remarks_made
from asperity.contact_law import law
from asperity.errors import InputError
from asperity.progress import Progress

_UNUSED = {
    "solid": ("draws",),
    "contact": tuple(Contact.keys),
    "aging": ("first", "last", "per_decade", "hold"),
    "friction": tuple(Friction.keys),
    "output": ("maps_at", "pixel", "blur", "threshold"),
}
"""Keys that a law does not use, by section."""


def law_of_config(config: RunConfig, progress: Progress, **asked: Any) -> Outcome:
    """Tabulate the law of a configuration's surface and solid at its times, with arguments of `asperity.law`.

    A half-space of one Poisson's ratio has a tangential stiffness, too. The outcome's configuration gives
    the same law.
    """
    for name, value in (("[[protocol]]", config.protocol), ("[output] measured", config.output.measured)):
        if value:
            expected, advice = "none for a law, whose pressures are held", "asperity run"
            raise InputError(name, expected=expected, got="some", advice=advice)
    solid, surface = config.solid.build(), config.surface.scan
    progress.stage("reading the scan")
    scan = surface.build()
    if solid.in_lengths:
        scan.in_meters()
    check_units(config, solid, scan)
    carried = config.carried.but(**{"stiffness": True} if solid.half_space else {})
    config = config.but(surface=surface, carried=carried)
    rtol = config.aging.rtol
    asked |= {"times": config.aging.times, "carried": config.carries, "rtol": rtol}
    with remarks_made() as made:
        dataset = law(solid, scan, progress=progress, **asked)
    pressed = Contact(pressure=float(dataset["pressure"][-1]))  # without one, `completed` would choose a load
    used, remarks = completed(config.but(contact=pressed), solid, scan)
    update: dict[str, Any] = {"contact": Contact(), "friction": Friction()}
    update |= {
        "output": Output(figures=config.output.figures),
        "aging": Aging(times=dataset["time"].values.tolist(), rtol=rtol),
    }
    remarks = (*dict.fromkeys((*remarks, *made)), *unused(config, "a law", _UNUSED))
    return Outcome(used.but(**update), dataset, None, remarks)
