"""Text as people write it becomes spoken words, directions, pauses and warnings."""

import random
import re
import time

import pytest

from kinesic.intent.manuscript.pieces import Manuscript
from kinesic.intent.manuscript.reading import read_manuscript, read_more
from kinesic.intent.reading.language import load_language
from kinesic.intent.reading.words import read_text

ENGLISH = load_language("en")
MIXTURE_COUNT = 400
CUT_SEEDS = range(40)
SENTENCES = (
    "The garden needs water.",
    "She opened the door!",
    "Is it late?",
    "We found 3.5 kg of rice.",
    "Dr. Smith waits.",
    "Mail jo_b@x.org or see a.com.",
)
ELEMENTS = (  # parts of texts that must not be spoken
    "*waves* ",
    "(laughs) ",
    "[nods] ",
    "<sigh> ",
    "*adjusts glasses* ",
    "{laughs} ",
    "{{sighs softly}} ",
    "~waves~ ",
    "\nRobin (laughing): ",
    "\n[ROBIN] ",
    "\n\\begin{align*}\na &= b\n\\end{align*}\n",
    "^start(animations/Stand/Gestures/Hey_1) ",
    "^wait(animations/Stand/Gestures/Hey_1) ",
    "^mode(disabled) ",
    "\\pau=500\\ ",
    "\\\\rspd=80\\\\ ",
    '<bookmark mark="gesture.wave-left-1"/> ',
    '<mark name="m"/> ',
    '<break time="200ms"/> ',
    "<think>Dot hash http://x.y *waves*</think>",
    "\U0001f44b ",
    "\U0001f44d\U0001f3fd ",
    "\U0001f984 ",
    "\U0001f469\u200d\U0001f680 ",
    "\U0001f1fa\U0001f1f8 ",
    ":wave: ",
    ":woman_shrugging:t2: ",
    ":thumbsup::skin-tone-3: ",
    "2\ufe0f\u20e3 ",
    "\x1b[1;31m",
    "<|im_end|> ",
    "<|start_header_id|>assistant<|end_header_id|>\n\n",
    "[/INST] ",
    "\n[00:01:02] ",
    "$\\frac{a}{b}$ ",
    '{"name": "wave", "arguments": {"hand": "left"}} ',
    '<tool_call>\n{"name": "x"}\n</tool_call>\n',
    "<function=wave>{1}</function> ",
    "<|tool_call|>wave(1)<|/tool_call|> ",
    "[happy] ",
    "[emotion: sad] ",
    "&nbsp;",
    "\u200b",
    "https://example.com/k?x=2 ",
    "![picture](a.png) ",
    "`x = 2` ",
    "\n\n```sh\nrm -rf x\n```\n\n",
    "\n\n---\n\n",
    "\n\n# ",
    "\n- ",
    "\n2. ",
    "\n> ",
    "\nALICE: ",
)


START = Manuscript()


def spoken_words(text: str) -> list[str]:
    return [word.text for word in read_text(text, ENGLISH).words]


def directions(text: str) -> list[str]:
    return re.findall(r'<kinesic:act words="([^"]*)"/>', text)


def read_in_parts(text: str, generator: random.Random, state: Manuscript = START) -> tuple[str, tuple[str, ...]]:
    """Return spoken text and warnings of a text in random parts."""
    spoken, warnings, begin = "", (), 0
    while begin < len(text):
        end = begin + generator.choice((1, 1, 2, 3, 7, 30))
        state, more, new = read_more(state, text[begin:end])
        spoken, warnings, begin = spoken + more, (*warnings, *new), end
    _, more, new = read_more(state, "", ends=True)
    return spoken + more, (*warnings, *new)


def mixture(generator: random.Random) -> tuple[str, str]:
    """Return a text of sentences and unspoken elements, and its sentences alone."""
    sentences = generator.choices(SENTENCES, k=8)
    parts = [generator.choice(ELEMENTS) * (generator.random() < 0.7) + sentence for sentence in sentences]
    return " ".join(parts) + " " + generator.choice(ELEMENTS), " ".join(sentences)


def test_markup_in_random_texts_is_never_spoken():
    for seed in range(MIXTURE_COUNT):
        text, plain = mixture(random.Random(seed))
        assert spoken_words(read_manuscript(text)[0]) == spoken_words(plain), text


@pytest.mark.parametrize("seed", CUT_SEEDS)
def test_text_reading_does_not_depend_on_the_chunk_boundaries(seed: int):
    generator = random.Random(seed)
    text, _ = mixture(generator)
    text = text[: generator.randint(1, len(text))]
    whole = read_more(Manuscript(), text, ends=True)[1:]
    assert read_in_parts(text, generator) == whole


@pytest.mark.parametrize(
    ("text", "words", "acts"),
    [
        ("*waves* Hi there! (laughs) Yes.", "Hi there Yes", ["waves", "laughs"]),
        ("Well *shrugs* I see.", "Well I see", ["shrugs"]),
        ("Hello *giggles* nice day, *blushes*.", "Hello nice day", ["giggles", "blushes"]),
        ("Anna says it *smiles* at me.", "Anna says it smiles at me", []),
        ("(The audience applauds.) Thanks.", "Thanks", ["The audience applauds."]),
        (":wave: Hi :thumbsup: at 10:30:15", "Hi at 10:30:15", ["wave", "thumbsup"]),
        ("<|im_start|>assistant\nHi<|im_end|>", "Hi", []),
        ("^pCall(ALMotion.x()) Hi b*c is 5*3", "Hi b c is 5 3", []),
        ("[Narrator]: Once I was", "Once I was", []),
        ("*winkt* Hallo! (schüttelt den Kopf) (rires) Nein.", "Hallo Nein", ["winkt", "schüttelt den Kopf", "rires"]),
        ("(手を振る) こんにちは", "こんにちは", ["手を振る"]),
        ("He said *no* and left.", "He said no and left", []),
        ("{laughs} Yes, she ~bows~ here.", "Yes she here", ["laughs", "bows"]),
        ("The set {1, 2} costs ~20 pounds, ~~not~~ {more}.", "The set 1 2 costs 20 pounds not more", []),
        ("Robin (sighing): It is late.", "It is late", ["sighing"]),
        ("Robin (30): a cook. Note (important): hats.", "Robin 30 a cook Note important hats", []),
        ("[ROBIN]\nHello.\n[NASA] flies.", "Hello NASA flies", []),
        ("\\begin{center}Hi\\end{center} all", "Hi all", []),
        ("The *waves* were high.", "The waves were high", []),
        ("I was *laughing* so hard.", "I was laughing so hard", []),
        ("*Smile* for the camera.", "Smile for the camera", []),
        ("*smiles warmly* Hello. *he nods slowly*", "Hello", ["smiles warmly", "he nods slowly"]),
        ("See the plan (see page three) now.", "See the plan see page three now", []),
        ("It works (takes long).", "It works takes long", []),
        ("(others disagree) Fine.", "others disagree Fine", []),
        ("Is 2 * 3 * 4 more?", "Is 2 3 4 more", []),
        ("A fact [1].", "A fact 1", []),
        ("[00:07] Hello, at [10:30] sharp.", "Hello at 10:30 sharp", []),
        ("Press 1\ufe0f\u20e3 or 12, 3 times.", "Press or 12 3 times", []),
        ("\x1b[32mReady\x1b[0m now", "Ready now", []),
        ("So be it :shrug::skin-tone-2: then", "So be it then", ["shrug"]),
        ("A cat.[^1]\n\n[^1]: A note.", "A cat A note", []),
        ("Hi ^run(a/b/Laugh_1) you", "Hi you", ["Laugh_1"]),
        ("<laugh> So.", "So", ["laugh"]),
        ("a < b and c > d", "a b and c d", []),
        ("ALICE: Hi.\nBOB: Yes.", "Hi Yes", []),
        ("Alice: Hi.\nBob: Yes.", "Hi Yes", []),
        ("NOTE: it works.", "note it works", []),
        ("**Bold** and __more__ of ~~it~~.", "Bold and more of it", []),
        ("A [link](https://a.b/c(d)) and [this][1].\n\n[1]: http://x.y", "A link and this", []),
        ("| a | b |\n|---|---|\n| c | d |", "a b c d", []),
        ("C# and #1 of #fun &amp; games", "C sharp and number 1 of fun games", []),
        ("snake_case \\*not\\* done", "snake case not done", []),
        ("Go to <https://a.b> or www.a.org.", "Go to or", []),
        ("Mail jo_b-2@x-y.org. See a.com/b?c=2_d, too.", "Mail jo b 2 at x y dot org See a dot com too", []),
        ("Ask <jo@x.de>, or [Jo](mailto:j@x.de). In.Out", "Ask jo at x dot de or Jo In Out", []),
        (
            '<speak>Hi <sub alias="World Wide">WW</sub> <say-as interpret-as="date">May</say-as></speak>',
            "Hi World Wide May",
            [],
        ),
    ],
)
def test_markup_is_not_spoken_and_stage_directions_become_behaviours(text: str, words: str, acts: list[str]):
    spoken, _ = read_manuscript(text)
    assert spoken_words(spoken) == words.split()
    assert directions(spoken) == acts


DIALOGUE = "ALICE: Good evening.\nBOB: Yes, it is.\nAnd cold.\n\nAlice (softly): Then come in."


@pytest.mark.parametrize(
    ("character", "words"),
    [("alice", "Good evening Then come in"), ("Bob", "Yes it is And cold"), ("Carol", "")],
)
def test_only_dialogue_lines_of_the_chosen_character_are_spoken(character: str, words: str):
    spoken, warnings = read_manuscript(DIALOGUE, character=character)
    assert spoken_words(spoken) == words.split()
    others = {"ALICE", "BOB"} - {character.upper()}
    assert {warning.split()[2] for warning in warnings} == others
    assert len(warnings) == len(others)
    start = Manuscript(character=character.upper())
    assert read_in_parts(DIALOGUE, random.Random(1), start) == read_more(start, DIALOGUE, ends=True)[1:]
    assert spoken_words(read_in_parts(DIALOGUE, random.Random(2), start)[0]) == words.split()


@pytest.mark.parametrize(
    ("text", "spoken"),
    [
        ("# Plan\n\nWe go", 'Plan.<break time="450ms"/>\nWe go'),
        ("- one\n- two", 'one.<break time="250ms"/>\ntwo'),
        ("Roses are red\nViolets too", 'Roses are red.<break time="250ms"/>\nViolets too'),
        ("Roses\nand more", 'Roses,<break time="250ms"/>\nand more'),
        ("Done.\nNext", "Done.\nNext"),
        (f"{'word ' * 14}\nwraps here", f"{'word ' * 14}\nwraps here"),
        ("\\pau=500\\Hi (pause) you", '<break time="500ms"/>Hi <break time="800ms"/> you'),
        ('Hi<break strength="weak"/> you', 'Hi<break time="200ms"/> you'),
    ],
)
def test_pauses_follow_pause_commands_and_ends_of_short_lines_without_full_stop(text: str, spoken: str):
    assert read_manuscript(text)[0] == spoken


@pytest.mark.parametrize(
    ("text", "warning"),
    [
        ("Hi \U0001f984!", "emoji is not shown: unicorn face"),
        ("See https://a.b/c.", "an address is not spoken: https://a.b/c"),
        ("\\style=soft\\ Hi", "command of another system is not performed: \\style=soft\\"),
        ("```sh\nx\n```", "code is not spoken: sh"),
        ('<mark name="m"/>Hi', "nothing happens at the mark m"),
        ("<voice>Hi</voice>", "<voice> is not performed, its words are spoken"),
        ("<think>Hi", "</think> is missing: nothing after the opening tag is spoken"),
    ],
)
def test_each_omitted_part_of_a_text_gives_one_warning(text: str, warning: str):
    assert read_manuscript(text)[1] == (warning,)


def test_word_of_a_streamed_text_is_spoken_before_the_next_word_arrives():
    assert read_more(Manuscript(), "I want to")[1] == "I want to"


def test_long_text_with_thousands_of_unclosed_marks_is_read_within_5_seconds():
    began = time.process_time()
    spoken, _ = read_manuscript("The garden needs water today. " * 3000 + "-" * 4000 + "*" + "(" * 4000)
    assert spoken.startswith("The garden")
    assert time.process_time() - began < 5.0


def read_in_pieces(text: str, length: int) -> tuple[str, tuple[str, ...]]:
    """Return spoken text and warnings of a text that comes in pieces."""
    state, spoken, warnings = Manuscript(), "", ()
    for begin in range(0, len(text), length):
        state, said, named = read_more(state, text[begin : begin + length])
        spoken, warnings = spoken + said, (*warnings, *named)
    _, said, named = read_more(state, "", ends=True)
    return spoken + said, (*warnings, *named)


@pytest.mark.parametrize(
    ("text", "spoken", "warning"),
    [
        ("---\ntitle: Rain\ntags: [a, b]\n---\nIt rains.", "It rains", "settings"),
        ("---\nIt rains: a lot.\n---\nGood.", "It rains a lot Good", ""),
        ("It rains.</spea", "It rains", "</spea"),
        ("It rains. <prosody rate='sl", "It rains", "<prosody"),
        ("<details><summary>Rain</summary>It rains.</details>", "Rain It rains", ""),
    ],
)
def test_front_matter_truncated_tags_and_html_elements_are_not_spoken(text: str, spoken: str, warning: str):
    whole = read_manuscript(text)
    assert " ".join(word.text for word in read_text(whole[0], ENGLISH).words) == spoken
    assert [warning in each for each in whole[1]] == [True] * bool(warning)
    assert "kinesic:act" not in whole[0]
    for length in (1, 2, 3, 7):
        assert read_in_pieces(text, length) == whole
