"""Tests that prosody tags change the voice for the tagged words only."""

import random
import re

import pytest

from kinesic.bml.actions import Speech
from kinesic.bml.parse import parse
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author_text
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.reading.language import load_language
from kinesic.intent.talk import Talk, add_words, next_part

MIXED = (
    '<speak>Hello <prosody rate="slow" pitch="+10%">my dear <prosody volume="loud">friend.</prosody> We go '
    "home.</prosody> It rains. \\\\rspd=80\\\\ The dog waits. \\\\vol=50\\\\ Look there. \\\\rst\\\\ Good.</speak>"
)
EXPECTED = [
    ("my dear friend. We go home.", {"rate": "slow", "pitch": "+10%"}),
    ("friend.", {"volume": "loud"}),
    ("The dog waits. Look there.", {"rate": "80%"}),
    ("Look there.", {"volume": "50%"}),
]


def spoken_prosody(bml: str) -> list[tuple[str, tuple[tuple[str, str], ...]]]:
    """Return each spoken word with its prosody."""
    [action] = [behaviour.action for behaviour in parse(bml).behaviours if isinstance(behaviour.action, Speech)]
    script, word_attributes, at = action.script, [], 0
    for word in script.text.split():
        at = script.text.index(word, at)
        inside = {name: value for e in script.emphases if e.begin <= at < e.end for name, value in e.attributes}
        word_attributes.append(
            (word, tuple(sorted((name, value) for name, value in inside.items() if name != "level")))
        )
        at += len(word)
    return word_attributes


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


def expected_prosody() -> list[tuple[str, tuple[tuple[str, str], ...]]]:
    words = re.sub(r"<[^<>]*>|\\\\[^\\]*\\\\", " ", MIXED).split()
    spoken = " ".join(words)
    results = []
    for k, word in enumerate(words):
        at = len(" ".join(words[:k])) + bool(k)
        values = {
            name: value
            for part, attributes in EXPECTED
            if spoken.index(part) <= at < spoken.index(part) + len(part)
            for name, value in attributes.items()
        }
        results.append((word, tuple(sorted(values.items()))))
    return results


def test_prosody_tags_of_a_text_reach_the_voice_for_their_words(lexicon: Lexicon):
    written = author_text(MIXED, lexicon, Style.load("neutral"))
    assert spoken_prosody(written.bml) == expected_prosody()
    assert written.warnings == ()


def test_prosody_continues_across_the_parts_of_a_streamed_text(lexicon: Lexicon):
    generator, talk, rest, results = random.Random(3), Talk(), MIXED, []
    language, style, sets = load_language("en"), Style.load("neutral"), builtin_sets()
    while True:
        size = generator.choice((1, 3, 20))
        talk, rest = add_words(talk, rest[:size], ends=len(rest) <= size), rest[size:]
        while (part := next_part(talk, lexicon, style, language, sets)) is not None:
            talk = part.talk
            results += spoken_prosody(part.write("b"))
        if not rest:
            break
    assert results == expected_prosody()


@pytest.mark.parametrize("attributes", ["", ' contour="(0%,+20Hz)"', ' rate="; drop"'])
def test_unsupported_prosody_tag_is_reported(lexicon: Lexicon, attributes: str):
    written = author_text(f"Hello <prosody{attributes}>there</prosody>, you.", lexicon, Style.load("neutral"))
    assert written.warnings == ("<prosody> has no rate, pitch or volume that the voice knows",)
    assert all(not values for _, values in spoken_prosody(written.bml))
