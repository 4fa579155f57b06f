"""Requests of clients about a conversation, for the planner."""

from collections import deque

from kinesic.conversation.events import Conversing, PeopleSeen
from kinesic.serve.messages import ClientRequest, ConversationRequest
from kinesic.serve.wire.conversing import ConversationMessage, ConverseRequest, conversation_events


def conversation_requests(message: ConversationMessage, sender: int, stops: int) -> tuple[ConversationRequest, ...]:
    """Convert a message of a client to requests, one for each event.

    Args:
        message: message of a client.
        sender: number of the client.
        stops: count of emergency stops at present.
    """
    fills = isinstance(message, ConverseRequest) and message.fillers
    return tuple(ConversationRequest(event, sender, stops, fills) for event in conversation_events(message))


def end_of_conversation(stops: int) -> ConversationRequest:
    """Return the request of the server itself to end the conversation.

    Args:
        stops: count of emergency stops at present.
    """
    return ConversationRequest(Conversing(on=False), 0, stops)


def drop_outdated(waiting: deque[ClientRequest], request: ConversationRequest) -> None:
    """Remove the last waiting request if the new one replaces it.

    A report of people replaces an earlier one of the same client.
    """
    last = waiting[-1] if waiting else None
    if (
        isinstance(last, ConversationRequest)
        and last.sender == request.sender
        and isinstance(last.event, PeopleSeen)
        and isinstance(request.event, PeopleSeen)
    ):
        waiting.pop()
