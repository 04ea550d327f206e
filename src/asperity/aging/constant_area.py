r"""Choose the load so that the contact area stays what it was, as experiments at constant area do.

Near one state the area A follows the load F and the time t since the beginning of the leg as

    ln A = ln F + G ln(t + s) + constant,

for it is nearly proportional to the load, and grows like the logarithm of time. The growth G is measured in
earlier time steps; the load of the next one is that with which its end has the wanted area. A time step that
misses it is repeated with a better load. s is the end of the first time step. In a time step that is short in
ln t one site more or less is more than growth adds. So G is a mean over a lapse of ln t, and
an error of the area is corrected over one too: a load that followed every site would itself make the errors
by which time steps are shortened. (T. Pilvelait, S. Dillavou,
S. M. Rubinstein, Phys. Rev. Research 2, 012056 (2020), measure at constant area; DOI
10.1103/PhysRevResearch.2.012056.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from asperity.contact.controls import Course, Load


@dataclass(frozen=True)
class Tuning:
    """Numbers chosen by measurement."""

    largest_change: float = 0.05
    """Largest change of ln F in one step, at first."""

    allowed: float = 0.002
    """Largest relative error of the area that no repetition corrects, over the part of the lapse in a step.

    One site is allowed in any case.
    """

    lapse: float = 0.1
    """Lapse of ln t over which the area is corrected and growth is averaged, and to which steps may shrink.

    Of few contacts one more or less is no growth to follow.
    """

    weight: float = 0.5
    """Largest weight of one step in the growth."""

    fewest_sites: int = 20
    """Sites in contact of which the area can be kept: of fewer, one site is too large a part.

    12 were enough in every case tried, 3 were not.
    """


TUNING = Tuning()


@dataclass
class ConstantArea:
    """The load of the next step, after the last one ended at a time, a load and an area, sites.

    ``growth`` and ``since`` are G and s; ``correction`` is what a repetition added to the change of ln F in
    this step, and ``gain`` the part of what the area is off that it corrects.
    """

    wanted: float
    time: float
    load: float
    area: float
    growth: float = 0.0
    since: float = 0.0
    correction: float = 0.0
    repeated: bool = False
    gain: float = 1.0

    def load_for(self, length: float) -> Load:
        """The load, linear in time, for a step of a length."""
        lapse = self._lapse(length)
        self.gain = min(1.0, lapse / TUNING.lapse) if self.since else 1.0
        change = self.gain * math.log(self.wanted / max(self.area, 1.0)) - self.growth * lapse
        change = min(max(change, -TUNING.largest_change), TUNING.largest_change) + self.correction
        begun, load, rate = self.time, self.load, self.load * math.expm1(change) / length
        return Load(load, Course(lambda time: load + rate * (time - begun), length))

    def longest(self) -> float:
        """Longest next step, so that the load changes little."""
        if self.since == 0 or self.growth == 0:
            return math.inf
        # At most 50, as expm1 would overflow where hardly anything grows.
        lapse = min(max(TUNING.largest_change / abs(self.growth), TUNING.lapse), 50.0)
        return (self.time + self.since) * math.expm1(lapse)

    def misses(self, area: int) -> bool:
        """Whether a step that ends with this area is to be repeated, once; then the next load is better."""
        off, allowed = abs(area - self.wanted), max(1.0, TUNING.allowed * self.wanted)
        if off * self.gain <= allowed or self.repeated:
            return False
        self.repeated = True
        self.correction = self.gain * math.log(self.wanted / max(area, 1))
        return True

    def begin_step(self) -> None:
        """Begin a step of another length."""
        self.correction, self.repeated = 0.0, False

    def accept(self, time: float, area: int, reached: float) -> None:
        """Update the growth G, and begin at the end of a step that was taken, at the load that it reached."""
        lapse = self._lapse(time - self.time)
        if lapse > 0:
            shown = (math.log(max(area, 1) / max(self.area, 1.0)) - math.log(reached / self.load)) / lapse
            weight = min(TUNING.weight, lapse / TUNING.lapse) if self.growth else 1.0
            self.growth += weight * (shown - self.growth)
        self.since = self.since or time
        self.time, self.load, self.area = time, reached, float(area)
        self.begin_step()

    def _lapse(self, length: float) -> float:
        return math.log1p(length / (self.time + self.since)) if self.since else 0.0
