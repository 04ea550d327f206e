"""Friction of contacts that age and slide: from their real area to the force, and to laws of friction."""

from asperity.friction.tabor import ShearStrength, add_friction

__all__ = ["ShearStrength", "add_friction"]


def __dir__() -> list[str]:
    """List the public names."""
    return __all__
