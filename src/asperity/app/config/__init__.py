"""The configuration of a run: its file, and how its mistakes are named."""

from asperity.app.config.reading import config_from as config_from
from asperity.app.config.reading import file_surface as file_surface
from asperity.app.config.reading import read_config as read_config
from asperity.app.config.reading import to_tables as to_tables
from asperity.app.config.reading import to_toml as to_toml
from asperity.ask.files import read_tables as read_tables
from asperity.ask.run import RunConfig as RunConfig
from asperity.ask.surface import MeasuredSurface as MeasuredSurface
