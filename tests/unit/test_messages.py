"""The sentences of refusals: each belongs to a test, and reads as all of them do."""

import re

from tests.refusals import MESSAGES, messages


def test_each_sentence_belongs_to_a_test_and_says_what_was_expected_and_what_came():
    for test, lines in messages().items():
        file, name = test.split("::")
        folder = MESSAGES.parents[1] if file.startswith("research/") else MESSAGES.parent
        source = (folder / file).read_text(encoding="utf-8")
        assert "refuses(" in source.partition(f"def {name}(")[2].partition("\ndef ")[0], test
        for line in lines:
            sentence = line.partition(": ")[2]
            assert len(sentence) < 300
            if not re.search(r"steps shrank|residual|not settle|not finite|exists already|is kept", sentence):
                assert re.search(r": expected .+, got .+", sentence), sentence
