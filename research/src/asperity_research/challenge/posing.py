"""The reference problems: what is asked, of what, and the certified answers; all read from files beside this.

A problem is a TOML file: its words, the rule of its heights, and under ``run`` the configuration of a run
that solves it. Its answer is a CSV file, made by ``benchmarks/certify.py``: the abscissa, and each quantity
that is asked with its error bar (``_bar``) and the parts of which the bar is made: time steps (``_time``),
solver (``_solver``), and lattice (``_lattice``).
"""

import functools
import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from asperity.app.config import RunConfig, config_from
from asperity.errors import InputError
from asperity.protocols import Leg
from asperity.results import read_table
from asperity.surfaces import Surface
from asperity_research.arrays import Field
from asperity_research.challenge.heights import independent, waves
from asperity_research.doors import named

_DATA = files("asperity_research.challenge") / "data"
Table = Mapping[str, Any]  # A table of a TOML file


def _with_unit(name: str, unit: str) -> str:
    """Head a column: ``load_N``, ``contact_area_m2``, and a count or a pure number by its name alone."""
    return name if unit in ("1", "sites") else f"{name}_{unit.replace('^', '').replace('/', '_per_')}"


@dataclass(frozen=True)
class Column:
    """A column of an answer.

    Attributes
    ----------
    name, unit
        What it is, as in the dataset of a history; the unit is "1" or "sites" where there is none.
    meaning
        The same in words.
    tolerance
        Relative deviation that counts as agreement in practice; 0 for an abscissa.
    reading
        The variable of a history in which Asperity has it, if that is another one.
    """

    name: str
    unit: str
    meaning: str
    tolerance: float = 0.0
    reading: str = ""

    @property
    def heading(self) -> str:
        """Its name in tables: ``load_N``."""
        return _with_unit(self.name, self.unit)

    @property
    def headings(self) -> tuple[str, ...]:
        """Names under which a result may have it, the best first."""
        headings = (self.heading,) if self.heading == self.name else (self.heading, self.name)
        return (_with_unit(self.reading, self.unit), *headings) if self.reading else headings


@dataclass(frozen=True, eq=False)
class Answer:
    """A certified answer.

    Attributes
    ----------
    abscissa
        Where it is known, shape (n,).
    values, bars
        By the name of each quantity, shape (n,): the value, and its error bar.
    parts
        What the bars are made of, by name of the quantity and part.
    origin
        The lines that say how it was made.
    """

    abscissa: Field
    values: Mapping[str, Field]
    bars: Mapping[str, Field]
    parts: Mapping[tuple[str, str], Field]
    origin: tuple[str, ...]


PARTS = ("time", "solver", "lattice")  # What error bars are made of


@dataclass(frozen=True, eq=False, repr=False)
class Problem:
    """A reference problem.

    Attributes
    ----------
    name, title, question
        What it is, in words.
    abscissa
        The column along which it is asked.
    asked
        The quantities that are asked.
    heights
        The rule of the heights; see `asperity_research.challenge.heights`.
    run
        Tables of the configuration of a run that solves it, all but the surface of a made one.
    """

    name: str
    title: str
    question: str
    abscissa: Column
    asked: tuple[Column, ...]
    heights: Table
    run: Table

    def __repr__(self) -> str:
        return f"<Problem {self.name}: {self.title}>"

    @property
    def continuous(self) -> bool:
        """Whether it is known between the sites, so that a finer lattice comes closer to the answer."""
        return "side" in self.heights

    @property
    def config(self) -> RunConfig:
        """The run that solves it, but for the surface."""
        return config_from({key: table for key, table in self.run.items() if key != "surface"}, {}, None)

    @property
    def legs(self) -> tuple[Leg, ...]:
        """The history of the load; none where it is constant."""
        return tuple(self.config.protocol)

    def surface(self, *, halvings: int = 0, scan: str | Path | None = None) -> Surface:
        """Make the surface, or read the scan.

        Parameters
        ----------
        halvings
            How often the distance between the sites is halved; only where the surface is known between them.
        scan
            The file of a measured problem.

        Raises
        ------
        InputError
            The scan is missing or another one, or there is nothing between the sites.
        """
        rule = dict(self.heights)
        kind = rule.pop("rule")
        if not isinstance(halvings, int | np.integer) or isinstance(halvings, bool) or halvings < 0:
            raise InputError("halvings", expected="a whole number >= 0", got=repr(halvings))
        if halvings and not self.continuous:
            expected = f"0 for {self.name}, whose sites are the problem"
            raise InputError("halvings", expected=expected, got=halvings)
        if kind == "scan":
            table = {"kind": "file", "path": str(self._scan(scan)), **self.run["surface"]}
            return config_from({**self.run, "surface": table}, {}, None).surface.build()
        if kind == "independent":
            return Surface(independent(rule["sites"], seed=rule["seed"]))
        spline = {key: rule[key] for key in ("octaves", "ratio", "seed")}
        heights = waves(rule["grid"], **spline, halvings=rule["halvings"] + halvings) * rule.get("times", 1.0)
        if not self.continuous:
            return Surface(heights)
        return Surface(heights, rule["unit"], (rule["side"] / len(heights),) * 2, rule["unit"])

    def _scan(self, scan: str | Path | None) -> Path:
        """The file, if it is the right one."""
        if scan is None:
            got = "none"
        elif not Path(scan).is_file():
            got = f"{scan}, which is no file"
        elif hashlib.sha256(Path(scan).read_bytes()).hexdigest() != self.heights["sha256"]:
            got = f"{scan}, which holds something else"
        else:
            return Path(scan)
        expected, advice = f"the file {self.heights['file']}", f"the {self.heights['source']}"
        raise InputError("scan", expected=expected, got=got, advice=advice)

    @functools.cached_property
    def answer(self) -> Answer:
        """The certified answer."""
        path = Path(str(_DATA / f"{self.name}.csv"))
        table, text = read_table(path), path.read_text(encoding="utf-8").splitlines()
        columns = dict(zip(table.names, table.values.T, strict=True))
        headings = {column.name: column.heading for column in self.asked}
        return Answer(
            abscissa=columns[self.abscissa.heading],
            values={name: columns[heading] for name, heading in headings.items()},
            bars={name: columns[f"{heading}_bar"] for name, heading in headings.items()},
            parts={
                (name, part): columns.get(f"{heading}_{part}", np.zeros(len(table.values)))
                for name, heading in headings.items()
                for part in PARTS
            },
            origin=tuple(line.lstrip("# ") for line in text if line.startswith("#")),
        )


NAMES = (
    *("dilute", "dense", "self-affine", "measured-scan"),
    *("two-step-load", "constant-area", "relaxing-half-space", "slide-hold-slide"),
)


def problems() -> tuple[Problem, ...]:
    """The eight reference problems."""
    return tuple(_all().values())


def problem(name: str) -> Problem:
    """The reference problem of a name.

    Raises
    ------
    InputError
        There is none of this name.
    """
    return named("problem", name, _all(), is_flag=True)


@functools.cache
def _all() -> dict[str, Problem]:
    problems = {}
    for name in NAMES:
        tables = tomllib.loads((_DATA / f"{name}.toml").read_text(encoding="utf-8"))
        abscissa, asked = Column(**tables.pop("abscissa")), (Column(**one) for one in tables.pop("asked"))
        question = tables.pop("question").strip()
        problems[name] = Problem(name, question=question, abscissa=abscissa, asked=tuple(asked), **tables)
    return problems
