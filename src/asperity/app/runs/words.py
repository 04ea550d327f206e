"""What programs say of a history."""

from __future__ import annotations

import xarray as xr

from asperity.analysis.scan import written
from asperity.results.quantities import select


def carried_words(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """What the contact carries at first and at last: a name and words for each."""
    rows = []
    for name, one in select("series", of=["carried"]).items():
        if name in dataset:
            ends = [written(float(dataset[name][n]), str(dataset[name].attrs["units"]), 4) for n in (0, -1)]
            rows.append((one.label, " at first, ".join(ends) + " at last"))
    return rows
