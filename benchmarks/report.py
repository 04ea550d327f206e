"""The table: gathered, printed and stored."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import curve
from running import head, line
from solvers import ASPERITY

COLUMNS = (
    "case", "threads", "solver", "contact", "iterations", "residual", "sites", "seconds", "best", "speed",
)  # fmt: skip
LEGEND = (
    "seconds: median of the solve alone, by the wall clock; * marks medians more than 20 % above those of "
    "the processor's clock: the machine was busy.",
    "speed: seconds of the fastest peer that reached the residual, over these; so the fastest peer has 1.",
    "residual: largest force off contact or pull in contact over the mean contact force, evaluated by an "
    "operator that no solver uses (in a step, Asperity's is its own); ! marks one above the target.",
    "sites: how many differ from Asperity's contact set (in a step, from the first peer's).",
)


@dataclass
class Book:
    """Everything one session measures."""

    machine: dict[str, Any]
    threads: int
    target: float
    versions: dict[str, str] = field(default_factory=dict)
    absent: dict[str, str] = field(default_factory=dict)
    rows: list[dict[str, Any]] = field(default_factory=list)
    curves: list[dict[str, Any]] = field(default_factory=list)

    def save(self, folder: Path) -> None:
        """Write table.json and table.md; speeds are those known by now."""
        folder.mkdir(parents=True, exist_ok=True)
        rows = [{**row, "speed": speed(row, self.rows, self.target)} for row in self.rows]
        (folder / "table.json").write_text(json.dumps({**asdict(self), "rows": rows}, indent=1) + "\n")
        (folder / "table.md").write_text(self.text())

    def text(self) -> str:
        """The table, for a terminal and a page."""
        rows = (line(*cells(row, self.rows, self.threads, self.target)) for row in self.rows)
        return "\n".join([*head(*COLUMNS), *rows, "", *(f"- {note}" for note in self._notes()), ""])

    def _notes(self) -> list[str]:
        notes = list(LEGEND) if self.rows else []
        notes += [curve.words(measured) for measured in self.curves]
        notes += [f"{name} is absent: {reason}" for name, reason in self.absent.items()]
        facts = self.machine
        versions = ", ".join(f"{name} {number}" for name, number in facts["versions"].items())
        notes.append(
            f"{facts['cpu']}, {facts['cores']} cores, {facts['memory_gb']} GB, load average "
            f"{facts['load_average'][0]} at the start; {facts['system']}, Python {facts['python']}, "
            f"{versions}, commit {facts['commit']}; {facts['time']}"
        )
        notes.append("; ".join(self.versions.values()))
        return notes


def speed(row: dict[str, Any], rows: list[dict[str, Any]], target: float) -> float | None:
    """Seconds of the fastest peer that reached the target on this row's case, over the row's seconds."""
    peers = [
        other["seconds"]
        for other in rows
        if other["case"] == row["case"]
        and other["solver"] != ASPERITY
        and "seconds" in other
        and other["residual"] <= target
    ]
    return min(peers) / row["seconds"] if peers and "seconds" in row else None


def cells(row: dict[str, Any], rows: list[dict[str, Any]], threads: int, target: float) -> tuple[str, ...]:
    """One line of the table as words."""
    start = (row["case"], str(threads), row["solver"])
    if "seconds" not in row:
        return (*start, *("-",) * 6, row["failure"].replace("\n", " ").replace("|", "/")[:60] or "-")
    ratio = speed(row, rows, target)
    busy = "*" if row["seconds"] > 1.2 * row["cpu_seconds"] and threads == 1 else ""
    differ = row["sites_that_differ"]
    return (
        *start,
        f"{100 * row['contact_fraction']:.2f} %",
        str(row["iterations"]) if row["iterations"] >= 0 else "?",
        f"{row['residual']:.1e}{'!' if row['residual'] > target else ''}",
        "-" if differ is None else str(differ),
        f"{row['seconds']:.3g}{busy}",
        f"{row['best_seconds']:.3g}",
        "-" if ratio is None else f"{ratio:.3g}",
    )
