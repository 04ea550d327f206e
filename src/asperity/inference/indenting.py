"""Records of indenters and AFM: time, depth and force, with their signs, segments and contact point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.base import checks, views
from asperity.base import units as si
from asperity.base.checks import Floats
from asperity.base.rows import Row
from asperity.errors import InputError
from asperity.sheets.columns import TIME, Chosen, Columns, Role, Units, named
from asperity.sheets.tables import read_table

ROLES = (
    Role(
        "",
        "",
        r"segment|cycle|index|volt|temp(?!s\b)|humid|stiff|modul|speed|veloc|\bstd|\berr|set ?point"
        r"|lateral|friction|cantilever disp|\bmax|residual|contact depth|chang",
    ),
    TIME,
    Role("deflection", "m", r"deflec|\bdefl|auslenk|durchbieg|deviation"),
    Role("tip position", "m", r"tip ?(pos|sample|height)|\btss?\b|separation|abstand"),
    Role("height", "m", r"height|piezo|z ?se?nso?r|\bzsnsr|hohe|hauteur|position|stage|^z$"),
    Role(
        "depth",
        "m",
        r"depth|indent|tiefe|eindring|profondeur|enfoncement|penetr|displac|deplacement|\bdisp\b|^h$",
    ),
    Role("force", "N", r"force|\bload\b|kraft|\blast\b|charge|^[fp]$"),
)
"""Quantities of the columns of a record; heights contain the deflection of the spring, tip positions not."""

_LEAST, _ROWS = 10, 3
"""Least number of rows, of a record and of a hold."""
_NOISE, _TOUCHED, _FULL, _HELD = 8.0, 0.05, 0.98, 0.05
"""Noises above which a change is real; force, over the largest, of a contact and of an end of the approach;
least duration of a hold over that of the contact."""
_ROUNDING = 1e-12
"""Of a depth, over the largest."""
REACH = 0.5
"""Largest distance of a fitted contact from where the force is seen to rise, over the deepest indentation."""
_REENTRY = 0.05
"""Largest rise of the depth during retraction, over the deepest indentation."""


@dataclass(frozen=True, eq=False, repr=False)
class Indentation(views.Brief):
    """Record of an indenter: approach, hold and retraction, some of which may be missing.

    Attributes
    ----------
    time, depth, force
        s, m, N, shape (n,); the depth grows into the body, and a force above 0 presses.
    contact
        Depth of the first contact, m; None if it is to be fitted.
    touched, held, last
        Places of the first row in contact, of the last one of the approach, and of the last one before the
        retraction.
    signs
        How signs of the columns were understood.
    baseline
        Force out of contact, N, that was subtracted; where it drifts, the one at the end of the hold.
    """

    time: Floats
    depth: Floats
    force: Floats
    contact: float | None
    touched: int
    held: int
    last: int
    signs: str
    baseline: float = 0.0

    @classmethod
    def of(
        cls,
        time: ArrayLike,
        depth: ArrayLike,
        force: ArrayLike,
        *,
        contact: float | str | None = 0.0,
        drift: float | str = 0.0,
        about: str = "depth",
    ) -> Indentation:
        """Understand a record: signs, contact and segments.

        Parameters
        ----------
        time, depth, force
            Rising times, s; depths, m; and forces, N: shape (n,), of either sign convention.
        contact
            Depth at the first contact, m; ``"fit"`` if it is a parameter.
        drift
            Speed of the depth that is no deformation, m/s: it is subtracted.
        about
            What the depths are, for the words about signs.

        Raises
        ------
        InputError
            Shapes differ; times do not rise; there is no contact in the record; a retraction has no approach;
            the body is pressed again.
        """
        t, d, F = checks.line("time", time), checks.line("depth", depth), checks.line("force", force)
        _check_rows(t, d, F)
        at = None if contact in (None, "fit") else float(si.number("contact", contact, "m"))
        rest, presses = _pressing(d, F)
        F, rest = presses * F, presses * rest
        if F.max() - rest <= _NOISE * noise(F):
            got = f"at most {F.max() - rest:.3g} N, with a noise of {noise(F):.3g} N"
            raise InputError("force", expected="a contact: forces that rise above their noise", got=got)
        down = _downward(d, F - rest)
        d = down * d - float(si.number("drift", drift, "m/s")) * (t - t[0])
        signs = f"{about} {'grows' if down > 0 else 'falls'} into the body, "
        signs += f"forces {'above' if presses > 0 else 'below'} 0 press"
        touched, held, last = _segments(t, d, F - rest, at)
        highest = d[touched] - REACH * (d[last] - d[touched]) if at is None else at
        out = np.flatnonzero(d[:touched] < highest)
        level = _baseline(t, F, out, last)
        return cls(t, d, F - level, at, touched, held, last, signs, float(level[last]))

    def __repr__(self) -> str:
        return f"<Indentation: {', '.join(f'{row.name} {row.value}' for row in self.rows())}>"

    def rows(self) -> list[Row]:
        """Rows of a summary: signs and segments."""
        rows = [Row("signs", self.signs), Row("baseline", self.baseline, "N", note=", subtracted", digits=3)]
        for name, first, last in self.segments:
            depth, force = (np.ptp(values[first : last + 1]) for values in (self.depth, self.force))
            span = f"{self.time[first]:.4g} to {self.time[last]:.4g} s, {last - first + 1} rows"
            rows.append(Row(name, f"{span}, over {depth:.3g} m and {force:.3g} N"))
        return rows

    @property
    def segments(self) -> list[tuple[str, int, int]]:
        """Names of the segments in contact, with their first and last rows."""
        ends = [("approach", self.touched, self.held), ("hold", self.held, self.last)]
        ends.append(("retraction", self.last, self.time.size - 1))
        return [(name, first, last) for name, first, last in ends if last > first]

    @property
    def span(self) -> tuple[float, float]:
        """Times after a load, s, that the record determines: a tenth of the approach to the hold's end."""
        begin = self.time[self.touched]
        first = (self.time[self.held] - begin) / 10 or self.time[self.touched + 1] - begin
        return float(first), float(self.time[self.last] - begin)

    @property
    def largest(self) -> float:
        """Largest force, N."""
        return float(self.force[: self.last + 1].max())

    @property
    def reached(self) -> float:
        """Depth of the first contact, m; if this is to be fitted, where the force is seen to rise."""
        return float(self.depth[self.touched]) if self.contact is None else self.contact

    def thinned(self, most: int) -> tuple[Indentation, Floats]:
        """Means of neighboring rows in each segment, at most so many; and how many rows each is of.

        A long hold has them evenly in the logarithm of its rows, for it relaxes fastest at first.
        """
        begin: Any = []
        for first, last in pairwise(sorted({0, self.touched, self.held + 1, self.last + 1, self.time.size})):
            share = np.arange(last - first) / (last - first)
            if first == self.held + 1 and share.size > most:
                share = np.log1p(share * share.size) / math.log1p(share.size)
            begin += (first + np.unique((most * share).astype(int), return_index=True)[1]).tolist()
        count = np.diff(np.append(begin, self.time.size)).astype(np.float64)
        t, d, F = (np.add.reduceat(values, begin) / count for values in (self.time, self.depth, self.force))
        ends = np.searchsorted(begin, [self.touched, self.held, self.last], "right") - 1
        touched, held, last = ends.tolist()
        return Indentation(t, d, F, self.contact, touched, held, last, self.signs, self.baseline), count


def _check_rows(t: Floats, d: Floats, F: Floats) -> None:
    for name, values in (("depth", d), ("force", F)):
        if values.shape != t.shape:
            raise InputError(name, expected=f"one for each of {t.size} times", got=f"{values.size}")
    if t.size < _LEAST:
        raise InputError("time", expected=f"{_LEAST} rows or more", got=f"{t.size}")
    if (np.diff(t) <= 0).any():
        at = int(np.argmax(np.diff(t) <= 0))
        raise InputError("time", expected="times that rise", got=f"{t[at + 1]:g} after {t[at]:g}")


def noise(values: Floats) -> float:
    """Standard deviation of the noise of a smooth series, from the median of its second differences."""
    return float(1.4826 * np.median(np.abs(np.diff(values, 2))) / np.sqrt(6))


def _pressing(d: Floats, F: Floats) -> tuple[float, float]:
    """Force at rest, and the sign of forces that press: before the depth turns, these are the largest."""
    rows = max(3, F.size // 20)
    rest, turn = float(np.median(F[:rows])), _turn(d)
    away = np.abs(F - rest)
    # A force that stays while the depth moves, and changes before this turns, is none of contact.
    stays = np.ptp(F[:rows]) <= _NOISE * noise(F) and np.ptp(d[:rows]) > _NOISE * noise(d)
    if not (stays and away[: turn + 1].max() > 0.1 * np.ptp(F)):
        if np.ptp(F) < np.abs(np.median(F)):  # a hold only
            return 0.0, float(np.sign(np.median(F)))
        if abs(F[0]) > 0.5 * np.abs(F).max():  # begins in contact
            return 0.0, float(np.sign(F[0]))
        rest = float(F[0])  # of a fast approach, these rows hold more than the rest
        away = np.abs(F - rest)
    risen = int(np.argmax(away > 0.2 * away.max()))
    largest = int(np.argmax(away[: max(turn, risen) + 1]))
    return rest, float(np.sign(F[largest] - rest))


def _turn(d: Floats) -> int:
    """The row before which a depth goes one way only."""
    little = max(_REENTRY * float(np.ptp(d)), _NOISE * noise(d))
    gone = d - d[0]
    gone = gone * np.sign(gone[np.argmax(np.abs(gone) > little)])
    back = np.maximum.accumulate(gone) - gone > little
    return int(np.argmax(back)) if back.any() else d.size - 1


def _downward(d: Floats, pressed: Floats) -> float:
    """Sign of depths that grow into the body: that of the change while the force rises."""
    top = int(np.argmax(pressed))
    inside = np.flatnonzero(pressed[: top + 1] > 0.1 * pressed[top])
    before = d[: top + 1][inside]
    if before.size > 2 and np.ptp(pressed[inside]) > 0.2 * pressed[top]:
        return float(np.sign(np.polyfit(pressed[inside], before, 1)[0]) or 1.0)
    return float(np.sign(np.median(d)) or 1.0)


def _baseline(t: Floats, F: Floats, out: NDArray[np.intp], last: int) -> Floats:
    """Force out of contact: a line if the rows before last longer than the contact, else constant."""
    if out.size < _ROWS:
        return np.zeros(t.size)
    long = out.size >= _LEAST and t[out[-1]] - t[out[0]] > t[last] - t[out[-1]]
    line = np.polyfit(t[out], F[out], 1) if long else [0.0, F[out].mean()]
    return np.polyval(line, np.minimum(t, t[last]))


def _segments(t: Floats, d: Floats, pressed: Floats, contact: float | None) -> tuple[int, int, int]:
    """Places of the first contact, of the end of the approach, and of the last row before the retraction."""
    deepest, near = float(d.max()), max(_NOISE * noise(d), _ROUNDING * float(np.abs(d).max()))
    last = int(np.flatnonzero(d >= deepest - near)[-1])
    if contact is not None and contact >= deepest:
        expected = f"a depth that the record reaches, below {deepest:.4g} m"
        raise InputError("contact", expected=expected, got=f"{contact:.4g} m", cure={"contact": "fit"})
    inside = d > contact if contact is not None else pressed > _TOUCHED * pressed.max()
    # From the last row out of contact on: single rows of noise are none.
    out = np.flatnonzero(~inside[: last + 1])
    touched = min(int(out[-1]) + 1 if out.size else 0, last)
    if last < 2 or t[last] == t[touched]:
        got = "a depth that falls from the first row on"
        raise InputError("depth", expected="an approach or a hold before the retraction", got=got)
    _check_once(t, d, int(np.argmax(inside)), near)
    full = (d >= deepest - near) | (pressed >= _FULL * pressed[: last + 1].max())
    held = touched + int(np.argmax(full[touched : last + 1]))
    if t[last] - t[held] < _HELD * (t[last] - t[touched]) or last - held < _ROWS:
        held = last = max(int(np.argmax(d)), touched + 1)
    return touched, held, last


def _check_once(t: Floats, d: Floats, first: int, near: float) -> None:
    """Refuse a record whose depth rises again in contact after it has fallen."""
    deepest = float(d.max())
    little = max(_REENTRY * (deepest - d[first]), near)
    fallen = np.maximum.accumulate(d[first:]) - d[first:] > little
    after = d[first + int(np.argmax(fallen)) :] if fallen.any() else d[-1:]
    again = (after - np.minimum.accumulate(after) > little) & (after > d[first])
    if again.any():
        at = t[t.size - after.size + int(np.argmax(again))]
        got = f"depths that rise again at {at:.4g} s"
        raise InputError("depth", expected="one approach and one retraction", got=got)


def columns_of(path: Path | str, columns: Chosen | None = None, units: Units | None = None) -> Columns:
    """The columns of a record by their roles."""
    return Columns(path, ROLES, columns, units)


def is_record(path: Path) -> bool:
    """Whether a table has a column of forces or deflections beside one of depths or heights."""
    roles = set(Columns(read_table(path), ROLES).roles)
    return bool(roles & {"force", "deflection"}) and bool(roles & {"depth", "tip position", "height"})


def read_indentation(
    path: Path | str,
    *,
    columns: Chosen | None = None,
    units: Units | None = None,
    spring: float | str | None = None,
    contact: float | str | None = None,
    drift: float | str = 0.0,
) -> tuple[Indentation, str]:
    """Read the record of an indenter or AFM: a table of times, depths and forces, each with a unit.

    Columns are named depth, indentation or displacement; or tip position, which needs a contact point; or
    height or piezo, which contains the deflection of a spring; and force or load, or deflection (m).

    Parameters
    ----------
    path, columns, units
        As for `asperity.friction.read_record`.
    spring
        Spring constant, N/m, of heights and deflections.
    contact, drift
        As for `Indentation.of`; by default depths are from the contact, and other contacts are fitted.

    Returns
    -------
    The record, and a line on the columns that were read.

    Raises
    ------
    InputError
        A column or a unit is missing; a height has no spring; or as `Indentation.of`.
    """
    read = columns_of(path, columns, units)
    roles = read.by_role
    kind = next((name for name in ("depth", "tip position", "height") if name in roles), "")
    missing = [name for name, there in (("time", "time" in roles), ("depth or height", kind)) if not there]
    if missing or not {"force", "deflection"} & set(roles):
        expected = f"columns of time, depth and force; {' and '.join(missing or ['force'])}"
        raise InputError(read.table.name, expected=expected, got=named(read.table))
    time, depth = read.values("time", bare=False), read.values(kind, bare=False)
    # JPK writes deflections in N, which are forces.
    at = roles.get("force", roles.get("deflection", 0))
    is_force = "force" in roles or si.factor(si.spelled(read.unit_text(at)) or "", "N") is not None
    k = math.nan if is_force and kind != "height" else _spring(spring, kind)
    force = read.values("force" if is_force else "deflection", at, bare=False) * (1 if is_force else k)
    if kind == "height":
        rest, presses = _pressing(depth, force)
        pressed = presses * (force - rest)
        depth = depth - _downward(depth, pressed) * pressed / k
    where = contact if contact is not None else 0.0 if kind == "depth" else "fit"
    record = Indentation.of(time, depth, force, contact=where, drift=drift, about=str(kind))
    return record, read.read


def _spring(spring: float | str | None, kind: str) -> float:
    """Spring constant, N/m; `InputError` without one."""
    if spring is None:
        why = "as heights contain the deflection" if kind == "height" else "which makes forces of deflections"
        expected = f"a spring constant, {why}"
        raise InputError("spring", expected=expected, got="none", cure={"spring": "0.05 N/m"})
    return float(si.number("spring", spring, "N/m", above=0))
