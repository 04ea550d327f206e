"""The configuration of a run: its file, and how its mistakes are named."""

from asperity.app.config.reading import (
    config_from,
    file_surface,
    from_tables,
    read_config,
    to_tables,
    to_toml,
)
from asperity.ask.files import read_tables
from asperity.ask.run import RunConfig
from asperity.ask.surface import MeasuredSurface

__all__ = [
    "MeasuredSurface",
    "RunConfig",
    "config_from",
    "file_surface",
    "from_tables",
    "read_config",
    "read_tables",
    "to_tables",
    "to_toml",
]
