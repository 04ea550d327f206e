"""From the configuration of a run to a prediction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from asperity.app.config import RunConfig
from asperity.app.runs.pipeline import check_units, completed, unused, without_copies
from asperity.ask.prediction import Predict, begins_to_rise, loading_of
from asperity.ask.run import Contact, Friction
from asperity.errors import InputError
from asperity.prediction import predict
from asperity.prediction.predicting import no_half_space
from asperity.prediction.results import Prediction
from asperity.progress import Checkpoint, Progress

_RUN = "asperity run, which takes the same file"
_UNUSED = {"friction": tuple(Friction.keys.keys() - {"shear_strength"}), "output": ("maps_at",)}
"""Keys that a prediction does not use, by section."""


def predict_config(
    config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None, **own: Any
) -> Prediction:
    """Ask `asperity.predict` for the solid, surface, load and times of a run, with arguments of its own.

    The load is applied instantly, or within a ramp; or it follows a protocol, before which it is 0 unless the
    file says more. `AsperityError` as there; or what is asked for has no band.
    """
    for section, key in (("contact", "separation"), ("aging", "hold")):
        value = getattr(getattr(config, section), key)
        if value not in (None, "load"):
            expected, path = "a load, which a band covers", (section, key)
            raise InputError(key, expected=expected, got=value, advice=_RUN, path=path)
    read = getattr(config.protocol, "read", "")
    if begins_to_rise(config.protocol) and not config.contact.table:
        config = config.but(contact=Contact(load=0.0))
    loading = loading_of(config.protocol, *config.contact.table.values())
    ramp = loading[0].duration if loading else Predict.own()["ramp"].read("ramp", own.get("ramp"))
    times = _times(config, ramp or 0.0)
    material = config.solid.material
    if not material.solid.half_space:
        raise no_half_space("kind", config.solid.kind).about("kind", "solid", "kind")
    surface = without_copies(config)
    progress.stage("reading the scan")
    scan = surface.build()
    scan.in_meters()
    check_units(config, material.solid, scan)
    not_used = unused(config, "a prediction", _UNUSED)
    config, remarks = completed(config.but(surface=surface), material.solid, scan)
    prediction = predict(
        material,
        scan,
        **{name: load for name, load in config.contact.table.items() if load},
        **times,
        protocol=config.protocol or None,
        shear_strength=config.friction.shear_strength,
        carried=config.carries,
        instrument=config.output.instrument,
        rtol=config.aging.rtol,
        progress=progress,
        checkpoint=checkpoint,
        **own,
    )
    said = read, *remarks, *not_used, *prediction.remarks
    return replace(prediction, remarks=tuple(filter(None, dict.fromkeys(said))))


def _times(config: RunConfig, ramp: float) -> dict[str, Any]:
    """Arguments of a prediction about the times to record."""
    aging, (first, last) = config.aging, config.span
    if aging.times is not None:
        return {"times": aging.times}
    times = {"first": aging.first or max(first, ramp), "per_decade": aging.per_decade}
    return times if config.protocol else times | {"last": last}
