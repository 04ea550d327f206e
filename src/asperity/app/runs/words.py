"""What programs say of a history: what the contact carries, and what limits it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import xarray as xr

from asperity.analysis.prediction import Resolved, resolved
from asperity.analysis.scan import written
from asperity.base.words import counted
from asperity.results.quantities import select
from asperity.solids import Solid
from asperity.surfaces import Surface

_UNEVEN = 1.5
"""Ratio of steps across rows to steps along them, above which a remark is made."""


def carried_words(dataset: xr.Dataset) -> list[tuple[str, str]]:
    """What the contact carries at first and at last: a name and words for each."""
    rows = []
    for name, one in select("series", of=["carried"]).items():
        if name in dataset:
            ends = [written(float(dataset[name][n]), str(dataset[name].attrs["units"]), 4) for n in (0, -1)]
            rows.append((one.label, " at first, ".join(ends) + " at last"))
    return rows


def remarks_on_contact(dataset: xr.Dataset, scan: Surface, solid: Solid) -> Iterator[str]:
    """What limits a contact of a continuum under a surface with units, in numbers."""
    between_rows, along_rows = scan.describe().neighbor_steps
    if between_rows > _UNEVEN * along_rows:
        yield (
            f"heights change {between_rows / along_rows:.2g} times as much from row to row as along a row: "
            "if that is noise of the scan's lines, their ridges carry load that asperities would carry"
        )
    load, fraction = (np.asarray(dataset[name]) for name in ("load", "contact_fraction"))
    pressed = int(np.argmax(load >= (1 - 1e-9) * load.max()))
    pressure = float(dataset["mean_contact_pressure"][pressed])
    strain = pressure / float(dataset.attrs["modulus"])
    if maps := resolved(dataset) if "in_contact" in dataset else ():
        stays = load[-1] >= (1 - 1e-9) * load.max()  # else patches are lost
        yield from _on_patches(maps[0], maps[-1], may_merge=stays and fraction[-1] <= 0.5)
    if strain > 0.05 and not solid.yields:
        share = f"{100 * strain:.2g} % of E*" if strain < 1 else f"{strain:.3g} times E*"
        when = "at the largest load" if pressed else "at first"
        yield (
            f"the mean contact pressure is {written(pressure, 'Pa')} {when}, {share}: "
            "real asperities would flow, and nothing flows at once here; try a hardness"
        )
    if (most := float(fraction.max())) > 0.5:
        yield (
            f"{100 * most:.0f} % of the surface touches {'at last' if fraction[-1] == most else 'at most'}: "
            "waves longer than the scan, which it does not have, would keep bodies further apart"
        )


def _on_patches(first: Resolved, last: Resolved, *, may_merge: bool) -> Iterator[str]:
    """What the pixels resolve of the first map, and what becomes of its patches."""
    if first.in_small > 0.2:
        yield (
            f"{100 * first.in_small:.0f} % of the area at first lies in patches of fewer than 10 pixels: "
            "the scan does not resolve them, and a finer one would change the area"
        )
    if first.rim > 0.2:
        part = f"{100 * first.rim:.0f} % of the counted area at first"
        yield f"the rim takes {part}: patches are few pixels wide"
    if first.patches < 30:
        many = counted(first.patches, "patch", "patches")
        yield f"{many} at first: too few for the statistics of a surface"
    if may_merge and last.patches < first.patches / 2:
        yield f"patches merge: {first.patches} at first, {last.patches} at last"
