"""Tests that the voice utters the written words, without names of punctuation."""

import os
import random
from pathlib import Path

import pytest

from kinesic.bml.actions import Speech
from kinesic.bml.block import BmlError
from kinesic.bml.parse import parse
from kinesic.body.utterance import Emphasis, Mark, Pause, Script, Stress
from kinesic.intent.fml.author import is_fml, parse_fml
from kinesic.speech.espeak import Espeak

from .heard import heard_consonants, plain_words

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
SAMPLE_STEP = 15  # every fifteenth document is spoken in a run
SENTENCE_COUNT = 30  # number of sentences in a mixture
MIXTURE_COUNT = 4  # number of mixtures spoken in a run
SAMPLE_WORDS = ("apple", "never", "house", "garden", "seven", "mark", "people", "table", "finger", "lemon")
# punctuation at the end of a sentence
SENTENCE_ENDS = (".", ".", ".", "..", "...", "!", "?", "?!", " .", ". .", "! !", "\u2026")
# signs before and after a word
QUOTE_PAIRS = (("", ""), ('"', '"'), ("(", ")"), ("[", "]"), ("\u201c", "\u201d"), ("'", "'"), ("", " \U0001f600"))
SPOKEN_SIGNS = {"": "", " %": "percent", "\xb0": "degrees", " +": "plus"}  # sign after a number -> its word


def corpus_scripts(step: int) -> list[Script]:
    scripts: dict[Script, None] = {}
    for path in sorted(CORPUS_FOLDER.rglob("*.xml"))[::step]:
        document = path.read_bytes()
        try:
            block = parse_fml(document) if is_fml(document) else parse(document)
        except BmlError:
            continue
        scripts |= {
            behaviour.action.script: None for behaviour in block.behaviours if isinstance(behaviour.action, Speech)
        }
    return [script for script in scripts if script.text.strip()]


@pytest.mark.skipif(not CORPUS_FOLDER.is_dir(), reason="no corpus; set KINESIC_CORPUS")
@pytest.mark.parametrize("step", [SAMPLE_STEP, pytest.param(1, marks=pytest.mark.soak)])
def test_corpus_texts_with_markup_sound_like_their_plain_words(espeak: Espeak, step: int):
    scripts = corpus_scripts(step)
    assert len(scripts) > 50 / step
    for script in scripts:
        assert heard_consonants(script) == heard_consonants(plain_words(script.text)), script.text


def mixture(generator: random.Random) -> tuple[Script, str]:
    """Return a random script of sentences with elements, and its plain words."""
    text, plain = "", list[str]()
    marks, pauses, emphases = list[Mark](), list[Pause](), list[Emphasis]()
    for _ in range(SENTENCE_COUNT):
        before, last = generator.sample(SAMPLE_WORDS, 2)
        sign = generator.choice(tuple(SPOKEN_SIGNS))
        left, right = generator.choice(QUOTE_PAIRS)
        number = "7" * bool(sign)
        text += f"{generator.choice((before, before.title()))} "
        begin = len(text)
        text += left + (number or last) + sign + right
        element = generator.choice(("none", "mark", "pause", "emphasis", "prosody", "voice"))
        if element == "mark":
            marks.append(Mark(f"m{len(text)}", len(text)))
        elif element == "pause":
            pauses.append(Pause(len(text), 0.02))
        elif element != "none":
            kinds: dict[str, tuple[Stress, tuple[tuple[str, str], ...]]] = {
                "emphasis": ("emphasis", (("level", "strong"),)),
                "prosody": ("prosody", (("rate", "fast"),)),
                "voice": ("voice", (("xml:lang", "en-us"),)),
            }
            kind, attributes = kinds[element]
            emphases.append(Emphasis(begin, len(text), kind, attributes))
        text += generator.choice(SENTENCE_ENDS) + generator.choice((" ", "\n", "  "))
        plain += [before, "seven" if number else last, *filter(None, [SPOKEN_SIGNS[sign]])]
    trimmed = text.rstrip() if generator.random() < 0.5 else text
    return Script(trimmed, tuple(marks), pauses=tuple(pauses), emphases=tuple(emphases)), " ".join(plain)


@pytest.mark.parametrize("seed", range(MIXTURE_COUNT))
def test_voice_never_speaks_the_names_of_punctuation_marks(espeak: Espeak, seed: int):
    script, plain = mixture(random.Random(seed))
    assert heard_consonants(script) == heard_consonants(Script(plain))


@pytest.mark.parametrize("sign", "#$%&*+/;=@\\^|~\u2013\xd7\xf7\xb1\u2260\u2192\u2022\xa7\xb0\u20ac\xa3\xb2")
def test_full_stop_after_a_word_with_a_symbol_is_not_spoken(espeak: Espeak, sign: str):
    text = f"The sun{sign}moon"
    assert heard_consonants(Script(f"{text}.")) == heard_consonants(Script(text))


@pytest.mark.parametrize("text", ["It rains.Then we go.", "Wow!So note:this is it?Then go."])
def test_punctuation_without_a_space_after_it_is_not_spoken(espeak: Espeak, text: str):
    assert heard_consonants(Script(text)) == heard_consonants(plain_words(text.replace(".Then", ". Then")))
