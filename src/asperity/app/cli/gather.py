"""The command ``asperity gather``: one Dataset of a campaign, a table and a figure."""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

from asperity.app.cli.command import command
from asperity.app.cli.flags import Switch
from asperity.app.cli.options import DRAWN, Drawn
from asperity.app.cli.status import check_campaign
from asperity.errors import InputError

_BARE = ("sites", "seconds")
"""Columns whose names are their units."""


@command()
def gather(out: Path, /, *, to: Path | None = None, overwrite: Switch = False, drawn: Drawn = DRAWN) -> None:
    """Gather a campaign into one Dataset with ensemble means, a table of its runs, and a figure.

    Parameters
    ----------
    out
        Folder of the campaign.
    to
        File to write (.zarr, or .nc for netCDF); table and figure are written beside it.
        [default: gathered.zarr in the folder]
    overwrite
        Replace these files if they exist.
    """
    check_campaign("gather", out)
    import asperity.app.campaign as campaign
    from asperity.app.campaign.gather import with_ends
    from asperity.app.cli.output import write_figures
    from asperity.app.runs.outcome import heads_of
    from asperity.base.files import standing
    from asperity.base.rows import aligned
    from asperity.figures import campaign_figure
    from asperity.results import save
    from asperity.results.store import whole_file

    dataset = campaign.open(out)
    target = out / "gathered.zarr" if to is None else to
    if target.suffix not in (".zarr", ".nc"):
        raise InputError("--to", expected="a name that ends in .zarr, or in .nc for netCDF", got=target)
    # Gathering again, with more runs, is what one does: the default place is always replaced.
    replace = overwrite or to is None
    csv = target.with_suffix(".csv")
    formats = drawn.formats(tomllib.loads(dataset.attrs["config"])["output"]["figures"])
    pictures = [target.with_suffix(f".{one}") for one in formats]
    pictures += [target.with_name(f"{target.stem}_data.csv")] * bool(formats)
    before = {file: standing(file) for file in (csv, *pictures, *[target] * (target.suffix == ".nc"))}
    for file in before:
        if file.exists() and not replace:
            raise InputError("--to", expected="a new name", got=f"{file} exists", advice="--overwrite")
    if target.suffix == ".nc":
        with whole_file(target, overwrite=before[target]) as part:
            dataset.to_netcdf(part)
    else:
        save(dataset, target, overwrite=replace)
    runs, ends = campaign.table(dataset), with_ends(dataset)
    named = {name: ends[name] for name in map(str, runs) if name not in _BARE}
    runs = runs.rename(columns=heads_of(named))
    with whole_file(csv, overwrite=before[csv]) as part:
        runs.to_csv(part, index=False)
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    opener = "asp.results.load" if target.suffix == ".zarr" else "xarray.open_dataset"
    rows = [
        ("finished", f"{dataset.attrs['finished']} of {dataset.attrs['runs']} runs"),
        ("dimensions", sizes),
        ("written", f"{target}: all series and their ensemble; {opener} opens it"),
        ("", f"{csv}: {'one row a run' if 'initial_area' in dataset else 'all answers'}, {len(runs)} rows"),
    ]
    if formats and float(dataset[dataset.attrs["over"].split()[-1]].max()) > 0:
        lines = write_figures(lambda: campaign_figure(dataset), {file: before[file] for file in pictures})
        rows += [("", line) for line in lines]
    sys.stdout.write(f"{aligned(rows)}\n")
