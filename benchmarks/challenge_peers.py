"""What other codes answer to the reference problems, and how they score.

    python benchmarks/challenge_peers.py [--peers-python PYTHON ...] [--scan FILE] [--store FILE]

Tamaas and ContactMechanics press their half-spaces, and on the lattice of springs their half-spaces with
another kernel: the contact at time 0. Tamaas marches the viscoelastic half-spaces by implicit Euler steps of
one length: `STEPS` and twice as many from 0 to each time, extrapolated to no step (the error is of first
order). Areas are the sites under pressure; where the answer is that of a continuum, once as counted and once
less the rim, by Yastrebov's formula as in `asperity.contact.rim`. Prints the table of docs/challenge.md.
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import running
from peers.problem import Law, Problem
from running import answered, head, line
from solvers import SolverError, Worker

import asperity as asp
from asperity.contact.rim import RIM, rim_sides

PRESSES = ("tamaas", "contactmechanics")
TOLERANCE, LIMIT = 1e-10, 900.0
STEPS = 16
AT_ONCE = ("dilute", "dense")
"""Problems on the lattice of springs of which a contact code knows the first row."""


@dataclass(frozen=True)
class State:
    """What is asked of a contact."""

    sites: int
    less_rim: float
    cell: float
    gap: float


def state_of(problem: Problem, force, gap: float | None = None) -> State:
    """The contact of forces, and the gap; by default what an elastic half-space makes of them."""
    force = np.asarray(force).reshape(problem.heights.shape)
    touching = force > 0
    lattice = asp.lattice.Lattice(force.shape, tuple(problem.spacing or (1.0, 1.0)))
    sites = int(np.count_nonzero(touching))
    if gap is None:
        u = np.fft.irfft2(problem.compliance() * np.fft.rfft2(np.where(touching, force, 0.0)), s=force.shape)
        gaps = u - problem.heights
        gap = float(gaps.mean() - gaps[touching].mean())
    return State(sites, sites - RIM * rim_sides(touching, lattice), problem.cell, gap)


def row(state: State, asked: asp.challenge.Problem, *, less_rim: bool) -> dict[str, float]:
    """One row of an answer."""
    found: dict[str, float] = {}
    for column in asked.asked:
        if column.name == "area":
            found[column.heading] = state.sites
        elif column.name == "contact_area":
            found[column.heading] = state.cell * (state.less_rim if less_rim else state.sites)
        elif column.name == "mean_gap":
            found[column.heading] = state.gap
    return found


def presses(worker: Worker, asked: asp.challenge.Problem, base: dict, folder: Path) -> list[tuple]:
    """Pairs of place and state that a press of elastic solids can know."""
    config, surface = asked.config, asked.surface(**base)
    if asked.name in AT_ONCE:
        law = Law("lattice", k0=config.solid.k0, k1=config.solid.k1)
        return [(0.0, solve(worker, Problem(surface.heights, law, config.contact.load), folder))]
    heights, spacing = surface.in_meters()
    law = Law("half-space", modulus=config.solid.modulus)
    loads = asked.answer.abscissa if asked.abscissa.name == "load" else [load_of(asked, surface)]
    places = loads if asked.abscissa.name == "load" else [0.0]
    return [
        (place, solve(worker, Problem(heights, law, float(load), spacing=tuple(spacing)), folder))
        for place, load in zip(places, loads, strict=True)
    ]


def load_of(asked: asp.challenge.Problem, surface: asp.surfaces.Surface) -> float:
    """Load of a half-space, N."""
    pressed, spacing = asked.config.contact, surface.in_meters()[1]
    return pressed.load or pressed.pressure * surface.heights.size * float(np.prod(spacing))


def solve(worker: Worker, problem: Problem, folder: Path) -> State:
    _, fields = answered(worker, problem, folder, LIMIT, tolerance=TOLERANCE)
    return state_of(problem, fields["force"])


def march(worker: Worker, asked: asp.challenge.Problem, base: dict, folder: Path, chosen=()) -> list[tuple]:
    """The same of a march, at every time above 0 or at those chosen, extrapolated to no step."""
    config, surface = asked.config, asked.surface(**base)
    heights, spacing = surface.in_meters()
    branches = tuple(config.solid.build().parameters["branches"])
    law = Law("half-space", modulus=config.solid.modulus, branches=branches)
    problem = Problem(heights, law, load_of(asked, surface), spacing=tuple(spacing))
    states = []
    for moment in (t for t in asked.run["aging"]["times"] if t > 0 and t in (chosen or [t])):
        two = []
        for steps in (STEPS, 2 * STEPS):
            how = {"do": "age", "times": [moment]}
            how["options"] = {"step": moment / steps, "tolerance": TOLERANCE}
            reply, fields = answered(worker, problem, folder, LIMIT, **how)
            two.append(state_of(problem, fields["force"][0], reply["mean_gap"][0]))
        mixed = [2 * b - a for a, b in zip(*(vars(one).values() for one in two), strict=True)]
        states.append((moment, State(*mixed)))
    return states


def scored(asked, rows: list[tuple], *, less_rim: bool) -> list[tuple[str, ...]]:
    """Cells of the table for each quantity."""
    columns: dict[str, list[float]] = {asked.abscissa.heading: [place for place, _ in rows]}
    for _, state in rows:
        for heading, value in row(state, asked, less_rim=less_rim).items():
            columns.setdefault(heading, []).append(value)
    found = asp.challenge.score(columns, asked.name)
    cells = []
    for one in found.quantities:
        worst = int(np.argmax(np.abs(one.in_bars)))
        off = f"{one.in_bars[worst]:+.2g}", f"{100 * np.abs(one.relative).max():.2g} %"
        cells.append((one.column.heading, f"{found.places} of {found.asked}", one.verdict, *off))
    return cells


def main() -> int:
    parser = running.parser(__doc__)
    parser.add_argument("--peers-python", nargs="+", default=[], metavar="PYTHON")
    parser.add_argument("--scan", type=Path)
    parser.add_argument("--only", nargs="+", default=list(asp.challenge.NAMES))
    parser.add_argument("--times", nargs="+", type=float, default=[], help="times to march to [all]")
    parser.add_argument("--no-press", action="store_true", help="leave the elastic contacts out")
    parser.add_argument("--no-march", action="store_true", help="leave the marches out")
    parser.add_argument("--store", type=Path, help="write the table to this file")
    options = parser.parse_args()
    lines = head("problem", "code", "quantity", "places", "verdict", "worst, in bars", "worst")
    print(*lines, sep="\n", flush=True)

    def add(asked, code, rows):
        for less_rim in (False, True) if asked.continuous else (False,):
            for cells in scored(asked, rows, less_rim=less_rim):
                if less_rim and not cells[0].startswith("contact_area"):
                    continue
                lines.append(line(asked.name, f"{code}, less the rim" if less_rim else code, *cells))
                print(lines[-1], flush=True)

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for peer, solver in (*((peer, presses) for peer in PRESSES), ("tamaas-maxwell", march)):
            if options.no_march if solver is march else options.no_press:
                continue
            worker = running.peers([peer], options.peers_python).get(peer)
            for asked in map(asp.challenge.problem, options.only if worker else ()):
                continuum = asked.config.solid.kind == "half_space"
                known = continuum or (solver is presses and asked.name in AT_ONCE)
                relaxes = bool(asked.config.solid.build().branches)
                base = {"scan": options.scan} if asked.heights["rule"] == "scan" else {}
                if not known or (solver is march and not relaxes) or (base and options.scan is None):
                    continue
                try:
                    extra = (options.times,) if solver is march else ()
                    rows = solver(worker, asked, base, folder, *extra)
                except SolverError as error:
                    print(f"{asked.name}: {peer} gave no answer: {error}", file=sys.stderr)
                    continue
                add(asked, worker.version + (", march" if solver is march else ""), rows)
            if worker:
                worker.close()
    if options.store:
        options.store.write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
