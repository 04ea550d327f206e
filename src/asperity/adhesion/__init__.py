"""Laws of adhesion with a range, one a file."""

from asperity.adhesion.dugdale import Dugdale
from asperity.adhesion.law import Adhesion, checked_adhesion

LAWS: dict[str, type[Adhesion]] = {law.__name__.lower(): law for law in (Dugdale,)}
"""Laws by their name in a configuration."""

__all__ = ["LAWS", "Adhesion", "Dugdale", "checked_adhesion"]
