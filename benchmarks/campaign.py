"""Measure what a campaign costs beyond the computing itself.

Does runs of 64 x 64 sites over nine decades on all cores and compares the wall-clock time of the whole
command (start of the workers included), times the workers, with the sum of the times that the runs
themselves took in their workers, as stored with each.

    python benchmarks/campaign.py [--runs 1000] [--workers 2]
"""

import argparse
import tempfile
import time
from pathlib import Path

import asperity as asp
from asperity.base.machine import cores

PLAN = """
[surface]
shape = [64, 64]
[contact]
load = 82.0
[sweep]
seeds = {runs}
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=cores())
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "campaign.toml"
        path.write_text(PLAN.format(runs=options.runs))
        begin = time.perf_counter()
        plan = asp.campaign.read_plan(path)
        end = asp.campaign.sweep(plan, Path(folder) / "out", workers=options.workers)
        wall = time.perf_counter() - begin
        data = asp.campaign.open(Path(folder) / "out")
        gathered = time.perf_counter() - begin - wall
    computing = float(data["seconds"].sum())
    overhead = wall * options.workers - computing
    print(f"runs {end.done}, failed {end.failed}, workers {options.workers}")
    print(f"wall {wall:.1f} s, computing {computing:.1f} s in all, {computing / end.done:.3f} s a run")
    share = 100 * overhead / computing
    print(f"overhead {1e3 * overhead / end.done:.1f} ms a run = {share:.1f} % of the computing")
    print(f"gathered in {gathered:.1f} s")


if __name__ == "__main__":
    main()
