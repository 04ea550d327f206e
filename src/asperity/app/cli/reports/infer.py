"""The files of an inference."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from asperity.base.calls import showing
from asperity.base.files import Format
from asperity.base.words import tables_to_toml
from asperity.figures.writing import write_each
from asperity.inference import Inference, inference_page, inference_pictures


def write_inference(
    inference: Inference, folder: Path, formats: Sequence[Format] = ("png",), *, source: str, command: str
) -> None:
    """Write tables, posterior samples if there are any, the best solid, the pictures and their page."""
    inference.table.to_csv(folder / "verdicts.csv", index=False, lineterminator="\n")
    priors = tables_to_toml({name: prior.table for name, prior in inference.model.priors.items()})
    (folder / "priors.toml").write_text(priors, encoding="utf-8")
    if inference.sampled:
        inference.to_datatree().to_netcdf(folder / "posterior.nc", engine="h5netcdf")
    if inference.model.solid is not None:
        head = f"# The best fit, inferred from {source} by the model {inference.model.name}.\n"
        if inference.unknown:
            head += f"# Not identified, so left out: {', '.join(inference.unknown)}.\n"
        text = head + tables_to_toml({"solid": inference.solid()})
        (folder / "solid.toml").write_text(text, encoding="utf-8")
    pictures = inference_pictures(inference)
    write_each({name: partial(getattr, one, "figure") for name, one in pictures.items()}, folder, formats)
    with showing("the page"):
        page = inference_page(inference, pictures, source=source, command=command)
        (folder / "inference.html").write_text(page, encoding="utf-8")
