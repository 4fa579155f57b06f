"""Events of a conversation that the next planner repeats."""

import pytest

from kinesic.conversation.events import (
    Conversing,
    PeopleSeen,
    Person,
    SoundPosition,
    Thinking,
    Transcript,
    VoiceActivity,
)
from kinesic.serve.kept_conversation import MIN_RESTORE_INTERVAL, KeptConversation
from kinesic.serve.messages import ConversationRequest, Interruption

OWNER, LISTENER = 3, 4
PEOPLE = PeopleSeen((Person("p", (1.5, 0.0, 1.5)),), age=0.125)


def keep(kept: KeptConversation, *events, sender: int = OWNER, now: float = 20.0) -> None:
    for event in events:
        kept.keep(ConversationRequest(event, sender), now)


@pytest.fixture
def kept() -> KeptConversation:
    made = KeptConversation()
    keep(made, Conversing(on=True, amount=0.5))
    return made


def test_latest_event_of_each_kind_is_repeated_after_the_begin_of_the_conversation(kept: KeptConversation):
    keep(kept, Thinking(on=True), VoiceActivity(active=True), sender=LISTENER)
    keep(kept, PEOPLE, VoiceActivity(active=False, age=0.25), Transcript("so"), SoundPosition("a", 1.0), now=21.0)
    requests = kept.restore(None, 21.5)
    assert [request.event for request in requests] == [
        Conversing(on=True, amount=0.5),
        PeopleSeen(PEOPLE.people, age=0.625),
        VoiceActivity(active=False, age=0.75),
        Thinking(on=True),
    ]
    assert [request.sender for request in requests] == [OWNER, OWNER, OWNER, LISTENER]


def test_events_outside_of_a_conversation_are_not_repeated(kept: KeptConversation):
    keep(kept, PEOPLE, Conversing(on=False), VoiceActivity(active=True))
    assert kept.owner is None
    assert kept.restore(None, 21.0) == ()
    keep(kept, Conversing(on=True), sender=LISTENER)
    assert kept.owner == LISTENER
    assert len(kept.restore(None, 22.0)) == 1
    kept.forget()
    assert kept.owner is None


def test_event_with_which_the_planner_died_is_not_repeated(kept: KeptConversation):
    keep(kept, PEOPLE, Thinking(on=True))
    requests = kept.restore(ConversationRequest(PEOPLE, OWNER), 21.0)
    assert [type(request.event) for request in requests] == [Conversing, Thinking]


def test_conversation_whose_begin_killed_the_planner_is_not_repeated(kept: KeptConversation):
    assert kept.restore(ConversationRequest(Conversing(on=True), OWNER), 21.0) == ()
    assert kept.owner is None


def test_conversation_is_not_repeated_twice_within_a_short_time(kept: KeptConversation):
    assert len(kept.restore(Interruption(None), 21.0)) == 1
    assert len(kept.restore(None, 21.0 + MIN_RESTORE_INTERVAL)) == 1
    assert kept.restore(None, 20.9 + 2.0 * MIN_RESTORE_INTERVAL) == ()
    assert kept.owner is None
