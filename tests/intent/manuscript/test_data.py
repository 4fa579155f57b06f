"""Tests of formulas, data, function calls and LaTeX commands within a text."""

import random
import re

import pytest

from kinesic.intent.manuscript.pieces import Manuscript
from kinesic.intent.manuscript.reading import read_manuscript, read_more
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text

CASES = (  # text, spoken words, stage directions
    ("The area is $a^2$, $x$ or $$\\frac{a}{b}$$ here.", "The area is a 2 x or here", []),
    ("So \\(x_1 = 2\\) or \\[ \\int x \\] (or \\(not\\)).", "So x 1 2 or or not", []),
    ("It costs $5 and $10.50, not $3.", "It costs 5 and 10.50 not 3", []),
    ("\\begin{itemize}\\item One \\textbf{two}\\cite{three} 5\\%\\end{itemize}", "One two 5%", []),
    ('Yes. {"name": "wave", "arguments": {"hand": "}"}} Fine.', "Yes Fine", []),
    ('{"say": "Hello there.", "gesture": "wave"}', "Hello there", []),
    ('[TOOL_CALLS] [{"name": "x"}]\nHello.', "Hello", []),
    ('A {brace} and [1] and {"open', "A brace and 1 and open", []),
    ("<function=wave>{1}</function> Hello.", "Hello", []),
    ("<|tool_call|>wave(1)<|/tool_call|> Hello.", "Hello", []),
    ("<|tool_call_begin|>wave(1)<|tool_call_end|> Hello.", "Hello", []),
    ("<tool_response>20</tool_response> Hello. <desc>noise</desc>", "Hello", []),
    ("<table><tr><td>A</td><td>B</td></tr></table> Hello.", "A B Hello", []),
    ("Open C:\\Users\\Jo\\notes.txt now.", "Open C Users Jo notes txt now", []),
    ("[happy] Hello. [emotion: sad] So [pause: 2s] it is.", "Hello So it is", ["happy", "sad"]),
    ("[emotion: sad] Yes.\nANNA: No.", "Yes No", ["sad"]),
    ("I was [quite] happy.", "I was quite happy", []),
)


def spoken_words(text: str) -> str:
    return " ".join(word.text for word in read_text(text, load_language("en")).words)


@pytest.mark.parametrize(("text", "words", "acts"), CASES)
def test_data_and_formulas_in_a_text_are_replaced_by_words_or_omitted(text: str, words: str, acts: list[str]):
    spoken, _ = read_manuscript(text)
    assert spoken_words(spoken) == words
    assert re.findall(r'<kinesic:act words="([^"]*)"/>', spoken) == acts


@pytest.mark.parametrize("seed", range(20))
def test_data_and_formulas_do_not_depend_on_the_chunk_boundaries(seed: int):
    generator = random.Random(seed)
    text = " ".join(generator.sample([text for text, _, _ in CASES], 6)) + "\nUser: Bye"
    state, spoken, begin = Manuscript(), "", 0
    while begin < len(text):
        end = begin + generator.choice((1, 2, 3, 7, 30))
        state, more, _ = read_more(state, text[begin:end])
        spoken, begin = spoken + more, end
    assert spoken + read_more(state, "", ends=True)[1] == read_manuscript(text)[0]


@pytest.mark.parametrize("text", ["It costs $5 and", "It costs $5, and", "A {brace} and", "a [b] and"])
def test_streamed_text_after_a_price_or_bracket_is_spoken_at_once(text: str):
    assert spoken_words(read_more(Manuscript(), text)[1]).endswith("and")
