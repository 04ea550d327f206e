"""Research takes what is public of the library, and nothing else."""

import importlib
from pathlib import Path

from tests.unit.test_house import imported

import asperity

SOURCE = Path(__file__).parents[1] / "src" / "asperity_research"
ROOMS = {f"asperity.{name}" for name in asperity.__all__}
FOR_COMMANDS = {  # stated in asperity.app.cli.command
    "asperity.app.cli.campaign": {"tally_shown"},
    "asperity.app.cli.command": {"app", "command"},
    "asperity.app.cli.flags": {"Out", "Switch", "Whole", "naming"},
    "asperity.app.cli.new_files": {"FIGURE_SUFFIXES", "check_new_file"},
    "asperity.app.cli.options": {"Work", "flags_of_fields"},
    "asperity.app.cli.output": {"write_figure"},
    "asperity.app.config": {"RunConfig", "config_from"},
    "asperity.base.calls": {"showing"},
    "asperity.base.checks": {"instance"},
    "asperity.base.rows": {"Row", "aligned", "words_of"},
    "asperity.base.words": {"counted", "data_size", "duration", "power", "thousands"},
}


def is_public(name: str) -> bool:
    room, _, inside = name.rpartition(".")
    if name == "asperity" or name in ROOMS or inside in FOR_COMMANDS.get(room, ()):
        return True
    return room in ROOMS and inside in getattr(importlib.import_module(room), "__all__", ())


def test_research_imports_public_names_alone() -> None:
    for file in SOURCE.rglob("*.py"):
        taken = {name for name in imported(file) if name.partition(".")[0] == "asperity"}
        assert not {name for name in taken if not is_public(name)}, file
