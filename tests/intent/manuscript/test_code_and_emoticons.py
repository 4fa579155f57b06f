"""Tests that code, emoticons and kaomoji are not spoken."""

import random
import re

import pytest

from kinesic.intent.manuscript.acts import load_acts
from kinesic.intent.manuscript.pieces import Manuscript
from kinesic.intent.manuscript.reading import read_manuscript, read_more
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text

CODE_CASES = (  # text with program code, its spoken words, its warnings
    ("~~~\nx = 2\n~~~\nHi", "Hi", ["code is not spoken"]),
    ("Run this:\n~~~py\nx = 2\n~~~\nHi", "Run this Hi", ["code is not spoken: py"]),
    ("Use ~~~x = 2~~~ or ``` y = 3 ``` now", "Use or now", ["code is not spoken: x = 2", "code is not spoken: y = 3"]),
    ("Run:\n```x=2```\nDone.", "Run Done", ["code is not spoken: x=2"]),
    ("~~~x=2~~~ is done.", "is done", ["code is not spoken: x=2"]),
    ("Run ```py\nx = 2\n``` now", "Run now", ["code is not spoken: py"]),
    ("Run ~~~py\nx = 2\n~~~ now", "Run now", ["code is not spoken: py"]),
    ("Run ```\nx = 2\n``` now", "Run now", ["code is not spoken"]),
    ("- ```py\n  x = 2\n  ```\n- Done", "Done", ["code is not spoken: py"]),
    ("So cute~~~ and ~~~ on ~~gone~~ ~5", "So cute and on gone 5", []),
    ("Say ~~~hello~~~ or ```hello``` now", "Say hello or hello now", []),
    ("Title\n~~~~~\nText", "Title Text", []),
    ("Use ``` to begin.\nThen go.", "Use to begin Then go", []),
)
EMOTICON_CASES = (  # text, spoken words, directions, feelings
    ("Hi :-) there (^_^) now ^^.", "Hi there now", [], ["joy", "joy", "joy"]),
    ("Who knows \xaf\\_(\u30c4)_/\xaf today", "Who knows today", ["\U0001f937"], []),
    ("Who knows \xaf\\\\_(\u30c4)_/\xaf today", "Who knows today", ["\U0001f937"], []),
    ("I <3 you, xD", "I you", [], ["love", "joyStrong"]),
    ("No T_T or (;_;) \u0ca0_\u0ca0", "No or", ["\U0001f928"], ["despair", "sadness"]),
    ("Thanks m(_ _)m *really* \\(^o^)/ bye", "Thanks really bye", ["\U0001f647"], []),
    (
        "Wow O_O :-P >_< (\u256f\xb0\u25a1\xb0\uff09\u256f\ufe35 \u253b\u2501\u253b so",
        "Wow so",
        ["\U0001f632"],
        ["anger"],
    ),
    ("Oh (\uff61\u25d5\u25bd\u25d5\uff61) (\u02d8\u25e1\u02d8) yes", "Oh yes", [], []),
    ("Cat or catO_O, x^^2, x<3, a:P (b ^ c) (see p. 3)", "Cat or catO O x 2 x 3 a P b c see p 3", [], []),
)


def feelings(text: str) -> list[str]:
    passage = read_text(text, load_language("en"))
    return [name.removeprefix("emotion-").removeprefix("emotion") for _, name in passage.feelings]


def spoken_words(text: str) -> str:
    return " ".join(word.text for word in read_text(text, load_language("en")).words)


@pytest.mark.parametrize(("text", "words", "warnings"), CODE_CASES)
def test_code_blocks_and_fence_characters_are_not_spoken(text: str, words: str, warnings: list[str]):
    spoken, named = read_manuscript(text)
    assert spoken_words(spoken) == words
    assert list(named) == warnings


@pytest.mark.parametrize(("text", "words", "acts", "shown"), EMOTICON_CASES)
def test_emoticons_are_performed_but_not_spoken(text: str, words: str, acts: list[str], shown: list[str]):
    spoken, _ = read_manuscript(text)
    assert spoken_words(spoken) == words
    assert re.findall(r'<kinesic:act words="([^"]*)"/>', spoken) == acts
    assert feelings(spoken) == shown


@pytest.mark.parametrize("emoticon", load_acts().emoticons)
def test_each_listed_emoticon_is_removed_from_the_spoken_words(emoticon: str):
    spoken, warnings = read_manuscript(f"It is {emoticon} so.")
    assert spoken_words(spoken) == "It is so"
    is_shown = bool(feelings(spoken)) or "kinesic:act" in spoken
    assert is_shown != bool(warnings)


@pytest.mark.parametrize("language", ["de", "fr", "fi"])
def test_heart_emoticon_is_not_spoken_in_german_french_or_finnish(language: str):
    spoken, _ = read_manuscript("Anna <3 Otto")
    assert [word.text for word in read_text(spoken, load_language(language)).words] == ["Anna", "Otto"]


@pytest.mark.parametrize("seed", range(30))
def test_code_and_emoticons_do_not_depend_on_the_chunk_boundaries(seed: int):
    generator = random.Random(seed)
    texts = [case[0] for case in (*CODE_CASES, *EMOTICON_CASES)] + [*load_acts().emoticons]
    text = generator.choice(("\n", " ", "\n\n")).join(generator.sample(texts, 12))
    text = text[: generator.randint(1, len(text))]
    state, spoken, warnings, begin = Manuscript(), "", list[str](), 0
    while begin < len(text):
        end = begin + generator.choice((1, 2, 3, 7, 30))
        state, more, named = read_more(state, text[begin:end])
        spoken, begin, warnings = spoken + more, end, [*warnings, *named]
    _, more, named = read_more(state, "", ends=True)
    assert (spoken + more, (*warnings, *named)) == read_manuscript(text)


@pytest.mark.parametrize("number", ["555-1234", "1/2", "2024-11-30"])
def test_number_in_a_stream_is_spoken_only_when_it_is_complete(number: str):
    for cut in range(1, len(number) + 1):
        state, spoken, _ = read_more(Manuscript(), f"It is {number[:cut]}")
        assert spoken == "It is "
        assert read_more(state, f"{number[cut:]} and")[1] == f"{number} and"
        assert read_more(state, "", ends=True)[1] == number[:cut]
