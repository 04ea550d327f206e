"""What halving and doubling each tuned number of the engine changes: iterations, time steps, and the answers.

    sensitivity.py                     every number of every `Tuning` in contact and aging
    sensitivity.py --only active_set   those whose name contains a text
    sensitivity.py --out table.csv     the same as a table

Counts repeat to the last digit, so other work on the machine does not matter. A number that changes no count
and fails no test is to go.
"""

from __future__ import annotations

import csv
import dataclasses
import importlib
import pkgutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import running
import synthetic

import asperity as asp
from asperity import solids
from asperity.protocols import Hold, Ramp

ROOMS = "asperity.contact", "asperity.aging"
TIMES = np.geomspace(1e-3, 1e6, 10)
PRONY = ((0.3, 0.01), (0.2, 1.0), (0.2, 100.0))


class Counts(NamedTuple):
    """Iterations and time steps of a case, and the areas at its published times, sites."""

    iterations: int
    steps: int
    areas: tuple[int, ...]


def _history(contact: asp.Contact, times: Any = TIMES, **how: Any) -> Counts:
    data = asp.age(contact, times, progress=False, **how).dataset
    steps = int(data["steps"].sum() + data["rejected"].sum())
    return Counts(int(data["iterations"].sum()), steps, tuple(data["area"].values.astype(int).tolist()))


def _counted(contact: asp.Contact) -> Counts:
    return Counts(contact.iterations, 0, (contact.area,))


def _springs(k1: float, n: int = 128, **more: Any) -> Callable[..., asp.Contact]:
    solid = solids.spring_lattice(k0=1.0, k1=k1, **more)
    return lambda surface=synthetic.white, p=0.05: asp.press(surface(n), solid, load=p * n * n)


def _half_space(n: int = 128, p: float = 0.0021, rms: float = 0.2, **more: Any) -> asp.Contact:
    return asp.press(rms * synthetic.self_affine(n), solids.half_space(modulus=1.0, **more), pressure=p)


EYRING = solids.Eyring(rate=1e-4, stress=0.1)
NORTON = solids.Norton(rate=1e-2, stress=0.1, exponent=3.0)
UP_AND_DOWN = [Ramp(1.0, load=0.0042 * 128**2), Hold(100.0), Ramp(1.0, load=0.001 * 128**2), Hold(1000.0)]

CASES: dict[str, Callable[[], Counts]] = {
    "press springs": lambda: _counted(_springs(0.1, 256)()),
    "press rough springs": lambda: _counted(_springs(0.01, 256)(synthetic.self_affine, 0.008)),
    "relax springs": lambda: _counted(asp.relax(_springs(0.1, 256)())),
    "age springs 0.01": lambda: _history(_springs(0.01)(synthetic.self_affine, 0.008)),
    "age springs 1": lambda: _history(_springs(1.0)()),
    "age springs 100": lambda: _history(_springs(100.0, 64, R_viscous=0.01)()),
    "age springs k0 = 0": lambda: _history(
        asp.press(synthetic.white(64), solids.spring_lattice(k0=0.0, k1=1.0), load=0.05 * 64**2)
    ),
    "hold separation": lambda: _history(_springs(3.0)(), hold="separation"),
    "hold area": lambda: _history(_springs(3.0)(), hold="area"),
    "line": lambda: _history(
        asp.press(synthetic.white(32).ravel(), solids.spring_lattice(k0=1.0, k1=0.3), load=100.0)
    ),
    "press half-space 0.2 %": lambda: _counted(_half_space(512, 0.0002, 0.4)),
    "press half-space 5 %": lambda: _counted(_half_space(512, 0.0021, 0.386)),
    "press half-space 50 %": lambda: _counted(_half_space(256, 0.03, 0.217)),
    "age half-space": lambda: _history(_half_space(branches=PRONY)),
    "age half-space by steps": lambda: _history(_half_space(branches=PRONY), exact=False),
    "half-space up and down": lambda: _history(
        _half_space(branches=PRONY), [1.0, 101.0, 102.0, 1100.0], protocol=UP_AND_DOWN
    ),
    "hold flowing half-space": lambda: _history(
        _half_space(64, apparatus=np.inf, flow=(0.5, 1.0)), TIMES[:5], hold="separation"
    ),
    "hard half-space": lambda: _counted(_half_space(hardness=0.05)),
    "Eyring on springs": lambda: _history(_springs(1.0, 64, R=0.0, creep=EYRING)(), TIMES[:7]),
    "Norton half-space": lambda: _history(_half_space(64, creep=NORTON), TIMES[:7]),
    "Norton in part": lambda: _history(_half_space(64, creep=NORTON, permanent=0.2), TIMES[:7]),
}


def tunings() -> Iterator[tuple[ModuleType, str, float]]:
    """Modules with the names and values of their tuned numbers."""
    for room in ROOMS:
        package = importlib.import_module(room)
        for found in pkgutil.walk_packages(package.__path__, f"{room}."):
            module = importlib.import_module(found.name)
            tuning = getattr(module, "TUNING", None)
            if tuning is not None and type(tuning).__module__ == found.name:
                for field in dataclasses.fields(tuning):
                    yield module, field.name, getattr(tuning, field.name)


def with_value(module: ModuleType, name: str, value: float, case: Callable[[], Counts]) -> Counts | str:
    """Run a case with another value; what it says if it fails."""
    before: Any = vars(module)["TUNING"]
    put(module, dataclasses.replace(before, **{name: value}))
    try:
        return case()
    except Exception as error:  # a number that must not be changed is a result too
        return type(error).__name__
    finally:
        put(module, before)


def put(module: ModuleType, tuning: Any) -> None:
    """Give a module other numbers, and let it forget what it found with those before."""
    vars(module)["TUNING"] = tuning
    for found in vars(module).values():
        if hasattr(found, "cache_clear") and found.__module__ == module.__name__:
            found.cache_clear()


def scaled(value: float, factor: float) -> float:
    """Half or double; of a whole number a whole number."""
    return max(1, round(factor * value)) if isinstance(value, int) else factor * value


def change(usual: Counts, found: Counts | str) -> tuple[float, float]:
    """Relative change of the work (iterations, or time steps where these change more), and of the areas."""
    if isinstance(found, str):
        return np.inf, np.inf
    work = [
        found.iterations / max(usual.iterations, 1) - 1,
        found.steps / usual.steps - 1 if usual.steps else 0.0,
    ]
    areas = np.abs(np.subtract(found.areas, usual.areas)) / np.maximum(usual.areas, 1)
    return max(work, key=abs), float(areas.max())


def main() -> int:
    parser = running.parser(__doc__)
    parser.add_argument("--only", default="", help="numbers whose module and name contain a text")
    parser.add_argument("--cases", default="", help="cases whose name contains a text")
    parser.add_argument("--out", help="a CSV file, a line for each number, factor and case that changed")
    asked = parser.parse_args()
    cases = {name: case for name, case in CASES.items() if asked.cases in name}
    usual = {name: case() for name, case in cases.items()}
    for name, counts in usual.items():
        print(f"{name:26} {counts.iterations:6} iterations {counts.steps:5} steps  area {counts.areas[-1]}")
    rows = []
    print(f"\n{'number':44} {'value':>10} {'factor':>6} {'work':>8} {'areas':>8}  most in")
    for module, name, value in tunings():
        full = f"{module.__name__.removeprefix('asperity.')}.{name}"
        if asked.only not in full:
            continue
        for factor in (0.5, 2.0):
            other = scaled(value, factor)
            changes = {
                case: change(usual[case], with_value(module, name, other, run)) for case, run in cases.items()
            }
            most = max(changes, key=lambda case: abs(changes[case][0]))
            where = most if changes[most][0] else "none"
            areas = max(found[1] for found in changes.values())
            print(
                f"{full:44} {value:10.4g} {factor:6} {changes[most][0]:+8.1%} {areas:8.1e}  {where}",
                flush=True,
            )
            rows += [(full, value, factor, case, *found) for case, found in changes.items() if any(found)]
    if asked.out:
        with Path(asked.out).open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(("number", "value", "factor", "case", "work", "areas"))
            writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
