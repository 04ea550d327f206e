"""Steady sliding over a viscoelastic solid: friction and contact area against speed."""

from asperity.base.calls import answered as _answered
from asperity.sliding.answer import steady_sliding as steady_sliding

__dir__ = _answered(globals())
