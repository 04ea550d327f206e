"""The solvers as subprocesses, each in the interpreter that has it."""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import machine

PEERS = Path(__file__).parent / "peers"
ASPERITY = "asperity"
MODULES = {
    ASPERITY: "asperity_itself",
    "numpi": "numpi_ccgr",
    "numpi-stencil": "numpi_stencil",
    "petsc": "petsc_vi",
    "slippy": "slippy_pk",
    "tamaas": "tamaas_pkr",
    "contactmechanics": "contact_mechanics",
    "aspher": "aspher_nested",
}
MARCHES = {"tamaas-maxwell": "tamaas_maxwell"}
"""What only ages; `agreement.py` alone asks for it."""
START_LIMIT = 120.0


class SolverError(Exception):
    """A solver gave no answer: it is absent, raised, died, or took too long."""


class Worker:
    """One solver in a process of its own, which a ``with`` block ends.

    Attributes
    ----------
    version
        Name and version of the solver.
    kinds
        The kinds of law that it can solve; None for all.
    """

    def __init__(self, solver: str, python: str, threads: int) -> None:
        self._command = [python, str(PEERS / "worker.py"), {**MODULES, **MARCHES}[solver]]
        self._environment = machine.thread_environment(threads)
        self._start()

    def _start(self) -> None:
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=self._environment,
            bufsize=0,
        )
        try:
            hello = self._read(START_LIMIT)
            if "absent" in hello:
                raise SolverError(hello["absent"])
        except SolverError:
            self.close()
            raise
        self.version: str = hello["version"]
        self.kinds: list[str] | None = hello["kinds"]

    def ask(self, request: dict[str, Any], limit: float) -> dict[str, Any]:
        """Send a request and wait for its reply, ``limit`` seconds at most; then the process is ended.

        The next request starts another.
        """
        if self._process.poll() is not None:
            self._start()
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(request).encode() + b"\n")
        except OSError as error:
            self.close()
            raise SolverError("died") from error
        reply = self._read(limit)
        if "error" in reply:
            raise SolverError(reply["error"])
        return reply

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        self._process.wait()

    def _read(self, limit: float) -> dict[str, Any]:
        pipe = self._process.stdout
        assert pipe is not None
        ready, _, _ = select.select([pipe], [], [], limit)
        if not ready:
            self.close()
            raise SolverError(f"over {limit:.0f} s")
        line = pipe.readline()
        if not line:
            self.close()
            raise SolverError("died")
        reply: dict[str, Any] = json.loads(line)
        return reply


def interpreters(given: Sequence[str]) -> list[str]:
    """Where peers may be: as given, in ASPERITY_PEERS_PYTHON, where peers/install puts them, the system's."""
    named = os.environ.get("ASPERITY_PEERS_PYTHON", "").split(os.pathsep)
    installed = sorted((Path.home() / ".asperity-peers").glob("*/bin/python"))
    candidates = [*given, *named, *map(str, installed), "/usr/bin/python3"]
    return [path for path in dict.fromkeys(candidates) if path and Path(path).exists()]


def start(solver: str, pythons: Sequence[str], threads: int) -> Worker:
    """Start a solver in the first interpreter that has it.

    Raises
    ------
    SolverError
        None has.
    """
    reasons = []
    for python in [sys.executable] if solver == ASPERITY else pythons:
        try:
            return Worker(solver, python, threads)
        except SolverError as error:
            reasons.append(f"{python}: {error}")
    raise SolverError("; ".join(reasons) or "no interpreter to look in (--peers-python)")
