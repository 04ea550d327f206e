"""What an inference says, as rows of words, and its files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from asperity.app.cli.report import Row, aligned
from asperity.base.files import Format
from asperity.base.words import counted, tables_to_toml
from asperity.figures import inference_page, inference_pictures, write
from asperity.inference import Inference


def inference_report(found: Inference, source: str) -> list[Row]:
    """Say what was inferred, and how sure it is."""
    rows: list[Row] = [
        ("data", f"{source}, {counted(found.time.size, 'point')}"),
        ("model", found.model.name),
    ]
    cells = [
        [str(row[0]), *(f"{value:.3g}" for value in row[1:])] for row in found.models.itertuples(index=False)
    ]
    table = aligned([[*found.models.columns], *cells]).splitlines()
    rows += [("models" * (n == 0), line) for n, line in enumerate(table)]
    sentences = {f"{word[:1].upper()}{word[1:]}: {of}" for word, of in found.findings}
    rows += [("", sentence) for sentence in found.sentences if sentence not in sentences]
    rows += found.findings
    rows.append(
        ("agreement", f"R-hat {found.draws.r_hat:.4f}, {found.draws.effective:.0f} effective samples")
    )
    return [*rows, *(("remark", remark) for remark in found.remarks)]


def write_inference(
    found: Inference, folder: Path, formats: Sequence[Format] = ("png",), *, source: str, command: str
) -> None:
    """Write the page, its pictures, tables, draws, and the solid that follows."""
    pictures = inference_pictures(found)
    page = inference_page(found, pictures, source=source, command=command)
    (folder / "inference.html").write_text(page, encoding="utf-8")
    for name, picture in pictures.items():
        write(picture.figure, folder / name, formats)
    found.table.to_csv(folder / "verdicts.csv", index=False, lineterminator="\n")
    priors = tables_to_toml({name: prior.table for name, prior in found.model.priors.items()})
    (folder / "priors.toml").write_text(priors, encoding="utf-8")
    found.to_datatree().to_netcdf(folder / "posterior.nc", engine="h5netcdf")
    if found.model.solid is not None:
        head = f"# The most likely of the draws, inferred from {source} by the model {found.model.name}.\n"
        if found.unknown:
            head += f"# Not identified, so left out: {', '.join(found.unknown)}.\n"
        text = head + tables_to_toml({"solid": found.solid()})
        (folder / "solid.toml").write_text(text, encoding="utf-8")
