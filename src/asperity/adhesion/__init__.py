"""Laws of adhesion with a range, one a file."""

from asperity.adhesion.dugdale import Dugdale as Dugdale
from asperity.adhesion.law import Adhesion as Adhesion
from asperity.adhesion.law import checked_adhesion as checked_adhesion

LAWS: dict[str, type[Adhesion]] = {law.__name__.lower(): law for law in (Dugdale,)}
"""Laws by their name in a configuration."""
