"""From the file of a run to a prediction, and the files of a prediction: page, pictures, tables, solid."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from asperity.app.config import RunConfig
from asperity.app.runs.outcome import Outcome
from asperity.app.runs.pipeline import check_units, completed, without_copies
from asperity.ask.prediction import begins_to_rise, loading_of
from asperity.ask.run import Contact
from asperity.base.calls import remark, remarks_made, showing
from asperity.base.rows import Row
from asperity.base.words import tables_to_toml
from asperity.prediction import predict
from asperity.prediction.predicting import no_half_space
from asperity.prediction.results import Prediction
from asperity.progress import Checkpoint, Progress
from asperity.relaxation import Fit

if TYPE_CHECKING:
    from asperity.figures import Drawing
    from asperity.figures.page import Picture


@dataclass(frozen=True, eq=False)
class Predicted(Outcome):
    """A prediction."""

    prediction: Prediction

    def rows(self) -> list[Row]:
        """See `Outcome`."""
        return self.prediction.rows()

    def tables(self) -> dict[str, pd.DataFrame]:
        """The history, and if it was asked for the study of the resolution."""
        columns = self.prediction.table
        columns.columns = [f"{name} [{unit}]" for name, unit in columns.attrs["units"].items()]
        units = {"shortest": "m", "area": "m^2", "pressure": "Pa", "growth": "1", "stiffness": "N/m"}
        rows = [
            {f"{name} [{unit}]": getattr(band, name) for name, unit in units.items()}
            for band in self.prediction.bands
        ]
        return {"history": columns} | ({"resolution": pd.DataFrame(rows)} if rows else {})

    @cached_property
    def pictures(self) -> dict[str, Picture]:
        """Figures with captions."""
        from asperity.figures.page import prediction_pictures

        return prediction_pictures(self.prediction, measured=self.config.output.measured)

    def drawings(self) -> dict[str, Callable[[], Drawing]]:
        """See `Outcome`."""
        return {name: partial(getattr, one, "figure") for name, one in self.pictures.items()}

    def write(self, folder: Path, *, command: str = "", **_: Any) -> None:
        """Write also the fitted solid, and a page with the command."""
        from asperity.figures.page import prediction_page

        prediction = self.prediction
        if prediction.fit is not None:
            (folder / "solid.toml").write_text(_solid(prediction, prediction.fit), encoding="utf-8")
        with remarks_made() as remarks:
            pictures = self.pictures
        for text in remarks:  # they are for the summary, too
            remark(text)
        super().write(folder)
        with showing("the page"):
            prediction = replace(prediction, remarks=(*prediction.remarks, *remarks))
            page = prediction_page(prediction, pictures, command=command)
            (folder / "prediction.html").write_text(page, encoding="utf-8")


def foretell(config: RunConfig, progress: Progress, *, checkpoint: Checkpoint | None = None) -> Predicted:
    """Ask `asperity.predict` for the solid, surface, load and times of a run.

    The load is applied instantly, or within a ramp; or it follows a protocol, before which it is 0 unless the
    file says more. `AsperityError` as there; or what is asked for has no band.
    """
    read, own = getattr(config.protocol, "read", ""), vars(config.own)
    if begins_to_rise(config.protocol) and not config.contact.table:
        config = config.but(contact=Contact(load=0.0))
    loading = loading_of(config.protocol, *config.contact.table.values())
    times = _times(config, (loading[0].duration if loading else own["ramp"]) or 0.0)
    material = config.solid.material
    if not material.solid.half_space:
        raise no_half_space("kind", config.solid.kind).about("kind", "solid", "kind")
    surface = without_copies(config)
    progress.stage("reading the scan")
    scan = surface.build()
    scan.in_meters()
    check_units(config, material.solid, scan)
    config, remarks = completed(config.but(surface=surface), material.solid, scan)
    progress.completed(config)
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
    said = (*filter(None, dict.fromkeys((read, *remarks, *prediction.remarks))),)
    return Predicted(config, prediction.dataset, said, replace(prediction, remarks=said))


def _times(config: RunConfig, ramp: float) -> dict[str, Any]:
    """Arguments of a prediction about the times to record."""
    aging, (first, last) = config.aging, config.span
    if aging.times is not None:
        return {"times": aging.times}
    times = {"first": aging.first or max(first, ramp), "per_decade": aging.per_decade}
    return times if config.protocol else times | {"last": last}


def _solid(prediction: Prediction, fit: Fit) -> str:
    assumed = prediction.assumed
    solid: dict[str, object] = {"kind": "half_space", "modulus": prediction.modulus}
    if assumed["measured"] == "young":
        solid = {"kind": "half_space", "young": fit.series.modulus, "poisson": assumed["poisson"]}
    solid["branches"] = list(prediction.branches)
    if prediction.solid.yields:
        solid["hardness"] = prediction.solid.hardness
    table, (first, last) = assumed["table"] or "A table", fit.data.span
    if math.isfinite(fit.series.span[1]):  # a plateau has no end
        solid |= {"data_first": first, "data_last": last}
    head = f"# {table} as a sum of exponentials, known from {first:.4g} s to {last:.4g} s."
    if fit.assumed:
        head += f"\n# {fit.assumed.capitalize()}."
    return f"{head}\n{tables_to_toml({'solid': solid})}"
