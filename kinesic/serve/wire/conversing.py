"""Messages about a conversation: people, voices, turns and thinking."""

from typing import Annotated

from msgspec import Meta, Struct

from kinesic.conversation.events import (
    ConversationEvent,
    Conversing,
    PeopleSeen,
    Person,
    SoundEvent,
    SoundPiece,
    SoundPosition,
    Thinking,
    Transcript,
    TurnPrediction,
    VoiceActivity,
)

MAX_PEOPLE = 32  # largest number of people in one report
MAX_SOUND_SIZE = 48_000  # [bytes] largest part of a sound: 0.5 s at 48 kHz
CONVERSATION_VERBS = frozenset({"people", "heard", "sound"})  # `do` values of messages with lists, texts or sounds

PersonId = Annotated[str, Meta(min_length=1, max_length=64)]
Coordinate = Annotated[float, Meta(ge=-50.0, le=50.0)]  # [m]
Age = Annotated[float, Meta(ge=0.0, le=5.0)]  # [s]
Fraction = Annotated[float, Meta(ge=0.0, le=1.0)]
HeardText = Annotated[str, Meta(max_length=2000)]


class ConverseRequest(Struct, tag="converse", tag_field="do", forbid_unknown_fields=True):
    """Request to begin or end a conversation with people."""

    on: bool = True  # whether the robot converses
    amount: Fraction = 1.0  # amount of movement, 0..1
    fillers: bool = False  # whether the robot says a short filler while an answer takes long


class SeenPerson(Struct, forbid_unknown_fields=True):
    """Person in a `people` message."""

    id: PersonId  # id of the person, the same in every report
    at: tuple[Coordinate, Coordinate, Coordinate]  # [m] position of the eyes: forward, left, up from the robot's base
    looks: bool = False  # whether the person looks at the robot


class PeopleReport(Struct, tag="people", tag_field="do", forbid_unknown_fields=True):
    """Report of all people seen by a tracker.

    Send it 2 to 20 times a second.
    """

    people: Annotated[tuple[SeenPerson, ...], Meta(max_length=MAX_PEOPLE)]  # seen people; one missing for 1 s has left
    age: Age = 0.0  # [s] time since the measurement


class HeardReport(Struct, tag="heard", tag_field="do", forbid_unknown_fields=True):
    """Report of a voice's start or end, or of recognised words."""

    voice: bool | None = None  # whether a voice began or ended; if missing, only words are reported
    text: HeardText | None = None  # all recognised words of the turn
    final: bool = False  # whether the recogniser will not change these words
    who: PersonId | None = None  # id of the person; if missing, the person is unknown
    age: Age = 0.0  # [s] time since the voice began or ended


class TurnReport(Struct, tag="turn", tag_field="do", forbid_unknown_fields=True):
    """Report of a model that predicts turns to speak."""

    yours: Fraction  # probability that the turn passes to the robot


class SoundPart(Struct, tag="sound", tag_field="do", forbid_unknown_fields=True):
    """Part of a speech sound that the robot performs as its own."""

    id: PersonId  # id of the sound, the same for all of its parts
    data: Annotated[bytes, Meta(max_length=MAX_SOUND_SIZE)]  # 16-bit little-endian samples of one channel, as base64
    rate: Annotated[int, Meta(ge=8000, le=48_000)] = 24_000  # [Hz] sample rate
    ends: bool = False  # whether this is the last part
    play: bool = True  # whether the robot plays the sound; otherwise the client plays it


class PlayedReport(Struct, tag="played", tag_field="do", forbid_unknown_fields=True):
    """Report of the position in a sound that the client plays itself."""

    id: PersonId  # id of the sound
    at: Annotated[float, Meta(ge=0.0, le=3600.0)]  # [s] time since the start of the sound


class ThinkRequest(Struct, tag="think", tag_field="do", forbid_unknown_fields=True):
    """Report that a client prepares an answer, or no longer does."""

    on: bool = True  # whether an answer is being prepared


ConversationMessage = (
    ConverseRequest | PeopleReport | HeardReport | TurnReport | ThinkRequest | SoundPart | PlayedReport
)


def conversation_events(message: ConversationMessage) -> tuple[ConversationEvent | SoundEvent, ...]:
    """Convert a message to the events of a conversation."""
    match message:
        case ConverseRequest(on, amount):
            return (Conversing(on, amount),)
        case PeopleReport(people, age):
            return (PeopleSeen(tuple(Person(person.id, person.at, person.looks) for person in people), age),)
        case HeardReport(voice, text, final, who, age):
            voices = () if voice is None else (VoiceActivity(voice, who, age),)
            words = () if text is None else (Transcript(text, final, who),)
            return (*voices, *words) if voice else (*words, *voices)
        case TurnReport(yours):
            return (TurnPrediction(yours),)
        case ThinkRequest(on):
            return (Thinking(on),)
        case SoundPart(id, data, rate, ends, play):
            return (SoundPiece(id, rate, data, ends, play),)
        case PlayedReport(id, at):
            return (SoundPosition(id, at),)
