"""Conversation events that a new planner process repeats."""

from dataclasses import replace
from math import inf

from kinesic.conversation.events import Conversing, PeopleSeen, Thinking, VoiceActivity
from kinesic.serve.messages import ClientRequest, ConversationRequest

KEPT_EVENTS = (Conversing, PeopleSeen, VoiceActivity, Thinking)  # types of repeated events, in their order
MIN_RESTORE_INTERVAL = 10.0  # [s] shortest time between two repetitions, so that no event kills planners endlessly


class KeptConversation:
    """Latest events of a running conversation, one of each type."""

    def __init__(self) -> None:
        """Create the record without a conversation."""
        self._kept = dict[type, tuple[ConversationRequest, float]]()
        self._restored = -inf  # [s] time of the last repetition

    @property
    def owner(self) -> int | None:
        """Client that began the conversation, or None without one."""
        return self._kept[Conversing][0].sender if Conversing in self._kept else None

    def keep(self, request: ConversationRequest, now: float) -> None:
        """Record a client's event at a time [s]."""
        event = request.event
        if isinstance(event, Conversing) and not event.on:
            self.forget()
        elif isinstance(event, Conversing) or (self.owner is not None and isinstance(event, KEPT_EVENTS)):
            self._kept[type(event)] = request, now

    def forget(self) -> None:
        """End the record with the conversation."""
        self._kept.clear()

    def restore(self, lost: ClientRequest | None, now: float) -> tuple[ConversationRequest, ...]:
        """Return the requests with which a new planner continues the conversation.

        There are none, and the record ends, if two planners die within `MIN_RESTORE_INTERVAL` or if the previous
        planner died while it began the conversation.

        Args:
            lost: request with which the previous planner died, which is not repeated.
            now: current time [s].
        """
        if isinstance(lost, ConversationRequest):
            self._kept.pop(type(lost.event), None)
        if self.owner is None or now < self._restored + MIN_RESTORE_INTERVAL:
            self.forget()
            return ()
        self._restored = now
        return tuple(_aged(*self._kept[kind], now) for kind in KEPT_EVENTS if kind in self._kept)


def _aged(request: ConversationRequest, taken: float, now: float) -> ConversationRequest:
    """Return a request whose event has become older since a time [s]."""
    event = request.event
    if isinstance(event, PeopleSeen | VoiceActivity):
        return replace(request, event=replace(event, age=event.age + now - taken))
    return request
