"""Measured contacts: what is known of them, each number with its source, and simulations beside them."""

from asperity_research.experiments.comparing import run
from asperity_research.experiments.record import Column, Experiment, Quantity, load, names

__all__ = ["Column", "Experiment", "Quantity", "load", "names", "run"]
__dir__ = __all__.copy  # dir() lists the public names alone
