"""Time Asperity beside its peers, and check every field that they hand back.

    python benchmarks/bench.py                 the quick cases, about ten minutes
    python benchmarks/bench.py --all           every case
    python benchmarks/bench.py --only lattice  the cases whose name begins so; several may be given

Prints a table and stores it, with the facts of the machine, as results/bench/table.md and table.json.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import curve
import machine
import numpy as np
import prepare
import report
import running
import solvers
import tolerances
from cases import CASES, CURVES, Case
from check import Verdict, judge
from solvers import ASPERITY, SolverError, Worker

RESIDUAL = 1e-8
"""What everybody must reach; Asperity returns nothing with more."""


@dataclass
class Run:
    """One solver on one case: what it took, each time, and how good it was."""

    solver: str
    tolerance: float
    seconds: list[float] = field(default_factory=list)
    cpu_seconds: list[float] = field(default_factory=list)
    iterations: int = -1
    verdict: Verdict | None = None
    in_contact: np.ndarray | None = None
    note: dict[str, Any] = field(default_factory=dict)
    failure: str = ""


def main() -> None:
    options = _options()
    chosen = [case for case in CASES if _is_chosen(case.name, case.quick, options)]
    curves = [name for name in CURVES if _is_chosen(name, CURVES[name][1] <= 200, options)]
    if not chosen and not curves:
        sys.exit(f"no such case; there are {', '.join([*(case.name for case in CASES), *CURVES])}")
    book = report.Book(machine.facts(), options.threads, options.residual)
    workers = _start(options, book) if chosen else {}
    try:
        with tempfile.TemporaryDirectory() as folder:
            for case in chosen:
                print(f"{case.name} ...", file=sys.stderr, flush=True)
                for row in _rows(case, workers, options, Path(folder)):
                    book.rows.append(row)
                book.save(options.out)
    finally:
        for worker in workers.values():
            worker.close()
    for name in curves:
        print(f"{name} ...", file=sys.stderr, flush=True)
        for rtol in curve.RTOLS:
            solid, size = CURVES[name]
            book.curves.append(curve.run(size, options.threads, rtol, solid))
    book.save(options.out)
    print(book.text())


def _options() -> argparse.Namespace:
    parser = running.parser(__doc__, threads=True, out=True)
    parser.add_argument("--all", action="store_true", help="also the cases that take long")
    parser.add_argument("--only", nargs="+", default=[], metavar="CASE", help="cases whose name begins so")
    parser.add_argument("--solvers", nargs="+", default=list(solvers.MODULES), choices=solvers.MODULES)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--budget", type=float, default=10.0, help="seconds per solver and case for repeats")
    parser.add_argument("--limit", type=float, help="seconds a solve may take (60; with --all or --only 900)")
    parser.add_argument("--residual", type=float, default=RESIDUAL, help="what every solver must reach")
    parser.add_argument("--tune", action="store_true", help="find the loosest tolerances anew and keep them")
    parser.add_argument("--peers-python", nargs="+", default=[], metavar="PATH", help="where peers are")
    options = parser.parse_args()
    if options.limit is None:
        options.limit = 900.0 if options.all or options.only else 60.0
    return options


def _is_chosen(name: str, quick: bool, options: argparse.Namespace) -> bool:
    if options.only:
        return any(name.startswith(start) for start in options.only)
    return quick or options.all


def _start(options: argparse.Namespace, book: report.Book) -> dict[str, Worker]:
    """Start every solver that is there, Asperity first; the book says which are not."""
    pythons = solvers.interpreters(options.peers_python)
    workers = {}
    for solver in [ASPERITY, *(name for name in options.solvers if name != ASPERITY)]:
        try:
            workers[solver] = solvers.start(solver, pythons, options.threads)
        except SolverError as error:
            if solver == ASPERITY:
                raise
            book.absent[solver] = str(error)
            print(f"{solver} is absent: {error}", file=sys.stderr)
        else:
            book.versions[solver] = workers[solver].version
    return workers


def _rows(
    case: Case, workers: dict[str, Worker], options: argparse.Namespace, folder: Path
) -> list[dict[str, Any]]:
    """Do one case with every solver: once for the tolerance, then in turn, A B C A B C."""
    task = prepare.prepare(case, workers[ASPERITY], folder, 10 * options.limit)
    runs = [Run(name, tolerances.known(name, case.name)) for name in workers]
    for run in runs:
        _settle(run, task, workers[run.solver], options)
    going = [run for run in runs if not run.failure]
    for _ in range(options.repeats):
        for run in going:
            if sum(run.seconds) < options.budget:
                _once(run, task, workers[run.solver], options)
    if options.tune:
        tolerances.keep(case.name, {run.solver: run.tolerance for run in going if run.solver != ASPERITY})
    # Asperity's answer is the reference; in a step, where it integrates in its own way, the first peer's.
    answered = (run.in_contact for run in going if run.in_contact is not None)
    reference = next(answered, None)
    return [_row(case, run, reference) for run in runs]


def _settle(run: Run, task: prepare.Task, worker: Worker, options: argparse.Namespace) -> None:
    """Find the loosest tolerance, from the known one on, at which the solver reaches the residual."""
    if worker.kinds is not None and task.kind not in worker.kinds:
        run.failure = "not its problem"
        return
    if options.tune:
        run.tolerance = min(tolerances.LOOSEST, float(f"{10 * run.tolerance:.1e}"))
    while True:
        _once(run, task, worker, options)
        if run.failure or run.verdict is None or run.verdict.residual <= options.residual:
            break
        tighter = tolerances.tighter(run.tolerance)
        if run.solver == ASPERITY or tighter is None:
            run.note["residual"] = "not reached"
            break
        run.tolerance = tighter
    # A first solve compiles, plans and reads; it counts only where there will hardly be another.
    if sum(run.seconds[-1:]) < options.budget:
        run.seconds, run.cpu_seconds = [], []
    else:
        run.seconds, run.cpu_seconds = run.seconds[-1:], run.cpu_seconds[-1:]


def _once(run: Run, task: prepare.Task, worker: Worker, options: argparse.Namespace) -> None:
    """Solve once and judge the fields; a failure ends the solver's part in this case."""
    out = task.folder / "answer.npz"
    try:
        if run.solver == ASPERITY and task.ages is not None:
            reply = worker.ask({"do": "age", "problem": str(task.own), "times": task.ages}, options.limit)
            problems = 2 * (reply["steps"] + reply["rejected"])
            run.seconds.append(reply["seconds"] / problems)
            run.cpu_seconds.append(reply["cpu_seconds"] / problems)
            run.iterations = round(reply["iterations"] / problems)
            run.verdict = Verdict(reply["residual"], 0.0, 0.0, reply["contact_fraction"])
            run.note = {"contact problems": problems}
            return
        path = task.own if run.solver == ASPERITY else task.peers
        request = {"do": "solve", "problem": str(path), "tolerance": run.tolerance, "out": str(out)}
        reply = worker.ask(request, options.limit)
    except SolverError as error:
        run.failure = str(error)
        return
    with np.load(out) as fields:
        run.in_contact = fields["in_contact"]
        run.verdict = judge(task.problem, fields["u"], run.in_contact, fields.get("force"))
    run.seconds.append(reply["seconds"])
    run.cpu_seconds.append(reply["cpu_seconds"])
    run.iterations, run.note = reply["iterations"], reply["note"]


def _row(case: Case, run: Run, reference: np.ndarray | None) -> dict[str, Any]:
    """What the table keeps of a run."""
    row: dict[str, Any] = {"case": case.name, "size": case.n, "solver": run.solver, "failure": run.failure}
    if run.failure or run.verdict is None or not run.seconds:
        return row
    differ = None
    if run.in_contact is not None and reference is not None:
        differ = int(np.count_nonzero(run.in_contact != reference))
    return {
        **row,
        "tolerance": run.tolerance,
        "contact_fraction": run.verdict.contact_fraction,
        "iterations": run.iterations,
        "residual": run.verdict.residual,
        "penetration": run.verdict.penetration,
        "load_error": run.verdict.load_error,
        "sites_that_differ": differ,
        "seconds": statistics.median(run.seconds),
        "best_seconds": min(run.seconds),
        "cpu_seconds": statistics.median(run.cpu_seconds),
        "all_seconds": run.seconds,
        "note": run.note,
    }


if __name__ == "__main__":
    main()
