"""Own speech of a conversation, and the times at which it must be advanced."""

from math import inf
from types import SimpleNamespace

import pytest

from kinesic.conversation.events import Conversing, RobotSpeech
from kinesic.planning.setup import Setup
from kinesic.serve.conversing import Conversation
from kinesic.serve.messages import ConversationRequest
from tests.serve.planning_bench import Planning


@pytest.fixture
def scene(known: Setup) -> SimpleNamespace:
    return SimpleNamespace(speeches=(), setup=known, foreign_sound=None)


@pytest.fixture
def conversation(scene: SimpleNamespace) -> Conversation:
    return Conversation(SimpleNamespace(scene=scene), shows_eyes=False)


def speech(begin: float, end: float, block: str = "b") -> SimpleNamespace:
    return SimpleNamespace(begin=begin, end=end, block=block)


def test_conversation_learns_the_end_of_the_last_overlapping_speech_of_the_robot_once_per_change(conversation, scene):
    scene.speeches = (speech(1.0, 4.0), speech(2.0, 3.0), speech(9.0, 12.0))
    assert conversation._own_speech(0.9) is None
    assert conversation._own_speech(1.0) == RobotSpeech(active=True, ends_in=3.0)
    assert conversation._own_speech(2.5) is None, "the expected end has not changed"
    scene.speeches = (speech(1.0, 4.0), speech(2.0, 4.5))
    assert conversation._own_speech(3.0) == RobotSpeech(active=True, ends_in=1.5)
    scene.speeches = (speech(2.0, 4.54),)
    assert conversation._own_speech(3.1) is None, "the expected end has changed by less than 50 ms"
    assert conversation._own_speech(4.54) == RobotSpeech(active=False)
    assert conversation._own_speech(5.0) is None


def test_short_pause_between_two_phrases_does_not_end_the_speech_of_the_robot(conversation, scene):
    scene.speeches = (speech(1.0, 4.0), speech(4.9, 6.0), speech(7.5, 9.0))
    assert conversation._own_speech(0.5) is None, "the robot has not begun to speak"
    assert conversation._own_speech(2.0) == RobotSpeech(active=True, ends_in=2.0)
    assert conversation._own_speech(4.0) == RobotSpeech(active=True, ends_in=2.0)
    assert conversation._own_speech(6.0) == RobotSpeech(active=False)


def test_filler_word_is_not_reported_to_the_conversation_as_speech_of_the_robot(conversation, scene):
    scene.speeches = (speech(1.0, 4.0, "filler-3"),)
    assert conversation._own_speech(2.0) is None


def test_conversation_is_advanced_at_the_next_start_or_end_of_a_speech(planning: Planning):
    state = planning.state
    assert state._conversation.next_time(0.0) == inf
    state.execute(ConversationRequest(Conversing(on=True), 5))
    conversation = state._conversation
    assert conversation.is_on
    assert conversation.owner == 5
    free = conversation.next_time(0.0)
    speeches = (speech(-1.0, free - 0.02), speech(free + 1.0, free + 2.0))
    conversation._shared = SimpleNamespace(scene=SimpleNamespace(speeches=speeches, setup=planning.setup))
    assert conversation.next_time(0.0) == pytest.approx(free - 0.02)
    assert conversation.next_time(free - 0.02) > free - 0.02
