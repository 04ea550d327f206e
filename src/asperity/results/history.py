"""Age a contact and gather its history."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

import asperity.checks as checks
from asperity.aging.march import DEFAULT_RTOL, Frame, Midway, check_rtol, creep
from asperity.contact.choice import chosen_solver
from asperity.contact.controls import Hold
from asperity.contact.problem import ContactSolver
from asperity.contact.state import Contact, hold_contact
from asperity.results.checkpoint import Checkpoint, Keeper, Place, fingerprint_of
from asperity.results.dataset import Row, Snapshot, dataset_of, row_of, snapshot_of
from asperity.results.store import save


@dataclass(frozen=True, eq=False)
class History:
    """How a contact aged.

    Attributes
    ----------
    dataset
        An xarray Dataset over ``time``, whose first entry, 0, is the state before any creep:
        ``area``, ``contact_fraction``, ``load``, ``separation``, ``approach``, ``energy``,
        ``residual``, ``residual_scale``, ``steps``, ``rejected``, ``iterations``; ``heights`` over the
        sites; and over ``field_time``, where fields were asked for, ``u``, ``u0`` and ``in_contact``.
    final
        The contact at the last time reached (of ``times`` and ``fields_at``); age it further, or relax it.
    """

    dataset: xr.Dataset
    final: Contact

    def __repr__(self) -> str:
        times = self.dataset["time"].values
        areas = self.dataset["area"].values
        return f"<History: {times.size} times to {times[-1]:g}, area {areas[0]} to {areas[-1]} sites>"

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the dataset; see `asperity.results.save`."""
        save(self.dataset, path, overwrite=overwrite)


def age(
    contact: Contact,
    times: ArrayLike,
    *,
    hold: Hold | None = None,
    rtol: float = DEFAULT_RTOL,
    fields_at: Sequence[float] = (),
    progress: Callable[[Frame], None] | None = None,
    checkpoint: str | Path | Checkpoint | None = None,
    solver: ContactSolver | None = None,
) -> History:
    r"""Let a contact creep under what it was pressed by, and record it at exactly the given times.

    Parameters
    ----------
    contact
        Where to start: from `press`, or the ``final`` of an earlier history.
    times
        Strictly increasing hold times >= 0, shape ``(n,)``; the unit is 1 / (stiffness * R). They count
        from this call: for the ``final`` of an earlier history from 0 again.
    hold
        What is held constant, ``"load"`` or ``"separation"`` (of the rigid body); by default what
        the contact was pressed by.
    rtol
        Relative tolerance: the error of u0, rms over the sites, stays at every recorded time below
        ``rtol`` times the largest deformation so far (the rms of u about its mean; or that of u - u0,
        if larger, at a held separation with viscous creep); measured, not proved: see
        ``STEP_TOLERANCE`` in ``aging/march.py``.
    fields_at
        Strictly increasing times >= 0 at which to keep u, u0 and in_contact; they need not be among
        ``times``.
    progress
        Called with each `Frame` as it is reached.
    checkpoint
        File in which to keep the run's place, every ten seconds or as `Checkpoint` says. If it exists,
        the run goes on from there, to the result that it would have had undisturbed. The file
        stays: remove it when the results are safe. A solver of your own needs a repr that says all
        it depends on, by which the run is recognized.
    solver
        How to solve the contact problems; by default as `asperity.press` does.

    Returns
    -------
    History

    Raises
    ------
    InputError
        Times, tolerance or ``hold`` cannot be used; or the checkpoint is another run's.
    ConvergenceError
        A contact problem was not solved, or steps shrank to nothing.

    Notes
    -----
    Integrates Jagla's Eq. (dosrs), du0/dt = M C (u - u0), by TR-BDF2, second order and L-stable,
    with adaptive steps; see `asperity.aging.tr_bdf2`.
    """
    start, tolerance = hold_contact(contact, hold), check_rtol(rtol)
    recorded = checks.times("times", times)
    wanted = checks.times("fields_at", fields_at, at_least=0)
    recorded, kept, keep_start = recorded[recorded > 0], wanted[wanted > 0], bool((wanted == 0).any())
    method = chosen_solver(solver, start.system)
    rows: list[Row] = []
    snapshots: list[Snapshot] = []
    keeper, midway = None, None
    if checkpoint is not None:
        settings = checkpoint if isinstance(checkpoint, Checkpoint) else Checkpoint(checkpoint)
        fields = np.append(kept, 0.0) if keep_start else kept
        keeper = Keeper(settings, fingerprint_of(start, recorded, fields, tolerance, method))
        place = keeper.read()
        if place is not None:
            midway, rows, snapshots = place.midway, place.rows, place.snapshots

    def keep_place(here: Midway) -> None:
        if keeper is not None and keeper.is_due():
            keeper.write(Place(here, rows, snapshots))

    final = start
    stops = np.union1d(np.union1d(recorded, kept), [0.0])
    for frame in creep(start, stops, rtol=tolerance, solver=method, midway=midway, after_step=keep_place):
        if progress is not None:
            progress(frame)
        final = frame.contact
        if frame.time in kept or (frame.time == 0 and keep_start):
            snapshots.append(snapshot_of(frame))
        if frame.time in recorded or frame.time == 0:
            rows.append(row_of(frame))
    return History(dataset_of(start, rows, snapshots, rtol=tolerance), final)
