"""Campaigns: thousands of runs from one file, in one store that survives anything."""

from asperity.app.campaign.demand import Estimate as Estimate
from asperity.app.campaign.demand import estimate as estimate
from asperity.app.campaign.gather import fields as fields
from asperity.app.campaign.gather import open as open  # noqa: A004
from asperity.app.campaign.gather import table as table
from asperity.app.campaign.plan import Plan as Plan
from asperity.app.campaign.plan import load_plan as load_plan
from asperity.app.campaign.plan import read_plan as read_plan
from asperity.app.campaign.sweeping import Tally as Tally
from asperity.app.campaign.sweeping import sweep as sweep
from asperity.app.campaign.sweeping import tally as tally
from asperity.base.calls import answered as _answered

__dir__ = _answered(globals())
