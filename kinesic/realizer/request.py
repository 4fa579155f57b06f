"""Parsing and timing of a message before its motion is planned.

Other blocks, to which it may refer, are given as plain data.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from html import unescape

import msgspec

from kinesic.bml.block import (
    DEFAULT_BLOCK_ID,
    DEFAULT_BOUNDS,
    Behaviour,
    Block,
    BmlError,
    DocumentBounds,
    Notice,
    NoticeType,
    Precedence,
    Synchronize,
    SyncRef,
    Timeline,
)
from kinesic.bml.composition import BlockState, find_prerequisites
from kinesic.bml.feedback import write_prediction, write_warning
from kinesic.bml.parse import parse
from kinesic.bml.reading.wrapping import open_document
from kinesic.bml.schedule import schedule
from kinesic.bml.timing.constraints import Point, get_point
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext
from kinesic.expressivity.durations import natural_durations
from kinesic.expressivity.hands.busy_hands import BusyHand
from kinesic.intent.fml.author import is_fml, parse_fml
from kinesic.intent.greta.agent import read_agent
from kinesic.intent.greta.lexicon import read_lexicon
from kinesic.planning.setup import Setup
from kinesic.planning.speech import synthesise_block

PLANNING_TIME = 0.15  # [s] time reserved for planning a block that refers to other blocks
ID_SEARCH_SIZE = 65_536  # [bytes] beginning of a document that is searched for its block id
# Matches a whole comment or CDATA section, or the id of a <bml>. An unclosed section extends to the end of the text,
# which keeps the search linear.
_ID_PATTERN = re.compile(
    rb"""<!--(?:.*?-->|.*)|<!\[CDATA\[(?:.*?\]\]>|.*)|<(?:\w+:)?bml\b[^<>]*?\sid\s*=\s*(?:"([^"]+)"|'([^']+)')""",
    re.DOTALL,
)


class _Named(msgspec.Struct):
    id: str = DEFAULT_BLOCK_ID


_named = msgspec.json.Decoder(_Named)


@dataclass(frozen=True)
class SceneContext:
    """States and global times [s] of the other blocks of a scene."""

    now: float = 0.0  # [s] global time
    states: Mapping[str, BlockState] = field(default_factory=dict)  # states of active blocks, in order of arrival
    relaxes: Mapping[str, float] = field(default_factory=dict)  # id -> relax time [s]
    ends: Mapping[str, float] = field(default_factory=dict)  # id -> end time [s]
    times: Mapping[Point, float] = field(default_factory=dict)  # sync points of active and ended blocks

    def expected_start(self, block: Block) -> float:
        """Estimate the global start time [s] of a block before its planning."""
        waits = [
            (self.relaxes if until == "relax" else self.ends).get(id, self.now)
            for id, until in find_prerequisites(block, self.states).items()
        ]
        return max([self.now + (PLANNING_TIME if refers_elsewhere(block) else 0.0), *waits])


def refers_elsewhere(block: Block) -> bool:
    """Return whether a block refers to sync points of other blocks."""
    return any(ref.block != block.id for ref in _refs(block))


def anchor_references(block: Block, context: SceneContext, zero: float) -> Block:
    """Replace references to other blocks by times of this block.

    Keep unknown ones.

    Args:
        block: block as written.
        context: other blocks.
        zero: global time [s] of block time 0.
    """

    def anchor(ref: SyncRef) -> SyncRef:
        time = context.times.get(get_point(ref)) if ref.block != block.id else None
        return ref if time is None else SyncRef(block.id, "bml", "start", offset=time - zero + ref.offset)

    def anchor_behaviour(behaviour: Behaviour) -> Behaviour:
        return replace(behaviour, syncs={sync: anchor(ref) for sync, ref in behaviour.syncs.items()})

    def anchor_constraint(constraint: Synchronize | Precedence) -> Synchronize | Precedence:
        if isinstance(constraint, Synchronize):
            return replace(constraint, refs=tuple(map(anchor, constraint.refs)))
        return replace(constraint, earlier=anchor(constraint.earlier), later=tuple(map(anchor, constraint.later)))

    if not refers_elsewhere(block):
        return block
    return replace(
        block,
        behaviours=tuple(map(anchor_behaviour, block.behaviours)),
        constraints=tuple(map(anchor_constraint, block.constraints)),
    )


def _refs(block: Block) -> list[SyncRef]:
    refs = [ref for behaviour in block.behaviours for ref in behaviour.syncs.values()]
    for constraint in block.constraints:
        refs += constraint.refs if isinstance(constraint, Synchronize) else (constraint.earlier, *constraint.later)
    return refs


EMPTY_CONTEXT = SceneContext()  # context of a scene without other blocks


@dataclass(frozen=True)
class Message:
    """BML document as received from a client."""

    text: bytes | str
    sender: int = 0  # number of the client that receives the feedback
    source: str = "<text>"  # name in messages


@dataclass(frozen=True, eq=False)
class TimedRequest:
    """Requested block with scheduled times."""

    sender: int  # number of the client that receives the feedback
    block: Block  # block whose references to other blocks are converted to block times
    utterances: Mapping[str, Utterance]  # utterances by speech id
    timeline: Timeline
    zero: float = 0.0  # [s] expected global time of block time 0
    is_anchored: bool = False  # whether the block refers to other blocks, so that `zero` is fixed
    is_decided: bool = False  # whether the block's speech has started and must not change
    busy_hands: tuple[BusyHand, ...] = ()  # hands used by other blocks

    @property
    def notices(self) -> tuple[Notice, ...]:
        """Notices on deviations that are known before planning."""
        return self.timeline.notices

    @property
    def times(self) -> Mapping[str, Mapping[str, float]]:
        """Times of sync points by behaviour, in block time [s]."""
        return {timed.behaviour.id: timed.times for timed in self.timeline.timed}

    @property
    def prediction(self) -> str:
        """PredictionFeedback as XML."""
        return write_prediction(self.block, self.timeline.start, self.timeline.end, self.times, zero=self.zero)


def read_request(
    message: Message, setup: Setup, *, context: SceneContext = EMPTY_CONTEXT, bounds: DocumentBounds = DEFAULT_BOUNDS
) -> TimedRequest:
    """Parse a block, synthesise its speech and schedule it.

    Args:
        message: message with one <bml>.
        setup: setup for planning.
        context: other blocks, to which references may point.
        bounds: maximum size and depth.

    Raises:
        BmlError: the document is refused.
    """
    block = parse_message(message.text, setup, source=message.source, known_blocks=context.states, bounds=bounds)
    zero, is_anchored = context.expected_start(block), refers_elsewhere(block)
    anchored = anchor_references(block, context, zero)
    request = retime_request(
        TimedRequest(message.sender, anchored, {}, Timeline(anchored, ()), zero, is_anchored), setup
    )
    return request if is_anchored else replace(request, zero=zero - request.timeline.start)


def parse_message(
    text: str | bytes,
    setup: Setup,
    *,
    source: str,
    known_blocks: Collection[str] = (),
    bounds: DocumentBounds = DEFAULT_BOUNDS,
) -> Block:
    """Parse a BML or FML document of a client.

    Args:
        text: the document.
        setup: dialect, character and intention files.
        source: name of the document in messages.
        known_blocks: ids of other blocks.
        bounds: maximum size and depth.

    Raises:
        BmlError: the document is refused.
    """
    if setup.dialect not in ("auto", "fml-apml") or len(text) > bounds.size or not is_fml(text):
        return parse(
            text,
            source=source,
            dialect=setup.dialect,
            known_blocks=known_blocks,
            bounds=bounds,
            performer=setup.character,
            recordings=setup.recordings,
        )
    files = setup.intentions
    return parse_fml(
        text,
        source=source,
        performer=setup.character,
        sets=None if files.lexicon is None else read_lexicon(files.lexicon),
        agent=read_agent(files.baseline, files.qualifiers),
        seed=setup.idling.seed,
        known_blocks=known_blocks,
        bounds=bounds,
    )


def retime_request(earlier: TimedRequest, setup: Setup) -> TimedRequest:
    """Synthesise the speech of a changed block and schedule it again.

    Speech that has started is kept.

    Raises:
        BmlError: a `required` behaviour or constraint cannot be scheduled.
    """
    block = earlier.block
    utterances = earlier.utterances if earlier.is_decided else synthesise_block(block, setup)
    timeline = schedule(block, utterances, natural_durations(BlockContext(block, setup.context), utterances))
    return replace(earlier, block=block, utterances=utterances, timeline=timeline)


def refusal_feedback(message: Message, error: BmlError) -> str:
    """Return the warningFeedback for a refused document.

    It contains the block id if that can be read.
    """
    return write_warning(Notice(NoticeType.PARSING_FAILURE, block_id(message.text), str(error)))


def block_id(text: str | bytes) -> str:
    """Return the block id of a document, or a default id."""
    opened = open_document(text).text
    data = opened.encode(errors="replace") if isinstance(opened, str) else opened
    if data.lstrip()[:1] == b"{":
        try:
            return _named.decode(data).id
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):  # the reader names the place
            return DEFAULT_BLOCK_ID
    ids = (match[1] or match[2] for match in _ID_PATTERN.finditer(data, 0, ID_SEARCH_SIZE))
    written = next(filter(None, ids), None)
    return (
        DEFAULT_BLOCK_ID if written is None else unescape(written.decode(errors="replace")).strip() or DEFAULT_BLOCK_ID
    )
