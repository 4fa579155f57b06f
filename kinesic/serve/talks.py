"""Texts that clients send word by word: when the next phrase of one is said, and as which block."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf

from kinesic.bml.composition import BlockState
from kinesic.controller.documents import intention_sets
from kinesic.intent.reading.language import load_language
from kinesic.intent.talk import SETTLED, SILENT, Part, Talk, hear, is_all_said, next_part
from kinesic.planning.setup import Setup
from kinesic.realizer.ending import leave_out
from kinesic.realizer.realizer import Scene, advance
from kinesic.realizer.running_block import PlayingSpeech
from kinesic.serve.messages import Words
from kinesic.serve.queues import MOST_TEXT
from kinesic.serve.wire.protocol import json_answer

LEAD = 1.5  # [s] before the last phrase has been said the next one is planned; until then it may change
SAFE = 0.3  # [s] before it begins, what is shown may still give way


@dataclass
class _Listening:
    """A talk of one client."""

    talk: Talk
    heard: float  # [s] of the clock, when words came last
    block: str = ""  # of its last part


@dataclass(frozen=True)
class Phrase:
    """What one client has said next."""

    sender: int
    block: str
    bml: str
    text: str
    replaced: frozenset[str] = frozenset()  # behaviours of the part before that give way
    before: str = ""  # block of that part

    @property
    def answer(self) -> str:
        """Tells the client which words the block says."""
        return json_answer("saying", block=self.block, text=self.text)

    @property
    def make_way(self) -> Callable[[Scene, float], Scene]:
        """Leaves out what gives way and has not begun, as a change of the scene."""

        def change(scene: Scene, now: float) -> Scene:
            scene = advance(scene, now)
            running = scene.find(self.before)
            if running is None:
                return scene
            coming = frozenset(
                id
                for id in self.replaced & running.times.keys()
                if running.zero + running.times[id]["start"] > scene.first_change(now)
            )
            return leave_out(scene, running, coming, now) if coming else scene

        return change


class Talks:
    """The talks of all clients; they take turns, a phrase each."""

    def __init__(self) -> None:
        """Begins silent."""
        self._listening: dict[int, _Listening] = {}  # by client
        self._parts: dict[int, int] = {}  # blocks of each client that has said something
        self._looked = -inf  # [s] when it was seen last what may be said

    @property
    def senders(self) -> frozenset[int]:
        """Clients whose words are not all said."""
        return frozenset(self._listening)

    def take(self, words: Words, now: float) -> str:
        """Takes words that came now [s]; says why not, or nothing."""
        own = self._listening.get(words.sender, _Listening(Talk(), now))
        text = words.text if isinstance(words.text, str) else words.text.decode(errors="replace")
        if len(own.talk.text) + len(text) > MOST_TEXT:
            return f"{MOST_TEXT} letters wait to be said already; send the rest later"
        own.talk, own.heard = hear(own.talk, text, ends=words.ends, instead=words.instead), now
        self._listening[words.sender] = own
        return ""

    def clear(self) -> None:
        """Forgets all words that are not said."""
        self._listening.clear()

    def next_time(self, scene: Scene) -> float:
        """Finds the time at which something may be said next [s]; infinite where more words are awaited."""
        mouth = _last_speech(scene)
        times = [each.heard + quiet for each in self._listening.values() for quiet in (SETTLED, SILENT)]
        if self._listening and mouth is not None:
            times.append(mouth.end - LEAD)
        return min((time for time in times if time > self._looked), default=inf)

    def next_phrase(self, scene: Scene, now: float) -> Phrase | None:
        """Chooses the phrase that is said next; None while somebody speaks for a while, or none is whole."""
        self._looked = now
        mouth = _last_speech(scene)
        if any(each.state is BlockState.LURKING and each.speeches for each in scene.blocks):
            return None
        if mouth is not None and mouth.end > now + LEAD + scene.ahead:
            return None
        for sender, own in self._listening.items():
            part = _next_part(own, scene, now)
            if part is not None:
                del self._listening[sender]  # others have their turn
                self._listening[sender] = own
                return self._phrase(sender, own, part, mouth if mouth and mouth.end > now else None)
        return None

    def finished(self, setup: Setup) -> Iterator[tuple[int, str]]:
        """Yields clients whose talk is over and all said, each with the id of its last block, and forgets the talk."""
        for sender, own in list(self._listening.items()):
            if is_all_said(own.talk, load_language(setup.language)):
                del self._listening[sender]
                yield sender, own.block

    def _phrase(self, sender: int, own: _Listening, part: Part, mouth: PlayingSpeech | None) -> Phrase:
        self._parts[sender] = self._parts.get(sender, 0) + 1
        block, before = f"said{sender}-{self._parts[sender]}", own.block
        own.talk, own.block = part.talk, block
        start = "" if mouth is None else f"{mouth.block}:{mouth.behaviour}:end+{part.gap:.2f}"
        return Phrase(sender, block, part.write(block, start), part.text, part.replaced, before)


def _next_part(own: _Listening, scene: Scene, now: float) -> Part | None:
    known, running = scene.setup, scene.find(own.block)
    times = {} if running is None else running.times
    zero = 0.0 if running is None else running.zero
    free = [id for id, at in times.items() if "start" in at and zero + at["start"] > now + SAFE + scene.ahead]
    return next_part(
        own.talk,
        known.lexicon,
        known.style,
        load_language(known.language),
        intention_sets(known),
        grammar=known.grammar,
        quiet=now - own.heard,
        free=free,
        seed=known.idling.seed,
    )


def _last_speech(scene: Scene) -> PlayingSpeech | None:
    """What is said last of all that plays; None where nobody speaks."""
    return max(scene.speeches, key=lambda each: each.end, default=None)
