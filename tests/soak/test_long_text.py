"""Streamed text of 20 000 words in simulated time."""

from dataclasses import replace
from pathlib import Path

import pytest

from kinesic.bench.meaning.sentences import prose
from kinesic.planning.setup import Setup
from kinesic.realizer.contention import with_busy_hands
from kinesic.realizer.realizer import Scene, advance, begin, prepare_block
from kinesic.realizer.request import Message, read_request
from kinesic.serve.messages import Words
from kinesic.serve.talks import Phrase, Talks
from kinesic.session.setup import set_up

pytestmark = pytest.mark.soak

SENTENCE_COUNT = 1770  # number of sentences with 20 000 words together
PARAGRAPH_LENGTH = 6  # number of sentences per paragraph
WARM_PHRASES = 200  # number of phrases after which memory growth is measured
MAX_GROWTH = 40e6  # [bytes] largest growth of resident memory after the first phrases
TICK_PERIOD = 0.02  # [s] shortest simulated time step
MAX_STEP = 5.0  # [s] longest simulated time step
PARAGRAPH_GAP = 0.9  # [s] longest silence between two paragraphs
GAP_TOLERANCE = 0.02  # [s] tolerance of silences between phrases


def resident_memory() -> float:
    """Return the resident memory of this process [bytes]."""
    return float(Path("/proc/self/statm").read_text().split()[1]) * 4096


def perform(scene: Scene, phrase: Phrase, now: float) -> Scene:
    """Start the block of a phrase as the planner does."""
    scene = phrase.scene_change(scene, now) if phrase.replaced else scene
    request = read_request(Message(phrase.bml, 1, "<words>"), scene.setup, context=scene.context(now))
    prepared = prepare_block(with_busy_hands(scene, request), scene.setup)
    return begin(replace(scene, outgoing_feedback=(), ahead=0.1), prepared, now)


def stream(text: str, setup: Setup) -> tuple[list[str], list[float], list[float]]:
    """Return a streamed text's phrases, gaps between them [s] and memory [bytes]."""
    talks, scene, now = Talks(), Scene.of(setup), 0.0
    phrases, gaps, memory, last_end = list[str](), list[float](), list[float](), None
    talks.take(Words(text, 1, ends=True), now)
    while not list(talks.finished(setup)):
        while (phrase := talks.next_phrase(scene, now)) is not None:
            scene = perform(scene, phrase, now)
            speech = max(scene.speeches, key=lambda each: each.end)
            gaps += [] if last_end is None else [speech.begin - last_end]
            last_end = speech.end
            phrases.append(phrase.text)
            memory.append(resident_memory())
        now = max(now + TICK_PERIOD, min(scene.next_time, talks.next_time(scene), now + MAX_STEP))
        scene = advance(replace(scene, outgoing_feedback=(), replans=()), now)
    return phrases, gaps, memory


def test_long_text_streams_with_bounded_memory_growth_and_bounded_gaps():
    sentences = prose(SENTENCE_COUNT, 1)
    starts = range(0, SENTENCE_COUNT, PARAGRAPH_LENGTH)
    text = "\n\n".join(" ".join(sentences[k : k + PARAGRAPH_LENGTH]) for k in starts)
    phrases, gaps, memory = stream(text, set_up(idle=1.0, variation=1.0))
    assert sum(len(phrase.split()) for phrase in phrases) > 0.98 * len(text.split())
    assert max(memory) - memory[WARM_PHRASES] < MAX_GROWTH
    assert max(gaps) < PARAGRAPH_GAP + GAP_TOLERANCE
