"""Streamed texts of clients, spoken phrase by phrase."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from math import inf

from kinesic.bml.composition import BlockState
from kinesic.body.config import names_of, suggestion
from kinesic.expressivity.style.style import style_preset
from kinesic.intent.manuscript.pieces import Manuscript
from kinesic.intent.pacing.memory import NO_MEMORY
from kinesic.intent.reading.language import load_language
from kinesic.intent.talk import MAX_SILENCE, SETTLING_TIME, Part, Talk, is_all_said, next_part
from kinesic.planning.setup import Setup
from kinesic.realizer.ending import end_behaviours
from kinesic.realizer.realizer import Scene, advance
from kinesic.realizer.running_block import PlayingSpeech
from kinesic.serve.messages import Words
from kinesic.serve.queues import MAX_TEXT_LENGTH
from kinesic.serve.streamed_text import StreamedText
from kinesic.serve.wire.protocol import json_answer
from kinesic.session.documents import find_revision, intention_sets

PHRASE_PLANNING_TIME = 1.5  # [s] time before the end of a phrase at which the next phrase is planned
REPLACEMENT_MARGIN = 0.3  # [s] shortest time before its start at which a behaviour may still be replaced


@dataclass(frozen=True)
class Phrase:
    """Next phrase of a client's text, as a BML block."""

    sender: int
    block: str
    bml: str
    text: str
    replaced: frozenset[str] = frozenset()  # ids of behaviours of the previous block to be removed
    before: str = ""  # id of the previous block
    warnings: tuple[str, ...] = ()  # parts of the text that are neither spoken nor performed
    waiting: int = 0  # [characters] received from this client and still kept

    @property
    def answer(self) -> str:
        """Answer to the client: id, text and warnings of the block."""
        warnings = {"warnings": self.warnings} if self.warnings else {}
        return json_answer("saying", block=self.block, text=self.text, waiting=self.waiting, **warnings)

    @property
    def scene_change(self) -> Callable[[Scene, float], Scene]:
        """Scene change that removes replaced behaviours that have not begun."""

        def change(scene: Scene, now: float) -> Scene:
            scene = advance(scene, now)
            running = scene.find(self.before)
            if running is None:
                return scene
            pending = frozenset(
                id
                for id in self.replaced & running.times.keys()
                if running.zero + running.times[id]["start"] > scene.first_change(now)
            )
            return end_behaviours(scene, running, pending, now) if pending else scene

        return change


class Talks:
    """Streamed texts of all clients, which take turns phrase by phrase."""

    def __init__(self, character: str | None = None) -> None:
        """Create an empty set of texts.

        Args:
            character: speaker of dialogues whose lines are spoken; None: all.
        """
        self._empty = Talk(manuscript=Manuscript(character=(character or "").upper()))
        self._texts: dict[int, StreamedText] = {}  # by client
        self._parts: dict[int, int] = {}  # number of blocks by client
        self._last_check = -inf  # [s] time of the last call of `next_phrase`
        self._memory = NO_MEMORY  # gestures of all texts so far

    @property
    def senders(self) -> frozenset[int]:
        """Clients with unspoken words."""
        return frozenset(self._texts)

    def take(self, words: Words, now: float) -> str:
        """Add streamed words that a client sent at a time [s].

        Return why they are refused, or an empty text.
        """
        speech = self._texts.get(words.sender, StreamedText(self._empty, now))
        text = words.text if isinstance(words.text, str) else words.text.decode(errors="replace")
        if speech.waiting + len(text) > MAX_TEXT_LENGTH:
            return f"{MAX_TEXT_LENGTH} characters already wait to be spoken; send the rest later"
        if words.style not in ("", *names_of("style")):
            return f"no style {words.style}{suggestion(words.style, names_of('style'))}"
        speech.style = words.style
        speech.take(text, now, ends=words.ends, instead=words.instead)
        self._texts[words.sender] = speech
        return ""

    def clear(self) -> None:
        """Drop all unspoken words."""
        self._texts.clear()

    def next_time(self, scene: Scene) -> float:
        """Return the next time [s] to check for a phrase, or infinity."""
        last_speech = _last_speech(scene)
        times = [speech.heard + quiet for speech in self._texts.values() for quiet in (SETTLING_TIME, MAX_SILENCE)]
        if self._texts and last_speech is not None:
            times.append(last_speech.end - PHRASE_PLANNING_TIME)
        return min((time for time in times if time > self._last_check), default=inf)

    def next_phrase(self, scene: Scene, now: float) -> Phrase | None:
        """Return the next complete phrase if it is time to plan it.

        None if no phrase is complete, or while speech runs for longer than `PHRASE_PLANNING_TIME`.
        """
        self._last_check = now
        last_speech = _last_speech(scene)
        if any(block.state is BlockState.LURKING and block.speeches for block in scene.blocks):
            return None
        if last_speech is not None and last_speech.end > now + PHRASE_PLANNING_TIME + scene.ahead:
            return None
        for sender, speech in self._texts.items():
            speech.talk = replace(speech.talk, memory=self._memory)
            part = _next_part(speech, scene, now)
            if part is not None:
                del self._texts[sender]  # back of the turn order
                self._texts[sender] = speech
                return self._phrase(
                    sender, speech, part, last_speech if last_speech and last_speech.end > now else None
                )
        return None

    def finished(self, setup: Setup) -> Iterator[tuple[int, str]]:
        """Remove texts that are complete and planned, yielding client and last block."""
        for sender, speech in list(self._texts.items()):
            if speech.is_read and is_all_said(speech.talk, load_language(setup.language)):
                del self._texts[sender]
                yield sender, speech.block

    def _phrase(self, sender: int, speech: StreamedText, part: Part, last_speech: PlayingSpeech | None) -> Phrase:
        self._parts[sender] = self._parts.get(sender, 0) + 1
        block, before = f"said{sender}-{self._parts[sender]}", speech.block
        speech.talk, speech.block, self._memory = part.talk, block, part.talk.memory
        speech.read_ahead()
        start = "" if last_speech is None else f"{last_speech.block}:{last_speech.behaviour}:end+{part.gap:.2f}"
        bml = part.write(block, start)
        if speech.style:
            bml = bml.replace(f'id="{block}"', f'id="{block}" kinesic:style="{speech.style}"', 1)
        return Phrase(sender, block, bml, part.written, part.replaced, before, part.warnings, speech.waiting)


def _next_part(speech: StreamedText, scene: Scene, now: float) -> Part | None:
    setup, running = scene.setup, scene.find(speech.block)
    times = {} if running is None else running.times
    zero = 0.0 if running is None else running.zero
    earliest = now + REPLACEMENT_MARGIN + scene.ahead
    free = [id for id, at in times.items() if "start" in at and zero + at["start"] > earliest]
    return next_part(
        speech.talk,
        setup.lexicon,
        style_preset(speech.style) if speech.style else setup.style,
        load_language(setup.language),
        intention_sets(setup),
        grammar=setup.grammar,
        quiet=speech.quiet(now),
        free=free,
        seed=setup.idling.seed,
        revise=find_revision(setup),
    )


def _last_speech(scene: Scene) -> PlayingSpeech | None:
    """Return the speech that ends last among the running blocks, or None."""
    return max(scene.speeches, key=lambda speech: speech.end, default=None)
