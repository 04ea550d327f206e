"""The summary of a run, and of a surface, as rows of words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from asperity.figures.style import uncertain
from asperity.words import printable

if TYPE_CHECKING:
    from asperity.analysis import AgingSummary
    from asperity.runs import Outcome

Row = tuple[str, str]


def aligned(rows: Sequence[Sequence[str]]) -> str:
    """Lay rows out as a table of plain text; a row of one cell is a heading."""
    columns = max(len(row) for row in rows)
    widths = [max((len(row[i]) for row in rows if i < len(row) > 1), default=0) for i in range(columns)]
    lines = []
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        lines.append("  ".join(cells).rstrip())
    return printable("\n".join(lines))


def run_report(outcome: Outcome, *, seconds: float, resumed: bool) -> list[Row]:
    """Say what was run and what came out; of a resumed run, the seconds are those of this session."""
    dataset, summary, config = outcome.dataset, outcome.summary, outcome.config
    attrs = dataset.attrs
    held = str(attrs["held"])
    solid = ", ".join(f"{name} = {value:g}" for name, value in config.solid.model_dump().items())
    rows = [
        ("surface", _surface(outcome)),
        ("solid", solid),
        ("held", f"{held} {float(attrs[f'held_{held}']):.8g}"),
        ("load at t = 0", f"{float(dataset['load'][0]):.8g}"),
        ("contact at t = 0", _contact(summary.initial_area, summary)),
    ]
    if summary.time.size:
        late = f"contact at t = {summary.time[-1]:g}"
        rows.append((late, _contact(int(dataset["area"][-1]), summary)))
    if summary.relaxed_ratio is not None:
        rows.append(("contact relaxed", _contact(int(attrs["relaxed_area"]), summary)))
    rows += _fit(summary)
    if summary.steepest_per_decade > 0:
        steepest = f"{summary.steepest_per_decade:.3g} A(0) per decade, near t = {summary.steepest_time:.2g}"
        rows.append(("steepest growth", steepest))
    rows += [
        (
            "worst residual",
            f"{float(dataset['residual'].max()):.1e} of the mean contact force",
        ),
        (
            "effort",
            f"{int(dataset['steps'].sum())} time steps, {int(dataset['iterations'].sum())} iterations, "
            f"{seconds:.1f} s{' in this session' if resumed else ''}",
        ),
        *(("remark", remark) for remark in outcome.remarks),
    ]
    return rows


def _surface(outcome: Outcome) -> str:
    chosen = outcome.config.surface.model_dump(exclude_none=True)
    if chosen["kind"] == "file":
        lattice = " x ".join(str(n) for n in outcome.dataset["heights"].shape)
        rules = ", ".join(
            f"{k} = {chosen[k]}" for k in ("undefined", "tilt", "periodic", "unit") if k in chosen
        )
        return f"{chosen['path']}: {lattice} sites ({rules})"
    described = []
    for name, value in chosen.items():
        if name != "kind":
            text = " x ".join(map(str, value)) if isinstance(value, list) else f"{value:g}"
            described.append(f"{name} = {text}")
    return f"{chosen['kind']}: {', '.join(described)}"


def _contact(area: int, summary: AgingSummary) -> str:
    ratio = f", A/A(0) = {area / summary.initial_area:.4f}" if area != summary.initial_area else ""
    return f"{area} of {summary.sites} sites = {100 * area / summary.sites:.4g} %{ratio}"


def _fit(summary: AgingSummary) -> list[Row]:
    fit = summary.fit
    if fit is None:
        return [("fit", summary.fit_note)]
    rows = [
        ("fit", "A/A(0) = a - (a - 1) / (1 + t/t0)^q, with standard errors as if scatter were random:"),
        ("  a", uncertain(fit.a, fit.a_stderr)),
        ("  q", uncertain(fit.q, fit.q_stderr)),
        ("  t0", uncertain(fit.t0, fit.t0_stderr)),
        ("  (a - 1) q", uncertain(fit.C, fit.C_stderr)),
        ("  misfit", f"{100 * fit.rms_residual:.2g} % rms"),
    ]
    return [*rows, ("  note", summary.fit_note)] if summary.fit_note else rows
