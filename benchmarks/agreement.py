"""Hold Asperity to its peers in SI: contact, pressures and gap of one solid on one scan, and its aging.

    python benchmarks/agreement.py [--only press march patches] [--peers-python PYTHON ...] [--store FILE]

Scans come from the folder that ASPERITY_DATA names, levelled and taken as periodic; there is a surface made
from a seed too. Each is pressed onto a half-space of 3 GPa at three mean pressures by Asperity, and by each
peer at tolerances that tighten until its pressures no longer come closer to those of Asperity. Asperity
is asked twice: as users do, and for as much as double precision gives (`Strict`). Then a half-space of
two Maxwell branches ages, by Asperity and by implicit Euler steps of Tamaas that are halved. Rough patches
are pressed by ASPHER too, periodic and with free edges.

Prints three tables. The exit status is 1 where a difference exceeds its limit (`LIMITS`, `MARCH_LIMITS`), 0
otherwise; a peer or a scan that is absent is said and skipped.
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import running
import solvers
import synthetic
from cases import MEAN_PRESSURE
from check import judge
from numpy.typing import NDArray
from peers.problem import Law, Problem
from running import answered, head, line
from solvers import SolverError, Worker

import asperity as asp
from asperity.contact.problem import Accuracy

Field = NDArray[np.float64]

MODULUS = 3e9
PRESSURES = (1e6, 1e7, 5e7)
PEERS = ("tamaas", "contactmechanics")
TOLERANCES = (1e-10, 1e-12)
LIMIT = 60.0
"""Seconds that a peer gets for one solve or one march; at the tightest tolerance some never end."""
LIMITS = {"sites": 0.0, "pressure": 1e-9, "mean_pressure": 1e-12, "mean_gap": 1e-9, "gap": 1e-9}

BRANCHES = ((0.5, 1.0), (0.3, 10.0))
TIMES = (0.5, 2.0, 8.0)
STEPS = (1 / 8, 1 / 16, 1 / 32)
MARCH_LIMITS = {"order": 0.1, "extrapolated": 1e-3, "sites": 20, "gap_in_contact": 1e-8}
"""How far the order may be from 1; the pressures extrapolated to no step from those of Asperity, rms; and the
number of contacts, at the shortest step."""

PATCHES = [(edges, seed, rms) for edges in ("periodic", "free") for seed in range(3) for rms in (0.217, 4.34)]
"""Edges, seed, and rms height in spacings: 5 to 7 % of contact, or a twentieth."""
PATCH_LIMIT = 1e-9
"""Largest difference in pressure at any site, over the largest; the sets of contacts are to be equal."""


@dataclass(frozen=True)
class State:
    """What is compared, in SI: the pressure and the gap on every site, and the rms height."""

    pressure: Field
    gap: Field
    height: float

    @property
    def fraction(self) -> float:
        return float((self.pressure > 0).mean())


@dataclass(frozen=True)
class Difference:
    """How far two states are apart.

    ``sites`` counts those that one has in contact and the other has not. ``pressure`` is the
    largest difference on any site over the largest pressure; ``gap`` and ``mean_gap`` are over the rms
    height.
    """

    sites: int
    pressure: float
    mean_pressure: float
    mean_gap: float
    gap: float

    def beyond(self, limits: dict[str, float]) -> list[str]:
        """Name what exceeds its limit; what is not a number does."""
        return [name for name, limit in limits.items() if not getattr(self, name) <= limit]


def compare(ours: State, theirs: State) -> Difference:
    pressure, gap = np.abs(theirs.pressure - ours.pressure), np.abs(theirs.gap - ours.gap)
    return Difference(
        sites=int(np.count_nonzero((ours.pressure > 0) != (theirs.pressure > 0))),
        pressure=float(pressure.max() / ours.pressure.max()),
        mean_pressure=abs(float(theirs.pressure.mean() / ours.pressure.mean()) - 1),
        mean_gap=abs(float(theirs.gap.mean() - ours.gap.mean())) / ours.height,
        gap=float(gap.max()) / ours.height,
    )


class Strict:
    """The usual solver of a half-space, asked for as much as double precision gives."""

    def solve(self, problem, guess, accuracy):
        return asp.ActiveSet().solve(problem, guess, Accuracy(min(accuracy.residual, 1e-14)))


def press(surface: asp.surfaces.Surface, pressure: float, *, strict: bool = False) -> State:
    """Press with Asperity, through its public interface."""
    solid = asp.solids.half_space(modulus=MODULUS)
    contact = asp.press(surface, solid, pressure=pressure, solver=Strict() if strict else None)
    assert contact.si
    return State(contact.pressure, contact.gap, float(contact.heights.std()))


def problem_of(surface: asp.surfaces.Surface, pressure: float, law: Law | None = None) -> Problem:
    """The same for a peer."""
    heights, spacing = surface.in_meters()
    load = pressure * heights.size * math.prod(spacing)
    return Problem(heights, law or Law("half-space", modulus=MODULUS), load, spacing=tuple(spacing))


def press_by_peer(worker: Worker, problem: Problem, tolerance: float, folder: Path) -> tuple[State, float]:
    """Press with a peer; and the residual of its surface, see `check.judge`."""
    _, answer = answered(worker, problem, folder, LIMIT, tolerance=tolerance)
    gap, touching = answer["u"] - problem.heights, answer["in_contact"]
    pressure = np.where(touching, answer["force"], 0.0) / problem.cell
    state = State(pressure, gap - gap[touching].mean(), float(problem.heights.std()))
    return state, judge(problem, answer["u"], touching).residual


def closest(
    worker: Worker, problem: Problem, ours: State, folder: Path, tolerances: Iterable[float] = TOLERANCES
) -> tuple[float, State, Difference, float]:
    """Tighten a peer until its pressures no longer come closer: tolerance, state, difference, residual."""
    best: tuple[float, State, Difference, float] | None = None
    reason = SolverError("no tolerance to try")
    for tolerance in tolerances:
        try:
            state, residual = press_by_peer(worker, problem, tolerance, folder)
        except SolverError as error:
            reason = error
            break
        found = tolerance, state, compare(ours, state), residual
        if best and not found[2].pressure < best[2].pressure / 1.5:
            break
        best = found
    if best is None:
        raise reason
    return best


def scans() -> Iterator[tuple[str, asp.surfaces.Surface | str]]:
    """Name each scan, and read it or say why not."""
    folder = os.environ.get("ASPERITY_DATA")
    for file in ("di-1.di", "mi-1.mi", "opd-1.opd"):
        if not folder or not (Path(folder) / file).exists():
            yield file, "absent: ASPERITY_DATA names no folder that has it"
            continue
        surface = asp.surfaces.read(Path(folder) / file, periodic="wrap")
        if file != "opd-1.opd":
            yield file, surface
            continue
        rows, columns = surface.heights.shape
        assert surface.pixel_size
        dy, dx = surface.pixel_size
        pairs = surface.heights.reshape(rows // 2, 2, columns).mean(axis=1)
        paired = asp.surfaces.Surface(pairs, surface.unit, (2 * dy, dx), surface.length_unit)
        yield f"{file}, pairs of rows", paired


def generated(n: int = 256, spacing: tuple[float, float] = (1.0, 1.7)) -> asp.surfaces.Surface:
    """A self-affine surface of 20 nm rms, on pixels given in um."""
    return asp.surfaces.Surface(20 * synthetic.self_affine(n, 3), "nm", spacing, "um")


TABLES = ["press", "march", "patches"]
PRESSED = ("surface", "MPa", "contact", "between", "tolerance", "sites", "pressure")
MARCHED = ("time", "step", "contacts", "Asperity's, exact", "general", "pressure, exact", "general")


def press_table(workers: dict[str, Worker], folder: Path) -> tuple[list[str], list[str]]:
    """Rows, and what disagrees."""
    rows, wrong = head(*PRESSED, "mean pressure", "mean gap", "gap", "residual"), []

    def add(name, pressure, ours, between, tolerance, difference, residual=""):
        cells = [name, f"{pressure / 1e6:g}", f"{ours.fraction:.6f}", between, tolerance, difference.sites]
        cells += [f"{getattr(difference, key):.1e}" for key in LIMITS if key != "sites"]
        rows.append(line(*cells, residual))
        print(rows[-1], flush=True)

    print(*rows, sep="\n", flush=True)
    for name, surface in (*scans(), ("self-affine, 1 x 1.7 um", generated())):
        if isinstance(surface, str):
            print(f"{name} is {surface}; skipped", file=sys.stderr)
            continue
        for pressure in PRESSURES:
            problem = problem_of(surface, pressure)
            usual, ours = press(surface, pressure), press(surface, pressure, strict=True)
            add(name, pressure, ours, "Asperity, usual and strict", "1e-09", compare(ours, usual))
            states = {}
            for peer, worker in workers.items():
                try:
                    tolerance, state, difference, residual = closest(worker, problem, ours, folder)
                except SolverError as error:
                    wrong.append(f"{name}, {pressure:g} Pa: {peer} gave no answer: {error}")
                    continue
                states[peer] = state
                how = f"Asperity, {peer}", f"{tolerance:.0e}", difference, f"{residual:.0e}"
                add(name, pressure, ours, *how)
                if beyond := difference.beyond(LIMITS):
                    wrong.append(f"{name}, {pressure:g} Pa, {peer}: {', '.join(beyond)}")
            if len(states) == 2:
                one, other = states.values()
                add(name, pressure, ours, "the two peers", "", compare(one, other))
    return rows, wrong


def march_table(worker: Worker, folder: Path) -> tuple[list[str], list[str]]:
    """Rows, and what disagrees."""
    name, scan = next(pair for pair in scans() if pair[0] == "mi-1.mi")
    if isinstance(scan, str):
        name, scan = "self-affine", generated(128)
    surface = asp.surfaces.Surface(scan.heights[:128, :128], scan.unit, scan.pixel_size, scan.length_unit)
    begin = asp.press(
        surface, asp.solids.half_space(modulus=MODULUS, branches=BRANCHES), pressure=PRESSURES[0]
    )
    ours, took = {}, {}
    for exact in (True, False):
        clock = time.perf_counter()
        asp.age(begin, TIMES, exact=exact)
        took[exact] = time.perf_counter() - clock
        ours[exact] = [asp.age(begin, [t], exact=exact, rtol=2e-5).final for t in TIMES]
    law = Law("half-space", modulus=MODULUS, branches=BRANCHES)
    problem = problem_of(surface, PRESSURES[0], law)
    said = f"{name}, 128 x 128 sites, branches {BRANCHES}; Asperity took {took[True]:.2f} s for all times"
    said += f" (exact), {took[False]:.2f} s (general march)."
    rows = [said, "", *head(*MARCHED, "order", "s a step")]
    wrong, before = [], None

    def apart(pressure: Field, contact: asp.Contact) -> float:
        return float(np.sqrt(((pressure - contact.pressure) ** 2).mean() / (contact.pressure**2).mean()))

    def add(i, step, pressure, order="", seconds=""):
        contacts = [np.count_nonzero(pressure > 0), *(ours[exact][i].area for exact in (True, False))]
        differences = [f"{apart(pressure, ours[exact][i]):.1e}" for exact in (True, False)]
        rows.append(line(TIMES[i], step, *contacts, *differences, order, seconds))

    for step in STEPS:
        how = {"do": "age", "times": TIMES, "options": {"step": step, "tolerance": 1e-10}}
        reply, answer = answered(worker, problem, folder, LIMIT, **how)
        pressures = answer["force"] / problem.cell
        if max(reply["gap_in_contact"]) > MARCH_LIMITS["gap_in_contact"]:
            wrong.append(f"march, step {step:g}: sites under pressure leave the heights")
        for i, contact in enumerate(ours[True]):
            order = ""
            if before is not None:
                order = f"{math.log2(apart(before[i], contact) / apart(pressures[i], contact)):.2f}"
            add(i, f"{step:g}", pressures[i], order, f"{reply['seconds'] / reply['steps']:.3f}")
            if step != STEPS[-1]:
                continue
            sites = abs(np.count_nonzero(pressures[i] > 0) - contact.area)
            extrapolated = 2 * pressures[i] - before[i]
            add(i, "extrapolated", extrapolated * (pressures[i] > 0))
            off = apart(extrapolated, contact)
            found = {"order": abs(float(order) - 1), "sites": sites, "extrapolated": off}
            at = f"march, time {TIMES[i]:g}"
            wrong += [f"{at}: {k} {v:.2g}" for k, v in found.items() if v > MARCH_LIMITS[k]]
        before = pressures
    print("", *rows, sep="\n", flush=True)
    return rows, wrong


def patches_table(worker: Worker, folder: Path) -> tuple[list[str], list[str]]:
    """Rows, and what disagrees."""
    rows, wrong = head("edges", "seed", "contact", "sites that differ", "pressure"), []
    for edges, seed, rms in PATCHES:
        heights = rms * synthetic.self_affine(256, seed)
        load = MEAN_PRESSURE * heights.size
        surface, solid = asp.surfaces.Surface(heights, edges=edges), asp.solids.half_space(modulus=1.0)
        ours = asp.press(surface, solid, load=load)
        law = Law("half-space" if edges == "periodic" else "free half-space")
        force = answered(worker, Problem(heights, law, load), folder, LIMIT, tolerance=1e-12)[1]["force"]
        sites = int(np.count_nonzero((force > 0) != ours.in_contact))
        off = float(np.abs(force - ours.force).max() / ours.force.max())
        rows.append(line(edges, seed, f"{100 * ours.contact_fraction:.2f} %", sites, f"{off:.1e}"))
        if sites or not off <= PATCH_LIMIT:
            wrong.append(f"{edges}, seed {seed}, rms {rms:g}: {sites} sites, pressure {off:.1e}")
    print("", *rows, sep="\n", flush=True)
    return rows, wrong


def main() -> int:
    parser = running.parser(__doc__)
    parser.add_argument("--only", nargs="+", choices=TABLES, default=TABLES)
    parser.add_argument("--peers-python", nargs="+", default=[], metavar="PYTHON")
    parser.add_argument("--store", type=Path, help="write the tables to this file")
    options = parser.parse_args()
    tables, wrong = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if "press" in options.only:
            workers = running.peers(PEERS, options.peers_python)
            rows, failures = press_table(workers, folder)
            tables.append([f"Peers: {', '.join(worker.version for worker in workers.values())}", "", *rows])
            wrong += failures
            for worker in workers.values():
                worker.close()
        others = {"march": (solvers.MARCHES, march_table), "patches": (["aspher"], patches_table)}
        for names, table in (others[name] for name in others if name in options.only):
            for worker in running.peers(names, options.peers_python).values():
                rows, failures = table(worker, folder)
                tables.append([f"Peer: {worker.version}", "", *rows])
                wrong += failures
                worker.close()
    if options.store:
        options.store.write_text("\n\n".join("\n".join(table) for table in tables) + "\n")
    for one in wrong:
        print(f"DISAGREE: {one}", file=sys.stderr)
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
