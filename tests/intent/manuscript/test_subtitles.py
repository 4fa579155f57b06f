"""Tests of subtitles in files and texts, whole and streamed in parts."""

import random

import pytest

from kinesic.intent.manuscript.pieces import Manuscript, SubtitleState
from kinesic.intent.manuscript.reading import read_manuscript, read_more
from kinesic.intent.manuscript.subtitles import read_more_subtitles, read_subtitles

from ...naming import about

SUBRIP = (
    "1\r\n00:00:01,000 --> 00:00:02,000\r\n<i>Hello</i>\r\nthere.\r\n\r\n2\r\n00:00:04,500 --> 00:00:06,000\r\nBye.\r\n"
)
WEBVTT = (
    "WEBVTT - a film\nKind: captions\n\nNOTE x\ny\n\n00:01.000 --> 00:02.000 align:left\n<v Ann>Hello\nthere.\n\n"
    "second scene\n00:04.500 --> 00:06.000\nBye.\n"
)
FRAGMENTS = (
    *SUBRIP.splitlines(keepends=True),
    *WEBVTT.splitlines(keepends=True),
    "\n", "\r\n", "\r", " \t\n", "42\n", "42", "7 cats ", "Read this: ", "Thank you.\n", "10:30 ", "00:00:01,0",
    "00:01.000 --> 00:02.000\n", " --> ", "- Ready?\n- Yes.\n", "\u266a La la \u266a\n", "Tom &amp; Ann\n",
    "```\n", "NOTE that.\n", "WEB", "*waves* ", "ANN: Hi.\n", "x" * 1005,
)  # fmt: skip
CUT_SEEDS = range(150)


def read_in_parts(text: str, generator: random.Random) -> str:
    """Return the spoken text of subtitles that arrive in random parts."""
    state, spoken, begin = SubtitleState(), "", 0
    while begin < len(text):
        length = generator.choice((1, 1, 2, 3, 8, 40, 2000))
        state, words = read_more_subtitles(state, text[begin : begin + length])
        spoken, begin = spoken + words, begin + length
    return spoken + read_more_subtitles(state, "", ends=True)[1]


@pytest.mark.parametrize("subtitles", [SUBRIP, WEBVTT, SUBRIP.replace("\r\n", "\r")])
def test_subtitles_are_spoken_with_their_pauses(subtitles: str):
    assert read_subtitles(subtitles) == 'Hello there.\n<break time="2500ms"/>Bye.'


def test_subtitles_within_a_text_are_spoken_without_numbers_times_and_signs():
    text = (
        "Please read this:\n1\n00:00:01,000 --> 00:00:02,000\n- Ready?\n- Yes.\n\n"
        "2\n00:00:02,000 --> 00:00:03,000\n\u266a La la \u266a\n\nThank you."
    )
    assert read_subtitles(text) == "Please read this:\nReady?\nYes.\nLa la\nThank you."
    assert read_subtitles("WEBVTT\n\nNOTE by me\n\n00:01.000 --> 00:02.000\nHi.") == "Hi."


def test_subtitles_without_empty_lines_between_them_are_separate():
    text = "1\n00:00:01,000 --> 00:00:02,000\nOne.\n2\n00:00:03,000 --> 00:00:04,000\nTwo."
    assert read_subtitles(text) == 'One.\n<break time="1000ms"/>Two.'


def test_subtitle_without_words_extends_the_pause():
    times = "00:00:01,000 --> 00:00:02,000\nA.\n\n00:00:03,000 --> 00:00:04,000\n<i></i>\n\n"
    assert read_subtitles(f"{times}00:00:05,000 --> 00:00:06,000\nB.") == 'A.\n<break time="3000ms"/>B.'


@pytest.mark.parametrize(
    "text",
    [
        "It goes from 00:01:00,000 to 00:02:00,000 --> then it stops.",
        "What is it?\n42\n\nYes.\n",
        "WEBVTT is a format",
        "1984\nwas a year.",
        "NOTE this.\n\nREGION of note.",
    ],
)
def test_text_without_subtitles_passes_unchanged(text: str):
    assert read_subtitles(text) == text


def test_code_fence_ends_a_subtitle():
    assert read_subtitles("```\n1\n00:00:01,000 --> 00:00:02,000\nHi.\n```\nBye.") == "```\nHi.\n```\nBye."


def test_subtitles_streamed_in_random_chunks_are_read_like_whole_subtitles():
    for seed in CUT_SEEDS:
        generator = random.Random(seed)
        text = "".join(generator.choices(FRAGMENTS, k=generator.randrange(2, 30)))
        with about(f"seed {seed}"):
            assert read_in_parts(text, generator) == read_subtitles(text)


@pytest.mark.parametrize("text", [SUBRIP, WEBVTT, f"Read this:\n\n{SUBRIP}\nThank you."])
def test_subtitles_streamed_word_by_word_give_the_same_speech_text_as_whole_subtitles(text: str):
    state, spoken = Manuscript(), ""
    for word in text.split(" "):
        state, words, _ = read_more(state, f"{word} ")
        spoken += words
    spoken += read_more(state, "", ends=True)[1]
    assert "-->" not in spoken
    assert spoken.split() == read_manuscript(text)[0].split()


def test_streamed_words_that_are_no_subtitles_are_returned_immediately():
    state, spoken = read_more_subtitles(SubtitleState(), "Well")
    assert spoken == "Well"
    assert read_more_subtitles(state, " 3 cats")[1] == " 3 cats"


def test_streamed_words_after_subtitles_are_returned_immediately():
    state, _ = read_more_subtitles(SubtitleState(), SUBRIP + "\n")
    assert read_more_subtitles(state, "Thank you")[1] == "\nThank you"
