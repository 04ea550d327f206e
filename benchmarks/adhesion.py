"""What adhesion costs: contacts and aging with Dugdale's law beside the same without it.

    python benchmarks/adhesion.py [--sizes 512 1024]

A self-affine surface without waves below 16 sites is pressed onto a half-space that relaxes, under a mean
pressure that makes about 5 % contact, and ages for two relaxation times in general time steps. One thread.
Seconds are those of the processor; revisions are those of the contacts and of the attraction.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import asperity as asp
from asperity.contact import ActiveSet

LAW = asp.solids.Dugdale(work=0.002, range=0.18)
BRANCHES = [(0.5, 1.0)]
TIMES = np.geomspace(1e-2, 2.0, 8)


class Counting:
    """A solver that counts its revisions."""

    knows_adhesion = True

    def __init__(self) -> None:
        self.solver, self.revisions = ActiveSet(), 0

    def solve(self, problem: Any, guess: Any, accuracy: Any) -> Any:
        """Solve and count."""
        solution = self.solver.solve(problem, guess, accuracy)
        self.revisions += solution.set_changes
        return solution

    def __repr__(self) -> str:
        return "Counting()"


def timed(call: Callable[..., Any], *given: Any, **how: Any) -> tuple[Any, float, int]:
    """What a call returns, its seconds of the processor, and the revisions that it took."""
    counting, begun = Counting(), time.process_time()
    found = call(*given, solver=counting, **how)
    return found, time.process_time() - begun, counting.revisions


def main() -> None:
    """Measure and print a table."""
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("--sizes", type=int, nargs="+", default=[512, 1024])
    sizes = parser.parse_args().sizes
    columns = ["sites", "adhesion", "press s", "revisions", "area %", "aging s", "steps", "rejected"]
    columns += ["revisions a stage", "area in the end %"]
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|")
    for n in sizes:
        rough = asp.surfaces.spectral((n, n), hurst=0.8, roll_off=128.0, cutoff=16.0, rms_height=1.0, seed=1)
        for law in (None, LAW):
            solid = asp.solids.half_space(modulus=1.0, branches=BRANCHES, adhesion=law)
            pressed, press, revisions = timed(asp.press, rough, solid, pressure=2e-3)
            aged, aging, more = timed(asp.age, pressed, TIMES, exact=False)
            steps, rejected = (int(aged[name].values.sum()) for name in ("steps", "rejected"))
            each = more / (2 * (steps + rejected))
            first, last = (100 * one.contact_fraction for one in (pressed, aged.final))
            name = "none" if law is None else "Dugdale"
            row = [f"{n} x {n}", name, f"{press:.2f}", revisions, f"{first:.2f}", f"{aging:.1f}"]
            row += [steps, rejected, f"{each:.1f}", f"{last:.2f}"]
            print(f"| {' | '.join(map(str, row))} |", flush=True)


if __name__ == "__main__":
    main()
