"""Time nine decades of aging against the transforms of the same lattice.

    python benchmarks/curve.py [--sizes 200 1024] [--rtols 2e-3 1e-2] [--solid springs]

37 times from 1e-3 to 1e6. On springs k1/k0 = 3 and F / (N k0) = 0.02, white heights; the same without springs
between neighbors (k0_zero), and on a line of as many sites (line). One spike on flat ground, k1/k0 = 27,
where most sites touch (spike). Self-affine heights (H = 0.8), whose contacts have fronts: stiff springs to
the bulk, k1/k0 = 100 and F / (N (k0 + k1)) = 0.02 (fronts), and none between neighbors, F / (N k1) = 0.02
(k0_zero_fronts). On a half-space, at 1 % contact, self-affine heights (H = 0.8) and twelve
branches of 8 %, with times from 1e-3 to 1e6: with the exact contact (half_space), and with the general march
(half_space_march). With a local law in place of linear creep (eyring, norton), or beside it (eyring_beside):
then the history of springs is timed before and after in the same process, for the cost of a step in units of
a linear one.

In the same process and on the same threads, 500 forward-and-back pairs of scipy.fft.rfftn and irfftn of that
size are timed before, and 500 after. The transforms of that size that the run itself took are counted, those
in single precision apart. The areas are compared with those of a run at a tenth of the tolerance, which is
not timed with the others. 2e-3 is the tolerance that Asperity takes by itself.
"""

from __future__ import annotations

import itertools
import json
import os
import time
from typing import Any

import running
import synthetic

PAIRS = 1000
RTOLS = (2e-3, 1e-2)
LAWS = ("eyring", "eyring_beside", "norton")


def run(size: int, threads: int, rtol: float, solid: str) -> dict[str, Any]:
    """Measure in a process of its own, so that every library has the threads it is to have."""
    words = ["--sizes", size, "--threads", threads, "--rtols", rtol, "--solid", solid, "--json"]
    return {"size": size, "rtol": rtol, "solid": solid} | running.alone(__file__, words, threads)


def pairs(heights, count: int, threads: int) -> float:
    """Seconds that so many forward-and-back pairs of transforms take."""
    import scipy.fft

    begin = time.perf_counter()
    for _ in range(count):
        scipy.fft.irfftn(scipy.fft.rfftn(heights, workers=threads), s=heights.shape, workers=threads)
    return time.perf_counter() - begin


def case(solid: str, size: int) -> tuple[Any, Any, float]:
    """Heights, solid and load."""
    import numpy as np

    import asperity as asp

    white, load = synthetic.white(size), 0.02 * size**2
    if solid in ("springs", "line"):
        heights = white.ravel() if solid == "line" else white
        return heights, asp.solids.spring_lattice(k0=1.0, k1=3.0), load
    if solid in LAWS:
        rate = 1.0 if solid == "eyring_beside" else 0.0
        law = asp.solids.Norton(0.5, 1.0, 3.0) if solid == "norton" else asp.solids.Eyring(1e-3, 0.1)
        return white, asp.solids.spring_lattice(k0=1.0, k1=3.0, R=rate, creep=law), load
    if solid == "k0_zero":
        return white, asp.solids.spring_lattice(k0=0.0, k1=3.0), load
    if solid in ("fronts", "k0_zero_fronts"):
        heights = asp.surfaces.self_affine(size, hurst=0.8, delta=1.0, seed=0)
        k0, k1 = (1.0, 100.0) if solid == "fronts" else (0.0, 1.0)
        return heights / heights.std(), asp.solids.spring_lattice(k0=k0, k1=k1), load * (k0 + k1)
    if solid == "spike":
        heights = 0.01 * white
        heights[0, 0] = 50.0
        return heights, asp.solids.spring_lattice(k0=1.0, k1=27.0), 2.0 * size**2
    branches = [(0.08, time) for time in np.geomspace(1e-3, 1e6, 12)]
    heights = asp.surfaces.spectral((size, size), hurst=0.8, rms_slope=0.1, seed=0)
    return heights, asp.solids.half_space(modulus=1.0, branches=branches), 0.005 * 0.1 * size**2


class Transforms:
    """Counts the forward-and-back pairs of transforms of the lattice of a given number of sites."""

    def __init__(self, sites: int) -> None:
        self.double = self.single = 0.0
        import asperity as asp

        lattice = asp.lattice.Lattice
        for name in ("forward", "backward"):
            setattr(lattice, name, self.counted(getattr(lattice, name), sites))

    def counted(self, transform: Any, sites: int) -> Any:
        """The transform, counted; fields of several branches count as so many."""

        def counted(lattice: Any, array: Any, **options: Any) -> Any:
            if lattice.sites == sites:
                pairs = 0.5 * (len(array) if array.ndim > lattice.dimension else 1)
                if array.dtype.name in ("float32", "complex64"):
                    self.single += pairs
                else:
                    self.double += pairs
            return transform(lattice, array, **options)

        return counted


def measure(size: int, threads: int, rtol: float, kind: str) -> dict[str, Any]:
    """Age once for compilation (a small lattice), once for the time, and once at a tenth of the tolerance."""
    import numpy as np

    import asperity as asp

    times = np.geomspace(1e-3, 1e6, 37)
    settings = {"rtol": rtol, "exact": kind != "half_space_march"}
    os.environ["OMP_NUM_THREADS"] = str(threads)
    heights, solid, load = case(kind, 64)
    asp.age(asp.press(heights, solid, load=load), times[:3], **settings)
    heights, solid, load = case(kind, size)
    pairs(heights, 5, threads)
    transforms, count = pairs(heights, PAIRS // 2, threads), Transforms(heights.size)
    linear = [linear_step(size, times, settings)] if kind in LAWS else []
    marks = [time.perf_counter()]
    contact = asp.press(heights, solid, load=load)
    marks.append(time.perf_counter())
    count.double = count.single = 0.0
    data = asp.age(contact, times, **settings).dataset
    marks.append(time.perf_counter())
    counted = {"pairs_double": count.double, "pairs_single": count.single}
    transforms += pairs(heights, PAIRS - PAIRS // 2, threads)
    linear += [linear_step(size, times, settings)] if kind in LAWS else []
    settings["rtol"] = rtol / 10
    exact = asp.age(contact, times, **settings).dataset["area"].values
    area = data["area"].values
    steps = int((data["steps"] + data["rejected"]).sum())
    beside = {"linear_steps": (marks[2] - marks[1]) / steps / min(linear)} if linear else {}
    return {
        "solid": kind,
        "size": size,
        "rtol": rtol,
        "threads": threads,
        "press_seconds": marks[1] - marks[0],
        "age_seconds": marks[2] - marks[1],
        "pairs_seconds": transforms,
        "pairs": PAIRS * (marks[2] - marks[1]) / transforms,
        **counted,
        **beside,
        "steps": int(data["steps"].sum()),
        "iterations": int(data["iterations"].sum()),
        "residual": float(data["residual"].max()),
        "area_error": float(np.abs(area / exact - 1).max()),
        "area": [int(area[0]), int(area[-1])],
    }


def linear_step(size: int, times: Any, settings: dict[str, Any]) -> float:
    """Seconds of a step of linear creep, tried or taken, over the whole history."""
    import asperity as asp

    heights, solid, load = case("springs", size)
    contact = asp.press(heights, solid, load=load)
    begin = time.perf_counter()
    data = asp.age(contact, times, **settings).dataset
    return (time.perf_counter() - begin) / int((data["steps"] + data["rejected"]).sum())


def words(curve: dict[str, Any]) -> str:
    """One line about a curve."""
    if "failure" in curve:
        return f"{curve['solid']} at {curve['size']}^2, rtol {curve['rtol']:g}: {curve['failure']}"
    beside = f"a step costs {curve['linear_steps']:.2f} linear ones, " if "linear_steps" in curve else ""
    return (
        f"{curve['solid']}, nine decades at {curve['size']}^2, "
        f"rtol {curve['rtol']:g}: {curve['age_seconds']:.2f} s = "
        f"{curve['pairs']:.0f} pairs of transforms ({PAIRS} took {curve['pairs_seconds']:.2f} s); "
        f"{curve['pairs_double']:.0f} of its own and {curve['pairs_single']:.0f} in single precision, "
        f"{curve['steps']} steps, {curve['iterations']} iterations, residual {curve['residual']:.1e}, "
        f"{beside}area within {100 * curve['area_error']:.2f} % of a run at rtol / 10"
    )


def main() -> None:
    parser = running.parser(__doc__, threads=True)
    parser.add_argument("--sizes", type=int, nargs="+", default=[200, 1024])
    parser.add_argument("--rtols", type=float, nargs="+", default=list(RTOLS))
    kinds = ["springs", "line", "k0_zero", "spike", "fronts", "k0_zero_fronts"]
    kinds += ["half_space", "half_space_march", *LAWS]
    parser.add_argument("--solid", choices=kinds, default="springs")
    parser.add_argument("--json", action="store_true", help="measure here, and print numbers for programs")
    options = parser.parse_args()
    for size, rtol in itertools.product(options.sizes, options.rtols):
        if options.json:
            print(json.dumps(measure(size, options.threads, rtol, options.solid)), flush=True)
        else:
            print(words(run(size, options.threads, rtol, options.solid)), flush=True)


if __name__ == "__main__":
    main()
