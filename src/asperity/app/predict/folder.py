"""The files of a prediction: page, pictures, tables, and the fitted solid."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from pathlib import Path

import pandas as pd

from asperity.ask.run import Output
from asperity.base.calls import remark, remarks_made, showing
from asperity.base.words import tables_to_toml
from asperity.figures.page import prediction_page, prediction_pictures
from asperity.figures.writing import write_each
from asperity.prediction.results import Prediction
from asperity.relaxation import Fit


def write_files(prediction: Prediction, folder: Path, *, output: Output, command: str) -> None:
    """Write all but history and summary to a folder, with the command on the page."""
    columns = prediction.table
    columns.columns = [f"{name} [{unit}]" for name, unit in columns.attrs["units"].items()]
    table = columns.to_csv(index=False, lineterminator="\n", na_rep="nan")
    (folder / "history.csv").write_text(table, encoding="utf-8")
    if prediction.bands:
        units = {"shortest": "m", "area": "m^2", "pressure": "Pa", "growth": "1", "stiffness": "N/m"}
        rows = [
            {f"{name} [{unit}]": getattr(band, name) for name, unit in units.items()}
            for band in prediction.bands
        ]
        pd.DataFrame(rows).to_csv(folder / "resolution.csv", index=False, lineterminator="\n")
    if prediction.fit is not None:
        (folder / "solid.toml").write_text(_solid(prediction, prediction.fit), encoding="utf-8")
    with remarks_made() as remarks:
        pictures = prediction_pictures(prediction, measured=output.measured)
    for text in remarks:  # they are for the summary, too
        remark(text)
    draws = {name: partial(getattr, one, "figure") for name, one in pictures.items()}
    write_each(draws, folder, output.figures)
    with showing("the page"):
        prediction = replace(prediction, remarks=(*prediction.remarks, *remarks))
        page = prediction_page(prediction, pictures, command=command)
        (folder / "prediction.html").write_text(page, encoding="utf-8")


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
