"""Histories of load and separation: a list of legs, one after the other.

    P = asp.protocols
    protocol = [P.Hold(10.0), P.Step(load=160.0), P.Hold(100.0)]
    protocol = [P.Repeat([P.Ramp(5.0, load=400.0), P.Ramp(5.0, load=100.0)], count=3)]
    protocol = [P.Slide(50.0, velocity=0.1), P.Hold(1e3), P.Slide(50.0, velocity=0.1)]

Times run through the whole history. Durations are in the unit of time, loads and separations in those of
`asperity.press`, distances in that of the distance between sites. Where a contact has units, they may be
texts: ``Hold("10 min")``, ``Step(load="2 N")``, ``Slide("20 um", velocity="1 um/s")``.
"""

from asperity.base.calls import answered as _answered
from asperity.protocols.histories import MeasuredHistory as MeasuredHistory
from asperity.protocols.histories import measured as measured
from asperity.protocols.legs import KINDS as KINDS
from asperity.protocols.legs import Hold as Hold
from asperity.protocols.legs import Leg as Leg
from asperity.protocols.legs import Ramp as Ramp
from asperity.protocols.legs import Repeat as Repeat
from asperity.protocols.legs import Slide as Slide
from asperity.protocols.legs import Step as Step

__dir__ = _answered(globals())
