"""Measure how long a fresh process takes to be useful, and how large the installed packages are.

    python benchmarks/startup.py [--repeats 5]

`asperity --help`, and Python from nothing through `import asperity` to its first `press` and `age` of
200 x 200 sites, each by the wall clock of whole processes, median and best. Compiled code is cached: the
first line is measured with an empty cache of its own, the others with the cache that it left. Processor time
stands beside it: on a busy machine it says more.

Sizes are those of the files that the distributions list, without byte code: of the base install with all
that it brings, of its largest members, and of what each extra adds.
"""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable
from importlib import metadata
from typing import Any

import machine
import running
from packaging.requirements import Requirement

IMPORT = "import asperity as asp; import numpy as np; "
PRESS = IMPORT + (
    "rough = asp.surfaces.gaussian((200, 200)); solid = asp.solids.spring_lattice(k0=1.0, k1=3.0); "
    "contact = asp.press(rough, solid, load=800.0); "
)
AGE = PRESS + "asp.age(contact, np.geomspace(1e-3, 1e6, 37))"


def main() -> None:
    parser = running.parser(__doc__, threads=True, out=True)
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    commands = {
        "first press and age, nothing cached": ["-c", AGE],
        "python and numpy alone": ["-c", "import numpy"],
        "import asperity": ["-c", "import asperity"],
        "asp.press imported": ["-c", "import asperity as asp; asp.press"],
        "asperity --help": ["-m", "asperity", "--help"],
        "first press": ["-c", PRESS],
        "first press and age": ["-c", AGE],
    }
    found: dict[str, Any] = {"machine": machine.facts(), "seconds": {}, "megabytes": sizes()}
    with tempfile.TemporaryDirectory() as folder:
        environment = {**machine.thread_environment(options.threads), "NUMBA_CACHE_DIR": folder}
        for name, arguments in commands.items():
            repeats = 1 if "nothing cached" in name else options.repeats
            times, processor = [], []
            for _ in range(repeats):
                begin, before = time.perf_counter(), os.times()
                subprocess.run([sys.executable, *arguments], env=environment, check=True, capture_output=True)
                times.append(time.perf_counter() - begin)
                after = os.times()
                processor.append(sum(after[2:4]) - sum(before[2:4]))
            found["seconds"][name] = {"wall": times, "processor": processor}
            print(
                f"{name:36} {statistics.median(times):.3f} s, best {min(times):.3f} s, "
                f"of the processor {min(processor):.3f} s",
                flush=True,
            )
    running.store(options.out, "startup", found)


def closure(requirements: Iterable[str]) -> set[str]:
    """Names of the distributions that these requirements bring, through all of theirs."""
    found: set[tuple[str, frozenset[str]]] = set()
    waiting = [Requirement(text) for text in requirements]
    while waiting:
        requirement = waiting.pop()
        key = (re.sub(r"[-_.]+", "-", requirement.name).lower(), frozenset(requirement.extras))
        if key in found:
            continue
        found.add(key)
        environments = [{"extra": extra} for extra in ("", *requirement.extras)]
        for text in metadata.requires(requirement.name) or []:
            further = Requirement(text)
            if further.marker is None or any(further.marker.evaluate(given) for given in environments):
                waiting.append(further)
    return {name for name, _ in found}


def sizes() -> dict[str, Any]:
    """Megabytes of the installed base and of what each extra adds; printed as they are found."""
    base = closure(["asperity"])
    each = {name: megabytes(name) for name in base}
    print(f"{'base':36} {len(base)} packages, {sum(each.values()):.0f} MB")
    for name in sorted(each, key=lambda name: -each[name])[:8]:
        print(f"  {name:34} {each[name]:.1f} MB")
    added = {}
    for extra in metadata.metadata("asperity").get_all("Provides-Extra") or []:
        try:
            more = closure([f"asperity[{extra}]"]) - base
            added[extra] = sum(map(megabytes, more))
        except metadata.PackageNotFoundError:
            continue  # it is not installed
        print(f"{'with ' + extra:36} {len(more)} packages more, {added[extra]:.0f} MB")
    return {"base": each, "extras": added}


def megabytes(name: str) -> float:
    """Size of the files of an installed distribution, without byte code."""
    files = [file for file in metadata.files(name) or [] if file.suffix != ".pyc"]
    return sum(file.locate().stat().st_size for file in files if file.locate().exists()) / 1e6  # type: ignore[attr-defined]


if __name__ == "__main__":
    main()
