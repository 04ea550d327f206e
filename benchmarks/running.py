"""What the scripts share: flags, processes of their own, peers that answer, lines of tables, and files."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import machine
import numpy as np
import solvers
from peers.problem import Problem
from prepare import write
from solvers import SolverError, Worker


def parser(words: str | None, *, threads: bool = False, out: bool = False) -> argparse.ArgumentParser:
    """A parser that shows the words of a script, with flags that several have."""
    found = argparse.ArgumentParser(description=words, formatter_class=argparse.RawDescriptionHelpFormatter)
    if threads:
        found.add_argument("--threads", type=int, default=1)
    if out:
        found.add_argument("--out", type=Path, default=Path("results/bench"), help="folder of the numbers")
    return found


def alone(script: str, words: Iterable[object], threads: int, limit: float | None = None) -> dict[str, Any]:
    """Run a script in a process of its own, where every library has the threads it is to have.

    Its last line is its numbers; ``failure`` says why there are none.
    """
    command = [sys.executable, script, *map(str, words)]
    try:
        done = subprocess.run(
            command,
            env=machine.thread_environment(threads),
            stdout=subprocess.PIPE,
            text=True,
            check=False,
            timeout=limit,
        )
    except subprocess.TimeoutExpired:
        return {"failure": f"over {limit:.0f} s"}
    if done.returncode:
        return {"failure": f"exit status {done.returncode}"}
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found


def peers(names: Iterable[str], pythons: Sequence[str], threads: int = 1) -> dict[str, Worker]:
    """Start the peers that are there, and say which are not."""
    workers = {}
    for name in names:
        try:
            workers[name] = solvers.start(name, solvers.interpreters(pythons), threads)
        except SolverError as error:
            print(f"{name} is absent, and skipped: {error}", file=sys.stderr)
    return workers


def answered(
    worker: Worker, problem: Problem, folder: Path, limit: float, **request: Any
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Ask a peer for a problem, written under a name of its own, as workers keep what they read.

    The reply, and the fields of the answer.
    """
    path, out = folder / f"problem-{time.monotonic_ns()}.npz", folder / "answer.npz"
    write(problem, path)
    reply = worker.ask({"do": "solve", **request, "problem": str(path), "out": str(out)}, limit)
    with np.load(out) as fields:
        return reply, dict(fields)


def line(*cells: object) -> str:
    """A line of a table on a page."""
    return f"| {' | '.join(map(str, cells))} |"


def head(*titles: str) -> list[str]:
    """The first two lines of one."""
    return [line(*titles), f"|{'---|' * len(titles)}"]


def store(folder: Path, name: str, found: dict[str, Any]) -> None:
    """Keep numbers as NAME.json."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n")
