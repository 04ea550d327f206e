"""Tables of studies, made of their numbers: no page repeats a number.

``{ledger} NAME`` shows the claims of a study with their verdicts and numbers. ``{rows} NAME/TABLE`` shows a
table: its first line is the head, its second the form of a row, in which ``{B:4}`` is B with its interval, to
four digits.
"""

import math
from itertools import groupby

import pandas as pd
from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList

from reference import DOCS

STUDIES = DOCS / "data" / "studies"
LEDGER = """
**{claim}** ({place}): **{verdict}**

| measured{confirmed} | value [95 % interval] | surfaces | verdict |
|---|---|---|---|
"""


class Number(float):
    """A number that may have an interval; a format of one digit is that many decimals, of both."""

    interval = None

    def __format__(self, form):
        if math.isnan(self):
            return "–"
        if not form.isdigit():
            return super().__format__(form)
        value, *ends = (f"{end + 0.0:.{form}f}" for end in (float(self), *(self.interval or ())))
        return f"{value} [{', '.join(ends)}]" if ends else value


def numbers_of(record):
    """The row of a table, with numbers that know their intervals: x_low and x_high, or low and high.

    Numbers with an interval are left out where the table says that they are not determined.
    """
    row = dict(record)
    determined = record.get("determined", True)
    for name, value in record.items():
        if isinstance(value, float):
            low, high = ("low", "high") if name in ("value", "slope") else (f"{name}_low", f"{name}_high")
            row[name] = Number(value if determined or low not in record else math.nan)
            if low in record:
                row[name].interval = record[low], record[high]
    return row


def verdict_of(row):
    """What one number says of the range that confirms its claim."""
    if row["range_low"] <= row["low"] and row["high"] <= row["range_high"]:
        return "agrees"
    return "differs" if row["high"] < row["range_low"] or row["low"] > row["range_high"] else "undecided"


def ledger(name):
    """Claims of a study: each with its source and verdict, and the numbers that decide."""
    table = pd.read_csv(STUDIES / name / "ledger.csv", keep_default_na=False, na_values=[""])
    lines = []
    for (claim, place, verdict), rows in groupby(
        table.to_dict("records"), key=lambda row: (row["claim"], row["place"], row["verdict"])
    ):
        rows = list(rows)
        low, high = rows[0]["range_low"], rows[0]["range_high"]
        confirmed = f"at most {high:g}" if math.isinf(low) else f"at least {low:g}"
        confirmed = confirmed if math.isinf(low) or math.isinf(high) else f"{low:g} to {high:g}"
        lines += LEDGER.format(
            claim=claim.rstrip("."), place=place, verdict=verdict, confirmed=f", confirmed by {confirmed}"
        ).splitlines()
        lines += [
            "| {what} | {value:3} | {runs} | {own} |".format_map(numbers_of(row) | {"own": verdict_of(row)})
            for row in rows
        ]
    return lines


def rows(path, content):
    """A table of a study: the head and the form of a row are given."""
    head, form = content
    table = pd.read_csv(STUDIES / f"{path}.csv")
    rule = "|" + "---|" * (head.count("|") - 1)
    return [head, rule, *(form.format_map(numbers_of(row)) for row in table.to_dict("records"))]


class Ledger(Directive):
    """The claims of a study."""

    required_arguments = 1

    def lines(self):
        """Return the table in Markdown."""
        return ledger(self.arguments[0])

    def run(self):
        """Return the table as nodes."""
        self.state.document.settings.env.note_dependency(str(STUDIES / self.arguments[0].split("/")[0]))
        container = nodes.container()
        self.state.nested_parse(StringList(self.lines()), self.content_offset, container)
        return container.children


class Rows(Ledger):
    """A table of a study."""

    has_content = True

    def lines(self):
        """Return the table in Markdown."""
        return rows(self.arguments[0], [line for line in self.content if line.strip()])


def setup(app):
    """Tell Sphinx."""
    app.add_directive("ledger", Ledger)
    app.add_directive("rows", Rows)
    return {"parallel_read_safe": True}
