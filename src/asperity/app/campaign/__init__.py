"""Campaigns: thousands of runs from one file, in one store that survives anything."""

from asperity.app.campaign.demand import Estimate, estimate
from asperity.app.campaign.gather import fields, open, table  # noqa: A004
from asperity.app.campaign.plan import Plan, load_plan, read_plan
from asperity.app.campaign.sweeping import Tally, sweep, tally
from asperity.base.calls import answered as _answered

__all__ = [
    "Estimate",
    "Plan",
    "Tally",
    "estimate",
    "fields",
    "load_plan",
    "open",
    "read_plan",
    "sweep",
    "table",
    "tally",
]
__dir__ = _answered(globals())
