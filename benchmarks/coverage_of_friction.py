"""Measure how often 95 % intervals of `asperity.friction.rate_and_state` hold the truth.

    python benchmarks/coverage_of_friction.py [--records 500] [--out FILE] [steps] [holds] [both] [normal]

Each record has parameters of its own, drawn at random, and is fitted by the law that made it, with a fitted
stiffness. Friction has noise of 4e-4, white in even records and with neighbors that correlate by 0.45 in
odd ones, and a drift; the load point has noise of 3 % of D_c. A line of FILE is a fit: case, law, number of
the record, then value, low, high and truth of each parameter; a record that is there is not fitted again.
"""

from __future__ import annotations

import csv
import itertools
from pathlib import Path

import numpy as np
import running
from scipy.signal import lfilter

import asperity as asp
from asperity.errors import InputError
from asperity.friction.loading import Drive
from asperity.friction.normal_stress import NormalStress
from asperity.friction.slider import Shape, follow

F, UM = asp.friction, 1e-6
NAMES = ("a", "b", "D_c", "stiffness", "alpha")
NOISE, RHO = 4e-4, 0.45
CASES = {
    "steps": ([1, 10, 1], [40, 10, 60]),
    "holds": ([10, 0, 10, 0, 10, 0, 10], [10, 3, 15, 60, 15, 1000, 15]),
    "both": ([1, 10, 0, 10, 1, 0, 1], [30, 10, 30, 10, 40, 300, 40]),
    "normal": ([1, 10], [40, 70]),
}
"""Velocities of the load point, over D_c/10 s, and how long each lasts (s)."""
STRESS = [0, 60, 60.1, 85, 85.1, 110], [50, 50, 52.5, 52.5, 50, 50]
"""Normal stress (MPa) at times (s)."""


def made(case: str, law: F.laws.StateLaw, number: int) -> tuple[F.Record, Shape]:
    """A record with noise, and its parameters, k that of the mean normal stress."""
    rng = np.random.default_rng([number, *f"{case} {law}".encode()])
    speeds, lasts = (np.array(numbers, dtype=float) for numbers in CASES[case])
    a, part, D_c, stiff = rng.uniform([0.006, 0.8, 5, 3], [0.012, 1.4, 20, 15])
    shape = Shape(a, part * a, D_c * UM, stiff * a / (D_c * UM), rng.uniform(0.1, 0.4) * (case == "normal"))
    ends = np.append(0.0, np.cumsum(lasts))
    drive = Drive(ends[1:-1], D_c / 10 * UM * speeds, np.full(lasts.size - 1, 0.1))
    # Rows each 0.1 s, at random beside the kinks, and each second from 10 s of a hold on.
    time = np.append(0.0, np.arange(rng.uniform(0.05, 0.1), ends[-1], 0.1))
    part_of = np.searchsorted(ends[1:-1], time, "right")
    late = (speeds[part_of] == 0) & (time - ends[part_of] > 10)
    time = time[~late | (np.arange(time.size) % 10 == 0)]
    sigma = np.interp(time, *STRESS) if case == "normal" else np.ones(time.size)
    normal = NormalStress(np.array(STRESS[0]), STRESS[1] / sigma.mean(), 0.6) if case == "normal" else None
    elastic, place = follow(law, shape, drive, time, normal=normal).elastic(shape), drive.place(time)
    noise, load_point, pressed = rng.standard_normal((3, time.size))
    if number % 2:
        noise = lfilter([np.sqrt(1 - RHO**2)], [1, -RHO], noise)
    friction = 0.6 + elastic + NOISE * noise + 1e-6 * place / UM
    about = {"normal": sigma / sigma.mean() * (1 + 2e-4 * pressed)} if normal else {}
    place = place + 0.03 * shape.D_c * load_point
    return F.Record.of_machine(time, friction, load_point=place, units=("s", "um"), **about), shape


def fitted(case: str, law: F.laws.StateLaw, number: int) -> list[float]:
    """Value, low, high and truth of each parameter; nothing if the record is refused."""
    record, truth = made(case, law, number)
    try:
        fit = F.rate_and_state(record, law=law, stiffness="fit")
    except InputError as error:
        print(case, law, number, error, flush=True)
        return []
    names = NAMES[: 4 + (case == "normal")]
    ends = [
        (getattr(fit, name), *fit.interval(name), value) for name, value in zip(names, truth, strict=False)
    ]
    return np.array(ends).ravel().tolist()


def main() -> None:
    """Fit one record of each case after the other, and print how often the intervals hold the truth."""
    parser = running.parser(__doc__)
    parser.add_argument("cases", nargs="*", default=[], choices=[[], *CASES])
    parser.add_argument("--records", type=int, default=500)
    parser.add_argument("--out", type=Path, default=Path("coverage_of_friction.csv"))
    asked = parser.parse_args()
    asked.out.touch()
    with asked.out.open(newline="") as stream:
        found = {tuple(row[:3]): row[3:] for row in csv.reader(stream)}
    cases = [*itertools.product(asked.cases or CASES, F.laws.STATE_LAWS)]
    with asked.out.open("a", newline="", buffering=1) as stream:
        for number, (case, law) in itertools.product(range(asked.records), cases):
            if (key := (case, law, str(number))) not in found:
                found[key] = fitted(case, law, number)
                csv.writer(stream).writerow([*key, *found[key]])
    print(*running.head("case", "law", "noise", "records", "refused", *NAMES), sep="\n")
    for case, law, odd in itertools.product(asked.cases or CASES, F.laws.STATE_LAWS, (0, 1)):
        rows = [row for key, row in found.items() if key[:2] == (case, law) and int(key[2]) % 2 == odd]
        fits = np.array([row for row in rows if row], dtype=float).reshape(-1, 4 + (case == "normal"), 4)
        held = 100 * ((fits[..., 1] <= fits[..., 3]) & (fits[..., 3] <= fits[..., 2])).mean(axis=0)
        noise = "correlated" if odd else "white"
        print(running.line(case, law, noise, len(rows), len(rows) - len(fits), *held.round(1)))


if __name__ == "__main__":
    main()
