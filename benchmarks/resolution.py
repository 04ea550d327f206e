"""What a lattice resolves: the same surface and load on finer and finer lattices.

A band-limited surface (Hurst exponent 0.8, shortest wave of 1/16 of the side) is sampled exactly on
lattices of 2 to 32 sites per shortest wave, pressed by the same half-space under the same pressure, and aged.
The second table is of the lattice of springs: how much one surface of n x n sites tells of all of them.
Prints the tables of docs/units.md; `--quick` leaves out the largest lattices.
"""

import numpy as np
import running
from running import head, line

import asperity as asp

SIDE, WAVES = 1.0, 16  # length of a side; shortest wave is a sixteenth of it
BRANCHES = [(0.1, 10.0**power) for power in (0, 1, 2)]
SITES = (2, 4, 8, 16, 32)  # per shortest wave
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


def tables(quick=False):
    """The lines of both tables."""
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
