"""The loosest tolerance with which each peer reaches the residual, case by case (``bench.py --tune``)."""

from __future__ import annotations

import json
from pathlib import Path

STORED = Path(__file__).parent / "peers" / "tolerances.json"
LOOSEST, TIGHTEST, STEP = 1e-4, 1e-15, 10**0.5


def known(solver: str, case: str) -> float:
    """The stored tolerance; where there is none, the loosest stored for the solver, or the loosest."""
    stored = json.loads(STORED.read_text()).get(solver, {}) if STORED.exists() else {}
    return float(stored.get(case, max(stored.values(), default=LOOSEST)))


def tighter(tolerance: float) -> float | None:
    """The next tolerance to try, or None beyond the tightest; two to a decade."""
    following = float(f"{tolerance / STEP:.1e}")
    return following if following >= TIGHTEST else None


def keep(case: str, found: dict[str, float]) -> None:
    """Store what was found for a case."""
    stored = json.loads(STORED.read_text()) if STORED.exists() else {}
    for solver, tolerance in found.items():
        stored.setdefault(solver, {})[case] = tolerance
    STORED.write_text(json.dumps(stored, indent=1, sort_keys=True) + "\n")
