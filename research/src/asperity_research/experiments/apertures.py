"""Apertures of a rock fracture: read from a picture by its color bar, or from a file of numbers.

A picture shows at each pixel the color that the bar has at the aperture there. Neighboring pixels of a finer
field are blended, at steep edges into colors that the bar does not have: these are undefined.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import numpy as np
from matplotlib.image import imread
from scipy.optimize import root
from scipy.spatial import cKDTree

import asperity as asp
from asperity.errors import InputError
from asperity_research.arrays import Field, Mask

_COLORED = 40.0  # Of 255: range of the channels from which on a pixel has a color
_DARK = 100.0  # Least channel of what is no background
_OFF_BAR = 10.0  # Distance of a color from the bar beyond which it is a blend


@dataclass(frozen=True, eq=False)
class Aperture:
    """The distance of two faces that are held as they were scanned.

    Attributes
    ----------
    distance
        Of the faces, m, shape (n, m); NaN where it is unknown or there is no body.
    pixel
        Distance of rows and of columns, m.
    end
        Distance from which on there is no face, m: the end of the color bar.
    """

    distance: Field
    pixel: tuple[float, float]
    end: float

    @property
    def body(self) -> Mask:
        """Where there are two faces, shape (n, m)."""
        return np.nan_to_num(self.distance, nan=self.end) < self.end

    @property
    def places(self) -> Field:
        """Rows and columns from the middle of the body, m, shape (2, n, m)."""
        at = np.indices(self.distance.shape) * np.reshape(self.pixel, (2, 1, 1))
        return np.asarray(at - at[:, self.body].mean(axis=1)[:, np.newaxis, np.newaxis])

    def coarser(self, pixel: float) -> Self:
        """Means over squares of about that many meters."""
        n = max(1, round(pixel / self.pixel[0]))
        rows, columns = (size // n for size in self.distance.shape)
        squares = self.distance[: rows * n, : columns * n].reshape(rows, n, columns, n)
        means = np.ma.masked_invalid(squares).mean(axis=(1, 3)).filled(np.nan)
        return replace(self, distance=means, pixel=(self.pixel[0] * n, self.pixel[1] * n))

    def tilted(self, slopes: Field) -> Self:
        """The same with one face turned by two slopes, along rows and along columns."""
        turned = self.distance + np.tensordot(slopes, self.places, 1)
        return replace(self, distance=np.where(self.body, turned, np.nan))

    @property
    def surface(self) -> asp.surfaces.Surface:
        """A rough surface for one flat half-space: both faces on it, which ends where the body ends."""
        depth = np.where(self.body, self.distance, 2 * self.end)
        return asp.surfaces.Surface(-depth, "m", self.pixel, "m", edges="free")

    def leveling(self, modulus: float, load: float) -> Field:
        """Slopes by which one face turns until an elastic contact has no moment, shape (2,)."""
        solid, radius = asp.solids.half_space(modulus=modulus), float(np.ptp(self.places[0][self.body])) / 2

        def moments(slopes: Field) -> Field:
            force = asp.press(self.tilted(1e-3 * slopes).surface, solid, load=load).pressure
            return np.asarray((self.places * force).sum(axis=(1, 2)) / (force.sum() * radius))

        balance = root(moments, np.zeros(2), options={"eps": 0.1, "xtol": 1e-3})
        if not balance.success:
            raise InputError("apertures", expected="faces that turn until no moment is left", got="none")
        return np.asarray(1e-3 * balance.x)


def of_picture(path: Path, width: float, height: float, end: float) -> Aperture:
    """Read a picture of a field of that many meters with a vertical bar on its right, from 0 to an end.

    `InputError` for a file that is no such picture.
    """
    try:
        pixels = 255.0 * np.atleast_3d(imread(path))[:, :, :3]
    except (OSError, SyntaxError):
        raise InputError(str(path), expected="a picture", got="none that can be read") from None
    colored = np.ptp(pixels, axis=2) > _COLORED
    columns = np.flatnonzero(colored.sum(axis=0) > 0.1 * len(pixels))
    gaps = np.flatnonzero(np.diff(columns) > 1)
    if gaps.size != 1:
        got = f"{gaps.size + bool(columns.size)} colored parts side by side"
        raise InputError(str(path), expected="a field and, on its right, a color bar", got=got)
    left, right = columns[0], columns[gaps[0]] + 1
    share = colored[:, left:right].mean(axis=1)
    rows = np.flatnonzero(share > share.max() / 2)
    strip = pixels[:, (columns[gaps[0] + 1] + columns[-1]) // 2]
    ends = np.flatnonzero(strip.min(axis=1) < _DARK)[[0, -1]]  # The frame, whose middle is the end of the bar
    inside = np.arange(ends[0] + 1, ends[1])
    off, nearest = cKDTree(strip[inside]).query(pixels[rows[0] : rows[-1] + 1, left:right])
    distance = end * (ends[1] - inside[nearest]) / (ends[1] - ends[0])
    distance[nearest == 0] = end  # The color of the end stands for all beyond it, too
    pixel = (height / len(distance), width / distance.shape[1])
    return Aperture(np.where(off > _OFF_BAR, np.nan, distance), pixel, end)


def of_file(path: Path, end: float) -> Aperture:
    """Read distances with a unit from any file of heights; or NAME.Z.txt in m, beside its X and Y.

    Undefined pixels are no body. `InputError` where there is no unit, or nothing is nearer than the end.
    """
    axes: list[Field] = []
    if path.name.endswith(".Z.txt"):
        beside = [path.with_name(path.name.replace(".Z.txt", f".{axis}.txt")) for axis in "YX"]
        axes = [np.loadtxt(file).ravel() for file in beside if file.is_file()]
    lengths: dict[str, Any] = {}
    if len(axes) == 2:
        steps = [float(np.diff(places).mean()) for places in axes]
        lengths = {"file_unit": "m", "pixel_size": steps, "length_unit": "m"}
    read = asp.surfaces.read(path, tilt="none", periodic="free", max_undefined=0.9, **lengths)
    if not read.has_lengths:
        advice = "NAME.Z.txt in m beside NAME.X.txt and NAME.Y.txt, or a format that states units"
        expected = "apertures and pixels with a unit of length"
        raise InputError(str(path), expected=expected, got="none", advice=advice)
    if lengths and read.heights.shape != tuple(places.size for places in axes):
        expected = (
            " by ".join(str(places.size) for places in axes) + " apertures, as its Y and X have numbers"
        )
        raise InputError(str(path), expected=expected, got=" by ".join(map(str, read.heights.shape)))
    distance, pixel = read.in_meters()
    if read.filled is not None:
        distance = np.where(read.filled, np.nan, distance)
    aperture = Aperture(np.asarray(distance), (pixel[0], pixel[1]), end)
    if aperture.body.mean() < 0.1:
        got = f"{100 * aperture.body.mean():.3g} % of them"
        raise InputError(str(path), expected=f"apertures below {1e3 * end:g} mm", got=got)
    return aperture
