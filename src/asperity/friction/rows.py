"""Rows of a fit of rate and state."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from asperity.base import views
from asperity.base.checks import Floats
from asperity.base.readable import written
from asperity.base.rows import Row, table_rows
from asperity.base.words import counted, thousands, uncertain
from asperity.friction.comparing import PARAMETERS, StateLaws
from asperity.friction.events import Event
from asperity.friction.laws import STATE_LAWS, StateLaw
from asperity.friction.parameters import MISSES, MachineFit, RateAndStateFit
from asperity.friction.records import Record

_FELT = 0.01
"""Least step of a recorded friction that matters, over a and b."""


@views.defines(StateLaws.rows)
def rows_of(laws: StateLaws, /, first: str = "") -> list[Row]:
    """Rows on the record, the fits of both laws, and the verdict; several records begin with that named."""
    record, kinds = laws.record, laws.peaks()
    slip = written(float(record.displacement[-1]), "m" if record.si else "1", 3)
    fit = laws.fits[laws.preferred]
    fitted = f"{counted(fit.points, 'value')} fitted of {thousands(record.time.size)}"
    source = (record.read or first) if laws.runs == 1 else f"{laws.runs} surfaces: {first}, ..."
    rows = [
        Row("record", source),
        Row("", f"{fitted}, slip {slip}, {counted(kinds.duration.size, 'hold')}"),
    ]
    for law in sorted(STATE_LAWS, key=lambda name: name != laws.preferred):
        rows += _law(laws, law)
    rows.append(Row("verdict", _verdict(laws)))
    if any(isinstance(each, MachineFit) for each in laws.every):
        rows += _machine(laws)
    if fit.determined and fit.D_c < record.finest_slip:
        finest = written(record.finest_slip, "m" if record.si else "1", 3)
        text = f"D_c is shorter than the slip between two values, {finest}, and not well resolved"
        rows.append(Row("note", f"{text}; smoother surfaces or more substeps of the slides resolve it"))
    if laws.runs == 1 and fit.effective_points < fit.points:
        text = f"what the {fit.law} law misses is no random scatter: neighbors correlate by "
        text += f"{fit.autocorrelation:.2f}, so that the values count as {fit.effective_points:.0f}"
        text += "" if isinstance(fit, MachineFit) else "; records of several surfaces give better intervals"
        rows.append(Row("note", text))
    felt = max(float(np.std(fit.residual)), _FELT * max(abs(fit.a), abs(fit.b)))
    if laws.runs == 1 and (step := _step(record.friction)) > felt:
        text = f"friction is recorded in steps of {step:.2g}, more than the {fit.law} law misses it by"
        rows.append(Row("note", f"{text}: a, b and D_c may err by more than their intervals"))
    return rows


def _step(friction: Floats) -> float:
    """The step of which all values are multiples; 0 without one."""
    values = np.unique(friction)
    step = float(np.diff(values).min()) if values.size > 1 else 0.0
    return step if step and np.allclose(values / step, np.round(values / step), rtol=0, atol=1e-3) else 0.0


def _machine(laws: StateLaws) -> list[Row]:
    (second, length), (time_unit, unit) = laws.record.scales, laws.record.units
    heads = ("law", "stiffness", f"k (1/{unit})", "a", "b", f"D_c ({unit})", "mu_0", "misfit")
    table: list[tuple[str, ...]] = [heads]
    for other in laws.every:
        k = "inf"
        if isinstance(other, MachineFit):
            open_ = other.stiffness_at_edge or other.stiffness_stderr > other.stiffness
            k = "not determined" if open_ else f"{other.stiffness * length:.4g}"
        mu_0, misfit = uncertain(other.mu_0, other.mu_0_stderr), f"{float(np.std(other.residual)):.2g}"
        table.append((other.law, other.stiffness_from, k, *_numbers(other, length), mu_0, misfit))
    rows = table_rows("machine", table)
    spans: dict[bool | None, list[str]] = {True: [], False: [], None: []}
    for name, factor, end in (("a", 1.0, ""), ("b", 1.0, ""), ("D_c", 1 / length, f" {unit}")):
        low, high, moves = laws.range_of(name)
        spans[moves].append(f"{name} ({factor * low:.3g} to {factor * high:.3g}{end})")
    if spans[False] and len(laws.suiting) > 1:
        rows.append(Row("", f"the same within errors for each law and stiffness: {', '.join(spans[False])}"))
    if spans[True]:
        rows.append(Row("", f"law and stiffness change {', '.join(spans[True])}: state both with the value"))
    for other in laws.every:
        if isinstance(other, MachineFit) and other.misfit >= MISSES:
            least, most = (f"{end / length:.2g}" for end in (other.tried[0], other.tried[-1]))
            text = f"{other.law} law, k {other.stiffness_from}: misfit {other.misfit:.2g} times the noise"
            text += f" before the first kink, the least from {len(other.tried)} starts"
            text += f" with D_c from {least} to {most}"
            rows.append(Row("note", f"{text} {unit}; the law does not describe the record"))
    fit = laws.fits[laws.preferred]
    if not isinstance(fit, MachineFit):
        return rows
    drift, error = fit.drift * length, fit.drift_stderr * length
    rows.append(Row("drift", drift, f"1/{unit} of the load point", error=error))
    for n in fit.released:
        assert laws.record.drive is not None
        seen, turned = float(laws.record.drive.kinks[n]) / second, float(fit.kinks[n]) / second
        text = f"friction turns at {turned:.6g} {time_unit}, the load point at {seen:.6g}"
        rows.append(Row("note", f"{text}: the fit takes the time of friction"))
    return rows


def _numbers(fit: RateAndStateFit, length: float) -> list[str]:
    D_c = uncertain(fit.D_c / length, fit.D_c_stderr / length) if fit.determined else "not determined"
    return [uncertain(fit.a, fit.a_stderr), uncertain(fit.b, fit.b_stderr), D_c]


def rows_of_events(fits: Mapping[Event, MachineFit | None], record: Record) -> list[Row]:
    """The same in words."""
    (second, length), (time_unit, unit) = record.scales, record.units
    lines: list[tuple[str, ...]] = [("", "event", f"time ({time_unit})", "a", "b", f"D_c ({unit})")]
    for event, fit in fits.items():
        before, after = (speed * second / length for speed in (event.before, event.after))
        speeds = f"{before:.3g} to {after:.3g} {unit}/{time_unit}"
        lasts = f"hold of {(event.end - event.time) / second:.4g} {time_unit}"
        words = lasts if event.kind == "hold" else speeds
        numbers = ["not fitted"] if fit is None else _numbers(fit, length)
        lines.append((f"{event.number}", words, f"{event.time / second:.6g}", *numbers))
    return table_rows("events", lines)


def _law(laws: StateLaws, law: StateLaw) -> list[Row]:
    record, fit = laws.record, laws.fits[law]
    rows = [Row(f"{law} law", "mu = mu_0 + a ln(V/V_0) + b ln(V_0 theta/D_c)")]
    for name in PARAMETERS + ("alpha",) * ("alpha" in laws.estimates[law]):
        estimate, text = laws.estimates[law][name], f"  {name.replace('_minus_', ' - ')}"
        value, unit = float(estimate.value), "m" if name == "D_c" and record.si else "1"
        if name == "a" and fit.a_stderr == 0:
            known = "of a constant shear strength" if value == record.a else "as given"
            rows.append(Row(text, value, note=f", {known}"))
        elif laws.is_open(law, name):
            rows.append(Row(text, "not determined by this record"))
        else:
            ends = float(estimate.low), float(estimate.high)
            rows.append(Row(text, value, unit, ends, error=float(estimate.stderr), at_least=fit.at_least))
    V_0 = written(fit.V_0, "m/s" if record.si else "1")
    return [*rows, Row("", f"at V_0 = {V_0}, misfit {100 * fit.rms_residual:.2g} % rms")]


def _verdict(laws: StateLaws) -> str:
    if laws.runs > 1:
        low, high = float(laws.log_ratio.low), float(laws.log_ratio.high)
        scatter = f"ln of the ratio of squares, aging over slip: {low:.3g} to {high:.3g}"
        preference = f"the surfaces prefer the {laws.verdict} law"
        return f"{preference if laws.verdict != 'undecided' else 'undecided between the laws'} ({scatter})"
    if laws.verdict == "undecided":
        return f"undecided: {laws.doubt or 'these data do not tell the aging law from the slip law'}"
    other = "slip" if laws.verdict == "aging" else "aging"
    odds = f"{laws.relative_likelihood:.1g}" if laws.relative_likelihood > 1e-6 else "less than 1e-6"
    return f"the data prefer the {laws.verdict} law: the {other} law is {odds} times as likely"
