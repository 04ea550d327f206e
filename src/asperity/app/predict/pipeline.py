"""From the configuration of a run to a prediction."""

from __future__ import annotations

from dataclasses import replace

from asperity.analysis.predicting import (
    LEAST_TIMES,
    check_legs,
    check_ramp,
    check_span,
    no_half_space,
    positive_quantity,
    predicted,
)
from asperity.analysis.prediction import Prediction
from asperity.app.config import RunConfig
from asperity.app.runs.pipeline import check_units, completed, recorded_times, unused
from asperity.ask.run import Contact as ContactSection
from asperity.errors import InputError
from asperity.lattice import Field
from asperity.progress import Progress
from asperity.protocols import Hold, Ramp
from asperity.results import Checkpoint

_RUN = "asperity run, which takes the same file"


def predict_config(
    config: RunConfig,
    progress: Progress,
    *,
    ramp: float | str | None = None,
    resolution_study: bool = False,
    checkpoint: Checkpoint | None = None,
) -> Prediction:
    """Predict from the configuration of a run: the same solid, surface, load and times as `execute` takes.

    The load is applied instantly, or within a ramp, see `asperity.predict`; or it follows a protocol, before
    which it is 0 unless the file says more. `AsperityError` as there; or what is asked for has no band.
    """
    loading = 0.0 if ramp is None else positive_quantity("ramp", ramp, "s")
    if not loading:
        config, loading = _loading_of(config)
    asked = {"[contact] separation": config.contact.separation, "[aging] hold": config.aging.hold}
    for name, value in asked.items():
        if value not in (None, "load"):
            raise InputError(name, expected="a load, which a band covers", got=value, advice=_RUN)
    legs = config.written_out
    if legs:
        check_legs("protocol", legs, ramp=ramp)
    material, surface = config.solid.material, config.surface.scan
    if not material.solid.half_space:
        raise no_half_space("[solid] kind", config.solid.kind)
    if surface is not config.surface and config.contact.load is not None:
        expected = "'reflect' beside a load, for one on mirrored copies is that of all of them"
        advice = "periodic = 'reflect', or a pressure"
        raise InputError("[surface] periodic", expected=expected, got="'mirror'", advice=advice)
    aging = config.aging
    if aging.times is None and aging.first is None and config.span[0] < loading < config.span[1]:
        config = config.but(aging=aging.but(first=loading))
    progress.stage("reading the scan")
    scan = surface.build()
    scan.in_meters()
    check_units(config, material.solid, scan)
    idle = {"friction": ("rate_coefficient", "reference_velocity"), "output": ("maps_at",)}
    not_used = unused(config, "a prediction", idle)
    config, remarks = completed(config.but(surface=surface), material.solid, scan)
    times = recorded_times(config)
    times = times[times > 0]
    if not legs:
        _check_times(config, times)
        check_ramp(loading, times[-1])
    prediction = predicted(
        material,
        scan,
        times,
        config.contact.table,
        legs=legs,
        ramp=loading,
        strength=config.friction.shear_strength,
        carried=config.carries,
        instrument=config.output.instrument,
        study=resolution_study,
        progress=progress,
        checkpoint=checkpoint,
        rtol=config.aging.rtol,
    )
    return replace(prediction, remarks=tuple(dict.fromkeys((*remarks, *not_used, *prediction.remarks))))


def _check_times(config: RunConfig, times: Field) -> None:
    """Refuse times that are too few or too close for a growth."""
    name, advice, last = "per_decade", "a later last or more per_decade", "[aging] last"
    if config.aging.times is not None:
        name, advice, last = "times", "more times", "[aging] times"
    if times.size < LEAST_TIMES:
        expected = f"{LEAST_TIMES} times or more after 0"
        raise InputError(f"[aging] {name}", expected=expected, got=f"{times.size}", advice=advice)
    check_span(last, times[0], times[-1])


def _loading_of(config: RunConfig) -> tuple[RunConfig, float]:
    """Replace a protocol of a ramp and a hold by a load and its ramp; or begin another one at load 0."""
    pressed = config.contact.table
    match config.protocol:
        case (Ramp(separation=None, approach=None) as up, Hold(hold=None | "load") as held) if (
            pressed in ({}, {"load": 0}) and up.mobility == held.mobility == 1
        ):
            asked = {
                "contact": ContactSection(load=up.load, pressure=up.pressure),
                "aging": config.aging.but(last=up.duration + held.duration),
                "protocol": [],
            }
            return config.but(**asked), up.duration
        case (up, *_) if up.target and up.duration and not pressed:
            return config.but(contact=ContactSection(load=0.0)), 0.0
    return config, 0.0
