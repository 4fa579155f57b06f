"""Synthesises a block's speech in its style, with pauses before words for which the body would be late."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from kinesic.bml.block import Behaviour, Block, Notice, NoticeType, Speech, Timeline
from kinesic.body.utterance import Mark, Pause, Script, Utterance
from kinesic.expressivity.style.style import Style
from kinesic.motion.keys import Sync
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN, SyncTime, find_bonds

FASTER = 1.25  # rate of temporal 1; its inverse at -1
HIGHER = 1.5  # [semitones] of power 1, and of activation 1
PRECISION = 0.002  # [s] of a pause
NAMED = 24  # characters of a word in a message
MAX_SOUND_DURATION = 2400.0  # [s] of all speech of a block that is heard: as long as its times can be apart

UNHEARD_REMARK = (
    f"nothing is heard: the speeches before it last more than {MAX_SOUND_DURATION:g} s in all, give it to another block"
)


@dataclass(frozen=True)
class SpeechPause:
    """A pause before a mark of a speech."""

    speech: str
    mark: str
    until: float  # [s] of the utterance, when the mark is wanted
    sync: Sync  # that would be late without it
    later: float = 0.0  # [s] by which the mark is to come later than without it
    duration: float = 0.0  # [s] of the silence, that of punctuation included


def synthesise_block(block: Block, setup: Setup, waiting: tuple[SpeechPause, ...] = ()) -> dict[str, Utterance]:
    """Synthesise each speech of a block, by its id.

    Speech beyond `MAX_SOUND_DURATION` in all, which only speeches at the same time can reach, is timed but not heard.

    Args:
        block: what was asked.
        setup: who speaks, in which style.
        waiting: pauses that are made for the body.
    """
    rate, pitch = choose_rate_and_pitch(setup.style)
    found: dict[str, Utterance] = {}
    heard = 0.0  # [s]
    for behaviour in block.behaviours:
        if isinstance(behaviour.action, Speech):
            pauses = tuple(each for each in waiting if each.speech == behaviour.id)
            script = insert_pauses(behaviour.action.script, pauses)
            said = setup.voice.say(script, rate=rate, pitch=pitch)
            if said.sound is not None and heard > MAX_SOUND_DURATION:
                said = replace(said, sound=None, remarks=(*said.remarks, UNHEARD_REMARK))
            heard += 0.0 if said.sound is None else said.duration
            others = behaviour.agent is not None  # who say it themselves
            found[behaviour.id] = replace(said, sound=None, phonemes=(), remarks=()) if others else said
    return found


def choose_rate_and_pitch(style: Style) -> tuple[float, float]:
    """Chooses rate and pitch of a style, in times the voice's own.

    Who moves faster speaks faster, up to a quarter; who moves with more power, or more at all, speaks higher, up to
    three semitones: arousal raises tempo and pitch of voices, sadness and calm lower both (Banse and Scherer 1996).
    A neutral style speaks as the voice does.
    """
    manner = style.gesture
    return FASTER**manner.temporal, 2.0 ** (HIGHER * (manner.power + manner.activation) / 12.0)


def remarks(block: Block, utterances: Mapping[str, Utterance]) -> list[Notice]:
    """Turns the remarks of the voice on each utterance into notices."""
    return [
        Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, f"{block.id}:{name}", remark)
        for name, utterance in utterances.items()
        for remark in utterance.remarks
    ]


def allowed_pauses(block: Block, usual: float) -> dict[str, float]:
    """Looks up the longest pause [s] before a word of each speech that may wait; one with given times cannot.

    Args:
        block: says so for each speech, or for all.
        usual: [s] where it says nothing.
    """
    longest = usual if block.pause is None else block.pause
    found = {
        behaviour.id: longest if behaviour.action.pause is None else behaviour.action.pause
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech) and _may_wait(behaviour.action.script)
    }
    return {name: most for name, most in found.items() if most > 0.0}


def _may_wait(script: Script) -> bool:
    return script.recording is None and all(mark.time is None for mark in script.marks)


def mark_delays(timeline: Timeline, syncs: tuple[SyncTime, ...]) -> dict[Sync, tuple[float, Sync]]:
    """Computes by how much [s] the body misses each mark, and the tied sync point that misses it most.

    Positive when the body is late. Where several are tied to a mark, the latest counts.
    """
    missed = {(sync.behaviour, sync.sync): sync.planned - sync.asked for sync in syncs}
    spoken = {timed.behaviour.id for timed in timeline.timed if isinstance(timed.behaviour.action, Speech)}
    found: dict[Sync, tuple[float, Sync]] = {}
    both = {(bond.earlier, bond.later) for bond in find_bonds(timeline)}
    for mark, sync in both:
        if mark[0] in spoken and (sync, mark) in both and sync in missed and sync[0] not in spoken:
            found[mark] = max((missed[sync], sync), found.get(mark, (-math.inf, sync)))
    return found


def required_pauses(
    timeline: Timeline, syncs: tuple[SyncTime, ...], most: Mapping[str, float], before: tuple[SpeechPause, ...] = ()
) -> tuple[SpeechPause, ...]:
    """Chooses the marks that must come later for the body to be in time, with those that wait already.

    A pause moves all that is said after it; so each mark needs only what it misses more than those before it.

    Args:
        timeline: as planned with the pauses before.
        syncs: when its sync points are asked for and when they will be.
        most: [s] by which one pause may hold back what follows, of each speech that may wait.
        before: pauses that are made already.
    """
    missed = mark_delays(timeline, syncs)
    made = {(each.speech, each.mark): each for each in before}
    found: list[SpeechPause] = []
    for timed in timeline.timed:
        name, times = timed.behaviour.id, timed.times
        moved, reached = 0.0, 0.0
        marks = [mark for mark in _marks(timed.behaviour) if mark in times and name in most]
        for mark in sorted(marks, key=lambda mark: times[mark]):
            late, sync = missed.get((name, mark), (reached, ("", "")))
            waiting = made.get((name, mark), SpeechPause(name, mark, 0.0, sync))
            more = min(late - reached, most[name] - waiting.later) if late - reached > SHIFT_TO_WARN else 0.0
            moved, reached = moved + more, late
            if more or waiting.duration:
                until = times[mark] - times["start"] + moved
                found.append(replace(waiting, until=until, later=waiting.later + more))
    return tuple(found)


def _marks(behaviour: Behaviour) -> tuple[str, ...]:
    return tuple(mark.name for mark in behaviour.action.script.marks) if isinstance(behaviour.action, Speech) else ()


def lengthen_pauses(waiting: tuple[SpeechPause, ...], utterances: Mapping[str, Utterance]) -> tuple[SpeechPause, ...]:
    """Lengthens pauses by what their marks still lack when the speech is said with them.

    A voice may make its own pause at a comma shorter where another one is put.
    """
    found: list[SpeechPause] = []
    moved: dict[str, float] = {}
    for each in waiting:
        lacking = each.until - utterances[each.speech].marks[each.mark] - moved.get(each.speech, 0.0)
        longer = each.duration + (math.ceil(1000 * lacking) / 1000 if lacking > PRECISION else 0.0)
        found.append(replace(each, duration=longer))
        moved[each.speech] = moved.get(each.speech, 0.0) + found[-1].duration - each.duration
    return tuple(found)


def insert_pauses(script: Script, waiting: tuple[SpeechPause, ...]) -> Script:
    """Puts pauses before the marks of a script, each beside those that it had."""
    pauses = list(script.pauses)
    for each in (each for each in waiting if each.duration):
        marks = [mark for mark in script.stops() if isinstance(mark, Mark)]
        position = next(mark.position for mark in marks if mark.name == each.mark)
        here = [mark.name for mark in marks if mark.position == position]
        pauses.append(Pause(position, each.duration, here.index(each.mark)))
    return replace(script, pauses=tuple(pauses))


def pause_notices(block: Block, waiting: tuple[SpeechPause, ...]) -> list[Notice]:
    """Warns of each pause."""
    scripts = {b.id: b.action.script for b in block.behaviours if isinstance(b.action, Speech)}
    return [
        Notice(
            NoticeType.IMPOSSIBLE_TO_SCHEDULE,
            f"{block.id}:{each.speech}",
            f"a pause of {each.later:.3f} s is made before {_word(scripts[each.speech], each.mark)}, "
            f"so that {each.sync[1]} of '{each.sync[0]}' is in time",
        )
        for each in waiting
        if each.duration
    ]


def _word(script: Script, mark: str) -> str:
    position = next(each.position for each in script.marks if each.name == mark)
    found = re.search(r"\w[\w'\u2019-]*", script.text[position:])
    return f"'{found[0][:NAMED]}' (mark {mark})" if found else f"mark {mark}"
