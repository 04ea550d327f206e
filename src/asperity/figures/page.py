"""A prediction as one page of words and pictures that needs no network."""

from __future__ import annotations

import base64
import datetime
import math
from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import jinja2

from asperity.analysis.bands import rows_of_maps
from asperity.base import checks
from asperity.base.calls import showing
from asperity.base.readable import written
from asperity.base.version import __version__
from asperity.base.words import band_ends
from asperity.figures import prediction as drawn
from asperity.figures import style
from asperity.figures.carried import carried_figure
from asperity.figures.history import history_figure
from asperity.figures.relaxation import relaxation_figure
from asperity.fits import Measurements
from asperity.prediction.results import Prediction
from asperity.surfaces import statistics
from asperity.surfaces.provenance import understood

_GROWTH = (
    "Real contact area against time, with its 95 % band; below, its growth in each decade and on average."
)
_LIGHT = (
    "the area of light contacts grows so. Dashed: Persson's theory for a random surface of the same rms "
    "slope [7], about a quarter below simulations of light contacts [8]: compare how it grows."
)
_CAPTIONS = {
    "history": "Load and real contact area, leg by leg, with the 95 % band of the area.",
    "contacts": "Where the scan touches, and the contact pressure there, at the first and the last time.",
    "pressure": "How the contact pressure is distributed; dotted: means. The highest 2 % is beyond the axis.",
    "carried": "Stiffness and resistance of the constrictions, from the contacts at each time.",
    "relaxation": "The relaxation table, the fitted sum of exponentials, the deviations, and the branches.",
    "observed": "The contact at the last time, its image in the instrument, and what counts as contact.",
}


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure, and what it shows."""

    caption: str
    figure: style.Drawing
    data: str
    """The pixels as text."""

    @property
    def width(self) -> str:
        """Its width on a page whose letters are larger than those of a journal."""
        return f"{1.4 * self.figure.get_figwidth():.2f}in"


def prediction_pictures(
    prediction: Prediction, *, measured: Measurements | Path | str | None = None
) -> dict[str, Picture]:
    """Draw a prediction.

    Parameters
    ----------
    prediction
        From `asperity.predict`.
    measured
        A measured area against time, a table with units, to be drawn too.

    Returns
    -------
    dict
        Pictures by the names of their files, without suffix, in the order of the page.

    Raises
    ------
    InputError
        What was measured is no area.
    """
    checks.instance("prediction", prediction, Prediction, "asperity.predict(...)")
    dataset, fit = prediction.dataset, prediction.fit
    draws: dict[str, Callable[[], style.Drawing]] = {}
    if prediction.growth is None:
        draws["history"] = partial(history_figure, dataset, measured)
    else:
        draws["growth"] = partial(drawn.growth_figure, prediction, measured)
    draws["contacts"] = partial(drawn.contact_maps_figure, prediction)
    draws["pressure"] = lambda: style.figure_of([style.panels_of(prediction)["pressure"]])[0]
    if "normal_stiffness" in dataset:
        draws["carried"] = partial(carried_figure, dataset)
    if fit is not None:
        draws["relaxation"] = partial(relaxation_figure, fit)
    if prediction.observed:
        draws["observed"] = partial(drawn.observed_figure, prediction)
    captions = _CAPTIONS | {"growth": _of_growth(prediction)}
    first = next(iter(draws))
    captions[first] += " Diamonds: measured, and below them measured over computed." * (measured is not None)
    return pictures_of({name: (captions[name], draw) for name, draw in draws.items()})


def pictures_of(draws: Mapping[str, tuple[str, Callable[[], style.Drawing]]]) -> dict[str, Picture]:
    """Draw figures with captions, by name; one that fails is left out with a remark."""
    pictures = {}
    for name, (caption, draw) in draws.items():
        with showing(f"the figure {name!r}"):
            pictures[name] = Picture(caption, figure := draw(), pixels(figure))
    return pictures


def _of_growth(prediction: Prediction) -> str:
    """The caption of the growth: its curves, from the top down."""
    name, symbol = prediction.beside
    theory = ""
    if prediction.effective_load is not None:
        theory = f" Dotted: the first area times the {name} {symbol}(t)/{symbol}(first); {_LIGHT}"
    elif prediction.theory is not None:
        theory = " Dashed: contacts that flow and bear all of the load, d ln A/d ln t = s0/s."
    friction = "" if prediction.friction is None else " Bottom: the coefficient of static friction."
    return f"{_GROWTH}{theory}{friction}"


def prediction_page(prediction: Prediction, pictures: Mapping[str, Picture], *, command: str = "") -> str:
    """Write a prediction as a page of HTML.

    Parameters
    ----------
    prediction
        From `asperity.predict`.
    pictures
        From `prediction_pictures`.
    command
        The command line that made it; may be empty.
    """
    checks.instance("prediction", prediction, Prediction, "asperity.predict(...)")
    dataset, scan, relaxing = prediction.dataset, prediction.origin, prediction.relaxing
    heights, rows = dataset["heights"].values, _rows(prediction)
    return written_page(
        "prediction.html",
        p=prediction,
        command=command,
        scan=defaultdict(str, scan | {"file": scan.get("file") or "the surface"}),
        understood=understood(scan),
        measures=statistics(heights, prediction.spacing),
        sides=[n * side for n, side in zip(heights.shape, prediction.spacing, strict=True)],
        residual_power=-math.ceil(math.log10(max(float(dataset["residual"].max()), 1e-16))),
        late_modulus=None if relaxing is None else float(relaxing.modulus_at(rows[-1]["time"])),
        rows=rows,
        pictures=list(pictures.values()),
    )


def written_page(name: str, **values: Any) -> str:
    """Fill in a template, which knows the version and the date, too."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("asperity.figures", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["measured"] = quantity
    environment.globals["band_ends"] = band_ends
    date = datetime.datetime.now(datetime.UTC).date().isoformat()
    return environment.get_template(name).render(version=__version__, date=date, **values)


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Write an SI quantity with a prefix as it is printed: 5 MPa, 1610 nm², 10⁶ s."""
    return style.spaced(written(value, unit, digits))


def _rows(prediction: Prediction) -> list[dict[str, Any]]:
    """Numbers at the times of the maps, by their names in the dataset; SI units."""
    names = ("time", "contact_area", "mean_contact_pressure", "largest_pressure", "mean_gap")
    area, effective = prediction.series("contact_area_corrected"), prediction.effective_load
    low, high = prediction.band("contact_area_corrected")
    series = {name: prediction.series(name) for name in names} | {
        "contact_area_corrected": area,
        "fraction": area / prediction.nominal_area,
        "grown": area / area[0],
        "effective": None if effective is None else effective / effective[0],
        "friction": prediction.friction,
        "friction_force": prediction.friction_force,
    }
    places = [row - 1 for row in rows_of_maps(prediction.dataset)]
    return [
        {name: None if values is None else float(values[place]) for name, values in series.items()}
        | {"band": (float(low[place]), float(high[place])), "resolved": resolved}
        for place, resolved in zip(places, prediction.resolved, strict=True)
    ]


def pixels(figure: style.Drawing, **options: Any) -> str:
    """Draw a figure as PNG for a page, with options of its ``savefig``."""
    stream = BytesIO()
    figure.savefig(stream, format="png", **options)
    return f"data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}"
