"""Checkpoint of a long computation: a killed one resumes and ends at the identical result."""

from __future__ import annotations

import hashlib
import json
import math
import time as clock
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.aging.constant_area import ConstantArea
from asperity.aging.controller import Controller
from asperity.aging.frames import Counts, Midway
from asperity.aging.legs import LegMidway
from asperity.aging.tr_bdf2 import Origin
from asperity.base.files import expanded
from asperity.base.version import __version__
from asperity.base.words import reason_of
from asperity.carried import Carried
from asperity.contact import Contact, Load, Separation
from asperity.contact.problem import ContactSolver
from asperity.errors import CheckpointError
from asperity.lattice import Field, Lattice
from asperity.progress import Checkpoint
from asperity.protocols.schedule import Schedule
from asperity.results.dataset import Moment, Snapshot
from asperity.results.store import whole_file
from asperity.solids import Solid


class Keeper:
    """Writes and reads the checkpoint of one computation: facts as JSON and arrays, each with a checksum.

    Parameters
    ----------
    checkpoint
        The file, or None to keep nothing.
    asked
        Bytes that differ from those of any other computation.
    """

    def __init__(self, checkpoint: str | Path | Checkpoint | None, asked: bytes) -> None:
        settings = Checkpoint(checkpoint) if isinstance(checkpoint, str | Path) else checkpoint
        self.path = None if settings is None else expanded(settings.path)
        self.every = math.inf if settings is None else settings.every
        self.mark = hashlib.sha256(__version__.encode() + asked).hexdigest()
        self.written = clock.monotonic()

    def is_due(self) -> bool:
        """Whether it is time to write again."""
        return clock.monotonic() - self.written >= self.every

    def write(self, facts: object, arrays: Mapping[str, NDArray[Any]] | None = None) -> None:
        """Write atomically: a kill at any moment leaves the old or the new checkpoint.

        `OutputError` if the disk refused; an earlier checkpoint is untouched.
        """
        if self.path is None:
            return
        with whole_file(self.path) as part, part.open("wb") as file:
            np.savez(file, mark=self.mark, facts=json.dumps(facts, default=vars).encode(), **arrays or {})  # type: ignore[arg-type]
        self.written = clock.monotonic()

    def read(self) -> tuple[Any, dict[str, Any]] | None:
        """Facts and arrays of the checkpoint, if there is one.

        `CheckpointError` if the file is no checkpoint, or that of another computation.
        """
        if self.path is None or not self.path.exists():
            return None
        expected, advice = "a checkpoint of this computation", "another path, or remove the file"
        try:
            # The archive is opened first, because for other content np.load knows older formats.
            with self.path.open("rb") as file, zipfile.ZipFile(file):
                file.seek(0)
                archive = np.load(file, allow_pickle=False)
                arrays = {name: archive[name] for name in archive.files}
            if str(arrays.pop("mark")) != self.mark:
                raise ValueError("of another computation")
            return json.loads(arrays.pop("facts").item()), arrays
        except Exception as error:  # of an archive, of headers, of JSON: a damaged byte leads anywhere
            got = f"{self.path}: {reason_of(error)}"
            raise CheckpointError("checkpoint", expected=expected, got=got, advice=advice) from error


@dataclass(frozen=True, eq=False)
class Place:
    """What the checkpoint of a run keeps: the march, and the records so far."""

    midway: LegMidway
    rows: list[Moment]
    snapshots: list[Snapshot]

    def packed(self) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
        """Facts and arrays for `Keeper.write`."""
        march, midway = self.midway, self.midway.midway
        facts = {
            "control": march.control.name,
            "here": vars(march) | {"midway": vars(midway) | {"resume_state": None}},
            "rows": self.rows,
            "snapshots": [vars(snapshot) | {"fields": None} for snapshot in self.snapshots],
        }
        arrays = {f"place_{name}": array for name, array in midway.resume_state.items()}
        for name in self.snapshots[0].fields if self.snapshots else ():
            arrays[f"kept_{name}"] = np.stack([snapshot.fields[name] for snapshot in self.snapshots])
        return facts, arrays

    @classmethod
    def unpacked(cls, facts: dict[str, Any], arrays: Mapping[str, NDArray[Any]]) -> Place:
        """The place that `packed` made facts and arrays of."""
        kept, place = (
            {name.removeprefix(kind): array for name, array in arrays.items() if name.startswith(kind)}
            for kind in ("kept_", "place_")
        )
        snapshots = [
            Snapshot(**snapshot | {"fields": {name: fields[index] for name, fields in kept.items()}})
            for index, snapshot in enumerate(facts["snapshots"])
        ]
        march = facts["here"]
        area = march["midway"]["area"]
        midway = march["midway"] | {"resume_state": place, "area": area and ConstantArea(**area)}
        parts: dict[str, Any] = {"controller": Controller, "origin": Origin, "counts": Counts}
        midway |= {name: part(**midway[name]) for name, part in parts.items()}
        kind = Load if facts["control"] == Load.name else Separation
        restored = {"control": kind(**march["control"]), "midway": Midway(**midway)}
        return cls(LegMidway(**march | restored), facts["rows"], snapshots)


def fingerprint_of(
    start: Contact,
    schedule: Schedule,
    times: Field,
    fields_at: Field,
    rtol: float,
    solver: ContactSolver,
    exact: bool,
    carried: Carried | None = None,
) -> bytes:
    """Hash of all inputs of a history."""
    facts = start.control, schedule, rtol, solver, exact, carried, start.permanent_indentation.sum()
    solid = fingerprint_of_solid(start.solid, start.lattice)
    return solid + _hash(facts, start.heights, start.u, start.anchors, times, fields_at)


def fingerprint_of_solid(solid: Solid, lattice: Lattice) -> bytes:
    """Hash of a lattice and of all that a solid is on it: numbers, spectra and laws."""
    spectra = () if solid.springs else vars(solid.on(lattice.embedding)).values()
    laws = [law.fingerprint() for law in (solid.creep, solid.adhesion) if law is not None]
    return _hash((lattice, solid.springs, solid.hardness, *laws), *spectra)


def _hash(facts: tuple[object, ...], *arrays: NDArray[Any]) -> bytes:
    digest = hashlib.sha256(repr(facts).encode())
    for array in arrays:
        digest.update(f"{array.shape} {array.dtype}".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.digest()
