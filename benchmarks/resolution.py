"""What a lattice resolves: the same surface and load on finer and finer lattices.

A band-limited surface (Hurst exponent 0.8, shortest wave of 1/16 of the side) is sampled exactly on
lattices of 2 to 32 sites per shortest wave, pressed by the same half-space under the same pressure, and aged.
The last table is of the lattice of springs: how much one surface of n x n sites tells of all of them. The
first is of power laws in time: errors of J, which is t^n / (G1 Gamma(1 + n) Gamma(1 - n)), and of areas.
Prints the tables of docs/units.md; `--quick` leaves out the largest lattices, and most exponents.
"""

import numpy as np
import running
from running import head, line
from scipy.special import gamma

import asperity as asp

SIDE, WAVES = 1.0, 16  # length of a side; shortest wave is a sixteenth of it
BRANCHES = [(0.1, 10.0**power) for power in (0, 1, 2)]
SITES = (2, 4, 8, 16, 32)  # per shortest wave
EXPONENTS = (0.05, 0.5, 0.95, 0.1, 0.2, 0.3, 0.7, 0.9)
SIDES = (32, 64, 128, 256, 512)  # of the lattice of springs


def sampled(sites):
    """The surface on `sites` sites a shortest wave: its Fourier modes are the same on every lattice."""
    coarse = 4 * WAVES
    heights = asp.surfaces.spectral(
        (coarse, coarse), hurst=0.8, cutoff=SIDE / WAVES, rms_slope=0.1, spacing=SIDE / coarse, seed=1
    )
    fine = max(SITES) * WAVES
    modes = np.zeros((fine, fine), complex)
    rows = np.fft.fftfreq(coarse, 1 / coarse).astype(int)
    modes[np.ix_(rows, rows)] = np.fft.fft2(heights) * (fine / coarse) ** 2
    step = max(SITES) // sites
    return np.fft.ifft2(modes).real[::step, ::step].copy()


def row(sites, pressure=0.005):
    """Contact fraction raw and corrected for pixel rims, largest pressure, growth over the decades."""
    heights = sampled(sites)
    spacing = SIDE / len(heights)
    surface = asp.surfaces.Surface(heights, unit="m", pixel_size=(spacing, spacing), length_unit="m")
    solid = asp.solids.half_space(modulus=1.0, branches=BRANCHES)
    contact = asp.press(surface, solid, pressure=pressure)
    last = asp.age(contact, [1e-2, 1e3]).final
    corrected = contact.contact_area_corrected / SIDE**2
    return (
        contact.contact_fraction,
        corrected,
        contact.largest_pressure,
        last.area / contact.area,
        last.contact_area_corrected / contact.contact_area_corrected,
    )


def spread(side, seeds=8):
    """Of Gaussian heights on springs: contact fraction and growth in nine decades, means and scatter."""
    found = []
    for seed in range(seeds):
        heights = asp.surfaces.gaussian((side, side), rms=1.0, seed=seed)
        solid = asp.solids.spring_lattice(k0=1.0, k1=3.0, R=1.0)
        contact = asp.press(heights, solid, load=0.02 * heights.size)
        found.append((contact.contact_fraction, asp.age(contact, [1e6]).final.area / contact.area))
    mean, scatter = np.mean(found, axis=0), np.std(found, axis=0, ddof=1)
    return mean, scatter / mean


def of_a_power(exponent, accuracy):
    """Largest errors, over six decades, of J by Prony series, and of a rough half-space's area under it."""
    series = asp.relaxation.power_law(
        modulus=1.0, exponent=exponent, time=1.0, first=1.0, last=1e6, accuracy=accuracy
    )
    times = np.geomspace(1.0, 1e6, 400)
    ratio = series.compliance_at(times) * gamma(1 + exponent) * gamma(1 - exponent) / times**exponent
    heights = asp.surfaces.spectral((128, 128), roll_off=32.0, cutoff=8.0, rms_height=1.0, seed=2)
    solid = asp.solids.half_space(modulus=1.0)
    exact, *areas = [asp.press(heights, solid, load=1500.0 * one).area for one in (1.0, *ratio[[0, 66, 200]])]
    return np.abs(ratio - 1).max(), np.abs(np.array(areas) / exact - 1).max()


def tables(quick=False):
    """The lines of the tables."""
    yield from head("n", "1 %: J", "area", "0.1 %: J", "area")
    for exponent in sorted(EXPONENTS[: 3 if quick else None]):
        errors = (*of_a_power(exponent, 1e-2), *of_a_power(exponent, 1e-3))
        yield line(exponent, *(f"{error:.2%}" for error in errors))
    yield ""
    yield from head("pixels", "lattice", "raw", "corrected", "p / E\\*", "growth", "corrected")
    for sites in SITES[: 3 if quick else None]:
        *fractions, largest, grown, corrected = row(sites)
        areas = (f"{one:.4f}" for one in fractions)
        yield line(sites, f"{sites * WAVES}²", *areas, *(f"{one:.3f}" for one in (largest, grown, corrected)))
    yield ""
    yield from head("lattice", "contact", "scatter", "growth", "scatter")
    for side in SIDES[: 2 if quick else None]:
        mean, scatter = spread(side)
        yield line(f"{side}²", f"{mean[0]:.4f}", f"{scatter[0]:.1%}", f"{mean[1]:.3f}", f"{scatter[1]:.1%}")


def main():
    """Print the tables."""
    parser = running.parser(__doc__)
    parser.add_argument("--quick", action="store_true")
    for text in tables(parser.parse_args().quick):
        print(text)


if __name__ == "__main__":
    main()
