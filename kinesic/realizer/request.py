"""Reads a message into a block with times, before its motion is planned.

Other blocks, to which it may refer, are given as plain data.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from html import unescape

import msgspec

from kinesic.bml.block import (
    BOUNDS,
    Behaviour,
    Block,
    BmlError,
    Bounds,
    Notice,
    NoticeType,
    Precedence,
    Synchronize,
    SyncRef,
    Timeline,
)
from kinesic.bml.composition import BlockState, required_before
from kinesic.bml.feedback import prediction, warning
from kinesic.bml.parse import UNNAMED, parse
from kinesic.bml.schedule import schedule
from kinesic.bml.timing.constraints import Point, point_of
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.durations import spans
from kinesic.expressivity.hands.engaged import Engaged
from kinesic.planning.setup import Setup
from kinesic.planning.speech import synthesise_block

LEAD = 0.15  # [s] from the request to the beginning of a block that refers to others: time to plan it
ID_SEARCH = 65_536  # [bytes] of a document in which its id is looked for
# Comments and CDATA, which end with the text at the latest, so that each byte is looked at once; or the id of a <bml>.
_ID = re.compile(
    rb"""<!--(?:.*?-->|.*)|<!\[CDATA\[(?:.*?\]\]>|.*)|<(?:\w+:)?bml\b[^<>]*?\sid\s*=\s*(?:"([^"]+)"|'([^']+)')""",
    re.DOTALL,
)


class _Named(msgspec.Struct):
    id: str = UNNAMED


_named = msgspec.json.Decoder(_Named)


@dataclass(frozen=True)
class SceneContext:
    """The other blocks of a scene, in global time [s]."""

    now: float = 0.0
    states: Mapping[str, BlockState] = field(default_factory=dict)  # of blocks that are not over, in their order
    relaxes: Mapping[str, float] = field(default_factory=dict)  # id -> when it will have subsided
    ends: Mapping[str, float] = field(default_factory=dict)  # id -> when it will be over
    times: Mapping[Point, float] = field(default_factory=dict)  # sync points, of blocks that are over too

    def expected_start(self, block: Block) -> float:
        """When a block will begin [s], as far as is known before it is planned."""
        waits = [
            (self.relaxes if until == "relax" else self.ends).get(id, self.now)
            for id, until in required_before(block, self.states).items()
        ]
        return max([self.now + (LEAD if refers_elsewhere(block) else 0.0), *waits])


def refers_elsewhere(block: Block) -> bool:
    """Whether a block refers to sync points of others."""
    return any(ref.block != block.id for ref in _refs(block))


def anchor_references(block: Block, context: SceneContext, zero: float) -> Block:
    """Turns references to other blocks into times of the block's own; unknown ones stay.

    Args:
        block: as written.
        context: the other blocks.
        zero: [s] global time of the block's time 0.
    """

    def own(ref: SyncRef) -> SyncRef:
        time = context.times.get(point_of(ref)) if ref.block != block.id else None
        return ref if time is None else SyncRef(block.id, "bml", "start", offset=time - zero + ref.offset)

    def anchor_behaviour(behaviour: Behaviour) -> Behaviour:
        return replace(behaviour, syncs={sync: own(ref) for sync, ref in behaviour.syncs.items()})

    def anchor_constraint(constraint: Synchronize | Precedence) -> Synchronize | Precedence:
        if isinstance(constraint, Synchronize):
            return replace(constraint, refs=tuple(map(own, constraint.refs)))
        return replace(constraint, earlier=own(constraint.earlier), later=tuple(map(own, constraint.later)))

    if not refers_elsewhere(block):
        return block
    return replace(
        block,
        behaviours=tuple(map(anchor_behaviour, block.behaviours)),
        constraints=tuple(map(anchor_constraint, block.constraints)),
    )


def _refs(block: Block) -> list[SyncRef]:
    refs = [ref for behaviour in block.behaviours for ref in behaviour.syncs.values()]
    for each in block.constraints:
        refs += each.refs if isinstance(each, Synchronize) else (each.earlier, *each.later)
    return refs


ALONE = SceneContext()


@dataclass(frozen=True)
class Message:
    """A document as it came."""

    text: bytes | str
    sender: int = 0  # who gets the feedback
    source: str = "<text>"  # its name, for messages


@dataclass(frozen=True, eq=False)
class TimedRequest:
    """A block with times, as a client requests it."""

    sender: int
    block: Block  # its references to other blocks are times of its own
    utterances: Mapping[str, Utterance]  # speech id -> what it sounds like
    timeline: Timeline
    zero: float = 0.0  # [s] global time at which its time 0 is expected
    is_anchored: bool = False  # it refers to other blocks, so that `zero` is to be kept
    is_decided: bool = False  # what it says is under way, so that it is said as it is
    engaged: tuple[Engaged, ...] = ()  # hands that other blocks need meanwhile

    @property
    def notices(self) -> tuple[Notice, ...]:
        """What is known already not to be performed as it was requested."""
        return self.timeline.notices

    @property
    def times(self) -> Mapping[str, Mapping[str, float]]:
        """Times of sync points by behaviour, in block time [s]."""
        return {timed.behaviour.id: timed.times for timed in self.timeline.timed}

    @property
    def prediction(self) -> str:
        """The predictionFeedback as XML."""
        return prediction(self.block, self.timeline.start, self.timeline.end, self.times, zero=self.zero)


def read_request(
    message: Message, setup: Setup, *, context: SceneContext = ALONE, bounds: Bounds = BOUNDS
) -> TimedRequest:
    """Reads a block, synthesises its speech, and times it.

    Args:
        message: with one <bml>.
        setup: robot, style and all else that planning is given.
        context: the other blocks; references lead there.
        bounds: largest size and depth.

    Raises:
        BmlError: the document is refused.
    """
    block = parse(
        message.text,
        source=message.source,
        dialect=setup.dialect,
        known_blocks=context.states,
        bounds=bounds,
        performer=setup.character,
    )
    zero, is_anchored = context.expected_start(block), refers_elsewhere(block)
    own = anchor_references(block, context, zero)
    found = retime_request(TimedRequest(message.sender, own, {}, Timeline(own, ()), zero, is_anchored), setup)
    return found if is_anchored else replace(found, zero=zero - found.timeline.start)


def retime_request(earlier: TimedRequest, setup: Setup) -> TimedRequest:
    """Synthesises the speech of a block anew and times it, with another setup or after it was changed.

    Raises:
        BmlError: something `required` cannot be timed.
    """
    block = earlier.block
    utterances = earlier.utterances if earlier.is_decided else synthesise_block(block, setup)
    timeline = schedule(block, utterances, spans(BlockContext(block, setup.context), utterances))
    return replace(earlier, block=block, utterances=utterances, timeline=timeline)


def refusal_feedback(message: Message, error: BmlError) -> str:
    """Writes the warningFeedback for a document that is refused, by the id of its block where that can be read."""
    return warning(Notice(NoticeType.PARSING_FAILURE, block_id(message.text), str(error)))


def block_id(text: str | bytes) -> str:
    """Reads the id of a document's block, from its first tag or its JSON; `UNNAMED` where it has none."""
    data = text.encode() if isinstance(text, str) else text
    if data.lstrip()[:1] == b"{":
        try:
            return _named.decode(data).id
        except (msgspec.DecodeError, UnicodeDecodeError):
            return UNNAMED
    ids = (found[1] or found[2] for found in _ID.finditer(data, 0, ID_SEARCH))
    written = next(filter(None, ids), None)
    return UNNAMED if written is None else unescape(written.decode(errors="replace")).strip() or UNNAMED
