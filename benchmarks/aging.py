"""Time nine decades of aging against the lattice's own Fourier transforms.

Prints, for each size: seconds, time steps, conjugate-gradient iterations, the worst residual, and the
cost in forward-and-back pairs of transforms of that size, timed in the same run on the same thread.
The last column should not grow with the lattice.

    python benchmarks/aging.py [--sizes 100 200 400]
"""

import argparse
import time

import numpy as np
import scipy.fft

import asperity as asp


def pair_seconds(shape, repeats=30):
    """Median time of one forward-and-back pair."""
    field = np.random.default_rng(0).normal(size=shape)
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        scipy.fft.irfftn(scipy.fft.rfftn(field), s=shape)
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 200, 400])
    sizes = parser.parse_args().sizes
    print("size   sites      press s  age s    relax s  steps  iterations  residual  pairs of transforms")
    for n in sizes:
        rough = asp.surfaces.gaussian((n, n), seed=0)
        solid = asp.solids.spring_lattice(k0=1.0, k1=3.0)
        marks = [time.perf_counter()]
        contact = asp.press(rough, solid, load=0.02 * n * n)
        marks.append(time.perf_counter())
        data = asp.age(contact, np.geomspace(1e-3, 1e6, 37)).dataset
        marks.append(time.perf_counter())
        asp.relax(contact)
        marks.append(time.perf_counter())
        press, age, relax = np.diff(marks)
        print(
            f"{n:<6} {n * n:<10} {press:<8.3f} {age:<8.2f} {relax:<8.3f} {int(data['steps'].sum()):<6} "
            f"{int(data['iterations'].sum()):<11} {float(data['residual'].max()):<9.1e} "
            f"{age / pair_seconds((n, n)):.0f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
