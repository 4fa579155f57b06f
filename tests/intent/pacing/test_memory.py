"""Tests that chosen gestures are remembered across turns, without hidden state."""

import pytest

from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.intent.author import author_text
from kinesic.intent.behaviours import ChosenBehaviour
from kinesic.intent.intents import Intent, Moment
from kinesic.intent.pacing.memory import NO_MEMORY, REPEAT_WINDOW, ChoiceMemory, PastGesture

DENIALS = ("I did not say that.", "She never called me.", "We cannot sell the house.", "Nobody saw the dog.")


@pytest.fixture(scope="module")
def lexicon() -> Lexicon:
    return Lexicon.load()


def perform_turns(lexicon: Lexicon, seed: int) -> tuple[list[str], ChoiceMemory]:
    """Return the BML of successive turns, and the memory after them."""
    memory, written = NO_MEMORY, []
    for text in DENIALS:
        turn = author_text(text, lexicon, Style.load("neutral"), seed=seed, memory=memory)
        written.append(turn.bml)
        memory = turn.memory
    return written, memory


@pytest.mark.parametrize("seed", range(4))
def test_no_gesture_is_repeated_over_the_turns_of_one_conversation(lexicon: Lexicon, seed: int) -> None:
    _, memory = perform_turns(lexicon, seed)
    names = [past.form for past in memory.gestures]
    assert len(names) >= len(DENIALS)
    assert len(set(names)) == len(names)


def test_same_history_text_and_seed_give_the_same_bml(lexicon: Lexicon) -> None:
    assert perform_turns(lexicon, 1)[0] == perform_turns(lexicon, 1)[0]
    first, second = (perform_turns(lexicon, seed)[0] for seed in (1, 2))
    assert first != second


def test_gesture_memory_drops_gestures_older_than_a_minute_of_speech() -> None:
    memory = ChoiceMemory((PastGesture("beat", 10.0, "old"), PastGesture("large", 50.0, "new")), 55.0, 2)
    later = memory.extend((), REPEAT_WINDOW - 50.0, pause=5.5)
    assert [past.form for past in later.gestures] == ["large"]
    assert (later.seconds, later.parts) == (70.5, 3)


def test_gesture_memory_forgets_gestures_that_were_not_performed() -> None:
    moment = Moment("s:w1", 1.0)
    beat, large = (
        ChosenBehaviour("gesture", lexeme, Intent("rhythm", moment, moment, moment, 0.5, "a test"))
        for lexeme in ("beat", "large")
    )
    memory = NO_MEMORY.extend((beat, large), 5.0)
    assert [past.form for past in memory.forget((beat,)).gestures] == ["large"]
    assert [past.form for past in memory.extend((), 1.0, replaced=(large,)).gestures] == ["beat"]
    assert memory.forget(()) is memory
