"""ASPHER with free edges by its hierarchical operator; see `aspher_nested`."""

from functools import partial

import aspher_nested

VERSION = f"{aspher_nested.VERSION}, h2"
KINDS = ["free half-space"]
solve = partial(aspher_nested.solve, backend="h2")
