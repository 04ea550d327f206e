"""Certify the answers of the reference problems, and write them into the package.

    python benchmarks/certify.py [NAME ...] [--scan FILE] [--out FOLDER]

Each answer is computed with time steps of the usual tolerance, a tenth and a hundredth of it, and by a second
solver that shares nothing with the first: on the lattice of springs `ActiveSet`, which works with transforms,
against `Multigrid`, which works with neighbors; on half-spaces Polonsky and Keer's conjugate gradients on the
pressures, in numpy alone (`polonsky_keer`), against `ActiveSet`, which works on the surface. Where the
surface is known between the sites the distance between them is halved twice. A separable half-space under a
constant load is marched, and solved without time steps too.

The error bar of a number is the sum of four parts: of the time steps, the largest difference between a tenth
and a hundredth of the tolerance (or between the march at a tenth and the exact contact) at this row and its
neighbors; of the solver, the difference between the two; of the lattice, the largest difference between the
finest and the one before, likewise; and half a site, or where it is larger 1e-8 of the value. Where the area
is kept, which the march does within 0.2 %, that replaces the last, and a twentieth of the tolerance counts
too. Where it slides, tolerances are a third and a tenth.
"""

from __future__ import annotations

import sys
import time
from importlib.resources import files
from pathlib import Path

import numpy as np
import running
import scipy
import scipy.fft

import asperity as asp
from asperity_research.challenge import NAMES, Problem, problem, solve
from asperity_research.challenge.posing import PARTS

USUAL = 2e-3
ROUNDING = 1e-8
KEPT = 2e-3
"""Largest relative error of an area that is kept; the load goes with it."""
HALVINGS = 2
PENETRATION = 1e-12
DATA = Path(str(files("asperity_research.challenge") / "data"))


def polonsky_keer(heights, spacing, modulus, load):
    """Pressures of an elastic half-space on periodic heights, and the gap, by gradients on the pressures.

    I. A. Polonsky, L. M. Keer, Wear 231, 206 (1999), DOI 10.1016/S0043-1648(99)00113-1; periodic, as H. M.
    Stanley and T. Kato, J. Tribol. 119, 481 (1997). Stops where gaps in contact stray by less than 1e-12 of
    the relief.
    """
    rows, columns = heights.shape
    q = np.hypot(
        2 * np.pi * np.fft.fftfreq(rows, spacing[0])[:, None],
        2 * np.pi * np.fft.rfftfreq(columns, spacing[1]),
    )
    compliance = np.divide(2.0, modulus * q, out=np.zeros_like(q), where=q > 0)

    def displaced(field):
        return scipy.fft.irfft2(scipy.fft.rfft2(field) * compliance, s=field.shape)

    mean = load / (heights.size * spacing[0] * spacing[1])
    p, t = np.full(heights.shape, mean), np.zeros(heights.shape)
    relief, norm_before, restart = float(np.ptp(heights)), 1.0, True
    for _ in range(100_000):
        # Pressure pushes the solid off the heights: the gap is what it is displaced less the heights.
        gap = displaced(p) - heights
        touching = p > 0
        gap -= gap[touching].mean()
        stray = np.abs(gap[touching]).max()
        if stray < PENETRATION * relief and gap.min() > -PENETRATION * relief:
            gap -= gap[touching].mean()
            return p, gap
        norm = float((gap[touching] ** 2).sum())
        t = np.where(touching, gap + (0.0 if restart else norm / norm_before) * t, 0.0)
        norm_before = norm
        r = displaced(t)
        r -= r[touching].mean()
        step = float((gap[touching] * t[touching]).sum() / (r[touching] * t[touching]).sum())
        p = np.where(touching, p - step * t, p)
        p[p < 0] = 0.0
        overlapping = (p == 0) & (gap < 0)
        restart = bool(overlapping.any())
        p[overlapping] -= step * gap[overlapping]
        p *= mean / p.mean()
    raise RuntimeError("conjugate gradients on the pressures did not converge")


def creep(branches, times):
    """Creep compliance of a generalized Maxwell solid times its modulus at once, from poles of 1/(s E(s)).

    E(s) is the operator modulus over that at once, 1 - sum of g / (1 + s tau): a ratio of polynomials.
    """
    shares, taus = np.transpose(branches)
    p = np.polynomial.Polynomial([1.0])
    for tau in taus:
        p *= np.polynomial.Polynomial([1.0, tau])
    stiffness = p
    for k, share in enumerate(shares):
        others = np.polynomial.Polynomial([1.0])
        for tau in np.delete(taus, k):
            others *= np.polynomial.Polynomial([1.0, tau])
        stiffness = stiffness - share * others
    # J(s) = p(s) / (s stiffness(s)).
    result = np.full(len(times), p(0.0) / stiffness(0.0))
    for root in stiffness.roots():
        result += p(root) / (root * stiffness.deriv()(root)) * np.exp(root * np.asarray(times))
    return result


def by_pressures(asked: Problem, surface, times, loads) -> dict:
    """The same table, in numpy alone: an elastic contact at the load that creep makes of the true one."""
    config = asked.config
    heights, spacing = surface.in_meters()
    branches = config.solid.build().parameters["branches"]
    effective = np.asarray(loads) * (creep(branches, times) if branches else 1.0)
    area, gap = [], []
    for load in effective:
        p, g = polonsky_keer(heights, spacing, config.solid.modulus, load)
        area.append(np.count_nonzero(p) * spacing[0] * spacing[1])
        gap.append(g.mean())
    return {"contact_area": np.array(area), "mean_gap": np.array(gap)}


def neighbors(values):
    """Largest of each value and those beside it."""
    padded = np.pad(values, 1, mode="edge")
    return np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])


def certify(asked: Problem, scan: Path | None) -> tuple[dict, dict, dict, list[str]]:
    """Values, parts of the bars and floors by heading; and what was done."""
    base = {"scan": scan} if asked.heights["rule"] == "scan" else {}
    usual = solve(asked, **base)
    headings = [column.heading for column in asked.asked]
    parts = {heading: dict.fromkeys(PARTS, 0.0) for heading in headings}
    did = []
    if asked.config.solid.kind == "spring_lattice":
        legs = asked.run.get("protocol", ())
        factors = [10, 100]
        if any(leg["kind"] == "slide" for leg in legs):
            factors = [3, 10]
        if any(leg.get("hold") == "area" for leg in legs):
            factors = [10, 20, 100]  # late loads scatter from tolerance to tolerance
        *coarser, finest = (solve(asked, rtol=USUAL / factor, **base) for factor in factors)
        other = solve(asked, solver=asp.ActiveSet(), **base)
        values = finest
        for heading in headings:
            apart = [np.abs(one[heading] - finest[heading]) for one in coarser]
            parts[heading]["time"] = neighbors(np.max(apart, axis=0))
            parts[heading]["solver"] = np.abs(other[heading] - usual[heading])
        said = ", ".join(f"{USUAL / factor:.1g}" for factor in sorted({1, *factors}))
        did.append(f"rtol {said}; Multigrid against ActiveSet")
    else:
        lattices = [usual]
        if asked.continuous:
            lattices += [solve(asked, halvings=n + 1, **base) for n in range(HALVINGS)]
        values = lattices[-1]
        if asked.config.solid.build().branches:
            marched = solve(asked, rtol=USUAL / 10, exact=False, **base)
            for heading in headings:
                parts[heading]["time"] = neighbors(np.abs(marched[heading] - usual[heading]))
            did.append("exact contact against a march at rtol 2e-4")
        surface = asked.surface(**base)
        times = np.asarray(asked.config.aging.times)
        pressed = asked.config.contact
        loads = usual["load_N"] if "load_N" in usual else np.full(times.shape, _load(pressed, surface))
        other = by_pressures(asked, surface, times, loads)
        first = _counted(asked, base)
        for column in asked.asked:
            parts[column.heading]["solver"] = np.abs(first[column.name] - other[column.name])
            if asked.continuous:
                apart = np.abs(lattices[-1][column.heading] - lattices[-2][column.heading])
                parts[column.heading]["lattice"] = neighbors(apart)
        did.append("ActiveSet against conjugate gradients on the pressures")
        if asked.continuous:
            sites = len(surface.heights)
            did.append(f"lattices of {', '.join(f'{sites * 2**n}^2' for n in range(HALVINGS + 1))} sites")
    for heading in headings:
        apart = np.abs(usual[heading] - values[heading]).max()
        did.append(f"{heading} at the usual tolerance and lattice: {apart:.2g} off at most")
    return values, parts, _floors(asked, values, base), did


def _floors(asked: Problem, values: dict, base: dict) -> dict:
    """What an error bar is at least."""
    floors = {}
    for column in asked.asked:
        half = 0.5 if column.unit == "sites" else 0.0
        if column.name == "contact_area":
            cell = np.prod(asked.surface(halvings=HALVINGS * asked.continuous, **base).in_meters()[1])
            half = 0.5 * float(cell)
        if any(leg.get("hold") == "area" for leg in asked.run.get("protocol", ())):
            half = KEPT * np.abs(values[column.heading])
        size = np.abs(values[column.heading])
        floors[column.heading] = np.maximum(ROUNDING * np.where(size > 0, size, size.max()), half)
    return floors


def _load(pressed, surface):
    spacing = surface.in_meters()[1]
    nominal = surface.heights.size * spacing[0] * spacing[1]
    return pressed.load if pressed.load is not None else pressed.pressure * nominal


def _counted(asked: Problem, base: dict) -> dict:
    """The usual answer on the given lattice, with the area as it is counted."""
    config = asked.config
    contact = asp.press(asked.surface(**base), config.solid.build(), **config.contact.table)
    times = np.asarray(config.aging.times)
    data = asp.age(contact, times, protocol=asked.legs or None).dataset
    rows = np.searchsorted(data["time"].values, times, side="right") - 1
    return {name: data[name].values[rows] for name in ("contact_area", "mean_gap")}


def table(asked: Problem, scan: Path | None) -> str:
    """The CSV file of an answer."""
    values, parts, floors, did = certify(asked, scan)
    columns = {asked.abscissa.heading: [f"{x:.12g}" for x in values[asked.abscissa.heading]]}
    for column in asked.asked:
        name = column.heading
        rows = np.zeros(len(values[name]))
        bar = rows + floors[name] + sum(parts[name].values())
        whole = column.unit == "sites"
        columns[name] = [f"{x:.0f}" if whole else f"{x:.10g}" for x in values[name]]
        columns[f"{name}_bar"] = [f"{x:.3g}" for x in bar]
        for part in PARTS:
            if np.any(parts[name][part]):
                columns[f"{name}_{part}"] = [f"{x:.3g}" for x in rows + parts[name][part]]
    lines = [
        f"# problem: {asked.name}",
        f"# made by: python benchmarks/certify.py {asked.name}",
        f"# with Asperity {asp.__version__}, NumPy {np.__version__}, SciPy {scipy.__version__}",
        *(f"# {line}" for line in did),
        ",".join(columns),
        *(",".join(row) for row in zip(*columns.values(), strict=True)),
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = running.parser(__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", default=list(NAMES), help=", ".join(NAMES))
    parser.add_argument("--scan", type=Path, help="the file of the measured problem, which else is left out")
    parser.add_argument("--out", type=Path, default=DATA, help="folder for the answers")
    options = parser.parse_args()
    for name in options.names:
        asked = problem(name)
        if asked.heights["rule"] == "scan" and options.scan is None:
            print(f"{name}: left out, as no --scan names {asked.heights['file']}", file=sys.stderr)
            continue
        begun = time.perf_counter()
        text = table(asked, options.scan)
        (options.out / f"{name}.csv").write_text(text, encoding="utf-8")
        print(f"{name}: {time.perf_counter() - begun:.0f} s\n{text}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
