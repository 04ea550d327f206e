"""The sentences of refusals: each belongs to a test, and reads as all of them do."""

import re

import pytest

from tests.refusals import MESSAGES, messages


@pytest.mark.parametrize("test", messages())
def test_each_sentence_belongs_to_a_test(test):
    file, name = test.split("::")
    folder = MESSAGES.parents[1] if file.startswith("research/") else MESSAGES.parent
    source = (folder / file).read_text(encoding="utf-8")
    body = source.partition(f"def {name}(")[2].partition("\ndef ")[0]
    assert "refuses(" in body


def test_sentences_say_what_was_expected_and_what_came():
    for lines in messages().values():
        for line in lines:
            sentence = line.partition(": ")[2]
            assert len(sentence) < 300
            if not re.search(r"steps shrank|residual|not settle|not finite|exists already|is kept", sentence):
                assert re.search(r": expected .+, got .+", sentence), sentence
