"""Files of experiments: every number has unit, uncertainty and source, or the file is refused in one line."""

import numpy as np
import pytest

import asperity
from asperity.errors import InputError
from asperity_research import experiments
from asperity_research.commands.experiment import say_experiment
from asperity_research.experiments.comparing import COMPARISONS

FILE = """
title = "A contact"
missing = ["the scan"]

[sources]
paper = "A. Author, A Journal 1, 1 (2001)"

[input.load]
value = 100.0
unit = "N"
uncertainty = "not stated"
source = "paper"
how = "text"

[series.growth]
what = "area against time"

[series.growth.time]
values = [1.0, 10.0, 100.0]
unit = "s"
uncertainty = 0.01
relative = true
source = "paper"
how = "figure"

[series.growth.area]
values = [1.0, 1.1, 1.2]
unit = "mm^2"
uncertainty = 0.02
source = "paper"
how = "figure"
"""


def test_a_file_of_ones_own_is_read(tmp_path):
    path = tmp_path / "own.toml"
    path.write_text(FILE)
    own = experiments.load(path)
    assert (own["load"], own.inputs["load"].unit) == (100.0, "N")
    growth = own.series["growth"]
    assert np.allclose(growth["time_error"], [0.01, 0.1, 1.0])
    assert np.allclose(growth["area_error"], 0.02)
    assert growth["area"].attrs == {"units": "mm^2", "source": "paper", "how": "figure"}


MISTAKES = {
    'unit = "N"\n': ("", "own.toml: input.load: expected unit"),
    'uncertainty = "not stated"\n': ("", 'expected uncertainty; .* try uncertainty = "not stated"'),
    'source = "paper"\nhow = "text"': ('how = "text"', "own.toml: input.load: expected source"),
    'how = "text"': ("", "own.toml: input.load: expected how"),
    'source = "paper"': (
        'source = "papre"',
        r"input.load.source: expected one of \[sources\]: paper, got 'papre'",
    ),
    "uncertainty = 0.02": (
        "uncertainty = -0.02",
        "growth.area.uncertainty: expected greater than or equal to 0",
    ),
    "[1.0, 10.0, 100.0]": (
        "[1.0, 100.0, 10.0]",
        "series.growth.time: expected values that rise, got 10 after 100",
    ),
    "[1.0, 1.1, 1.2]": ("[1.0, 1.1]", "series.growth.area: expected 3 values, got 2"),
    "1.1, 1.2]": ("1.1, nan]", "expected a finite number, got nan"),
    'title = "A contact"': ("", "own.toml: expected title"),
    "value = 100.0": ('value = "much"', "input.load.value: expected a valid number"),
    "[sources]": ("[sources", "expected TOML"),
    "[series.growth]": (f"deep = {'[' * 100_000}\n[series.growth]", "expected TOML"),
}


def test_what_is_not_stated_is_refused(tmp_path):
    path = tmp_path / "own.toml"
    for old, (new, said) in MISTAKES.items():
        assert old in FILE
        path.write_text(FILE.replace(old, new, 1))
        with pytest.raises(InputError, match=said) as refused:
            experiments.load(path)
        assert "\n" not in str(refused.value)


def test_an_unknown_name_is_told_the_nearest():
    with pytest.raises(InputError, match="try pmma-2018"):
        experiments.load("pmma-2081")
    with pytest.raises(InputError, match="No such file"):
        experiments.load("nowhere.toml")


def test_each_number_that_comes_with_the_package_has_a_source():
    assert set(experiments.names()) == set(COMPARISONS)
    for one in map(experiments.load, experiments.names()):
        assert one.missing
        assert all(number.source in one.sources for number in (*one.inputs.values(), *one.columns.values()))


@pytest.mark.parametrize("name", experiments.names())
def test_numbers_are_printed_in_columns_that_a_terminal_has(name, capsys):
    say_experiment(name)
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 115


def test_the_room_is_one_of_asperity():
    assert vars(asperity).get("experiments", asperity.__getattr__("experiments")) is experiments
