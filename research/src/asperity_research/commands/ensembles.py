"""Flags that a reproduction and a study share."""

from asperity.app.cli.flags import Switch, Whole
from asperity.app.cli.options import flags_of_fields


@flags_of_fields
class Ensembles:
    """Which surfaces a reproduction or a study takes.

    Parameters
    ----------
    quick
        Small ensembles: minutes in place of the full effort.
    seed
        First seed of every ensemble, which the others follow: 1000 repeats everything on other surfaces.
    """

    quick: Switch = False
    seed: Whole = 0

    @property
    def flags(self) -> list[str]:
        """The words that ask for them."""
        return [*["--quick"] * self.quick, *(["--seed", str(self.seed)] if self.seed else [])]
