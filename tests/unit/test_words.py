"""Pages are short, so are their sentences, and a measured number says when it was measured."""

import re

import pytest

from tests.named import ROOT

PAGES = {
    str(page.relative_to(ROOT)): page.read_text(encoding="utf-8")
    for page in (
        *(ROOT / name for name in ("README.md", "CONTRIBUTING.md")),
        *sorted((ROOT / "docs").glob("*.md")),
        *sorted((ROOT / "docs" / "studies").glob("*.md")),
    )
}
LONGEST_PAGE, LONGEST_SENTENCE, ALL_PAGES = 2000, 35, 34_000

MEASURED = r"benchmarks/\w+\.(?:py|sh)|data/studies|AMD EPYC|NVIDIA|busy machine"
"""Scripts and machines, of which a page speaks that has measured numbers."""

DATED = r"(?:[Vv]ersions?|Asperity) 0\.\d+\.\d+|\(0\.\d+\.\d+|20\d\d-\d\d-\d\d"

UNDATED = {
    *("CONTRIBUTING.md", "docs/design.md"),  # they name scripts, and no numbers
    "docs/units.md",  # test_docs computes its tables anew
}


def words(text):
    """How many words a text has; the bars of a table are none."""
    return len(re.findall(r"\S*\w\S*", text))


def sentences(page):
    """Sentences of a page: code, tables, headings and formulas aside; a bullet is a paragraph of its own."""
    text = re.sub(r"^(```|:::).*\n(?:.*\n)*?\1 *$", "", page, flags=re.MULTILINE)
    lines = [line for line in text.splitlines() if not line.startswith(("|", "    ", "#", "!["))]
    text = "\n".join(f"\n{line}" if re.match(r" *- |\d+\. |: ", line) else line for line in lines)
    for paragraph in re.split(r"\n\s*\n", text):
        yield from re.split(r"(?<=[.!?:;])[\"')*]*\s+(?=[^a-z\s])", " ".join(paragraph.split()))


def long_sentences(page):
    return [one for one in sentences(page) if words(one) > LONGEST_SENTENCE]


@pytest.mark.parametrize("name", PAGES)
def test_pages_and_their_sentences_are_short(name):
    assert words(PAGES[name]) <= LONGEST_PAGE
    assert not long_sentences(PAGES[name])


def test_the_documentation_is_short():
    pages = (page for name, page in PAGES.items() if re.fullmatch(r"docs/\w+\.md", name))
    assert sum(len(page.split()) for page in pages) <= ALL_PAGES  # as wc -w counts


def test_a_long_sentence_is_found():
    table, beginning, end = f"| {'table ' * 40}|", "word " * 20, "word " * 36 + "end."
    assert [words(one) for one in long_sentences(f"# A\n\n{table}\n\n{beginning}`code`, {end}\n\n- B.")] == [
        58
    ]
    assert not long_sentences("word " * 30 + "end. " + "Word " * 30 + "\n- " + "word " * 30)


@pytest.mark.parametrize(
    "name", sorted(name for name in PAGES if name not in UNDATED and re.search(MEASURED, PAGES[name]))
)
def test_a_measured_number_says_when_it_was_measured(name):
    assert re.search(DATED, PAGES[name])
