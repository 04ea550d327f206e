"""How often the band over acceptable models contains a curve beyond its data: a logarithm, 20 seeds.

``python benchmarks/extrapolation.py [SEEDS]`` infers 28 areas from 1 s to 20,000 s with 2 % of noise by
relaxation times, and compares the band at 1e5 s and 1e9 s with the logarithm that made them.
"""

import sys

import numpy as np

import asperity as asp

TIME, LATER = np.geomspace(1, 2e4, 28), np.array([2e4, 1e5, 1e9])


def area(time):
    return 0.034 * (1 + 0.06 * np.log10(1 + time / 0.5))


def main(seeds):
    inside = np.zeros((3, 2), dtype=int)
    print("seed  " + "  ".join(f"{'truth':>7} {'chosen':>16} {'band':>16}  {t:.0e} s" for t in LATER))
    for seed in range(seeds):
        noise = 1 + 0.02 * np.random.default_rng(seed).standard_normal(TIME.size)
        found = asp.infer(TIME, area(TIME) * noise)
        truth, band, own = area(LATER), found.predicted(LATER), found.rivals[0].band(LATER)
        inside += np.stack([(one[0] < truth) & (truth < one[2]) for one in (own, band)], -1)
        cells = zip(truth, own.T, band.T, strict=True)
        said = (
            f"{1e3 * x:7.2f} {1e3 * o[0]:7.2f} {1e3 * o[2]:8.2f} {1e3 * b[0]:7.2f} {1e3 * b[2]:8.2f}"
            for x, o, b in cells
        )
        print(f"{seed:4}  " + "  ".join(said), "|", "; ".join(found.sentences[1:4]), flush=True)
    for t, (own, band) in zip(LATER, inside, strict=True):
        print(f"{t:.0e} s: chosen model {own} of {seeds}, band over acceptable models {band} of {seeds}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
