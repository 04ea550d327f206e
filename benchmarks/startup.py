"""Measure how long a fresh process takes to be useful.

    python benchmarks/startup.py [--repeats 5]

`asperity --help`, and Python from nothing through `import asperity` to its first `press` and `age` of
200 x 200 sites, each by the wall clock of whole processes, median and best. Compiled code is cached: the
first line is measured with an empty cache of its own, the others with the cache that it left.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import machine

IMPORT = "import asperity as asp; import numpy as np; "
PRESS = IMPORT + (
    "rough = asp.surfaces.gaussian((200, 200)); solid = asp.solids.spring_lattice(k0=1.0, k1=3.0); "
    "contact = asp.press(rough, solid, load=800.0); "
)
AGE = PRESS + "asp.age(contact, np.geomspace(1e-3, 1e6, 37))"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("results/bench"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    commands = {
        "first press and age, nothing cached": ["-c", AGE],
        "python and numpy alone": ["-c", "import numpy"],
        "asperity --help": ["-m", "asperity", "--help"],
        "first press": ["-c", PRESS],
        "first press and age": ["-c", AGE],
    }
    found: dict[str, Any] = {"machine": machine.facts(), "seconds": {}}
    with tempfile.TemporaryDirectory() as folder:
        environment = {**machine.thread_environment(options.threads), "NUMBA_CACHE_DIR": folder}
        for name, arguments in commands.items():
            repeats = 1 if "nothing cached" in name else options.repeats
            times = []
            for _ in range(repeats):
                begin = time.perf_counter()
                subprocess.run([sys.executable, *arguments], env=environment, check=True, capture_output=True)
                times.append(time.perf_counter() - begin)
            found["seconds"][name] = times
            print(f"{name:36} {statistics.median(times):.3f} s, best {min(times):.3f} s", flush=True)
    (options.out / "startup.json").write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
