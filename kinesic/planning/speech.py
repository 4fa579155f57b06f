"""Speech synthesis of blocks in a setup's style, with pauses."""

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

MAX_RATE_FACTOR = 1.25  # speech rate factor at the style value temporal = 1; at -1, the factor is 1 / 1.25
SEMITONES_PER_UNIT = 1.5  # [semitones] pitch change per unit of power or activation
PAUSE_TOLERANCE = 0.002  # [s] accepted shortfall of a speech pause
MAX_WORD_LENGTH = 24  # [characters] longest quotation of a word in a message
MAX_SOUND_DURATION = 2400.0  # [s] summed speech duration of a block after which further speeches are silent

UNHEARD_REMARK = (  # remark on speeches beyond `MAX_SOUND_DURATION`
    f"no sound: the speeches before it last more than {MAX_SOUND_DURATION:g} s in total; move it to another block"
)


@dataclass(frozen=True)
class SpeechPause:
    """Pause before a mark of a speech."""

    speech: str
    mark: str
    until: float  # [s] required time of the mark in the utterance
    sync: Sync  # sync point that would be late without the pause
    later: float = 0.0  # [s] required delay of the mark
    duration: float = 0.0  # [s] of the silence, including that of punctuation


def synthesise_block(block: Block, setup: Setup, waiting: tuple[SpeechPause, ...] = ()) -> dict[str, Utterance]:
    """Synthesise a block's speeches and return utterances by speech id.

    Once earlier speeches last more than `MAX_SOUND_DURATION` in all, further ones are timed but silent. Only
    simultaneous speeches can reach it.

    Args:
        block: with the speeches.
        setup: voice and style.
        waiting: pauses for the body.
    """
    rate, pitch = choose_rate_and_pitch(setup.style)
    result: dict[str, Utterance] = {}
    audible_duration = 0.0  # [s] summed duration of all preceding speeches with sound
    for behaviour in block.behaviours:
        if isinstance(behaviour.action, Speech):
            pauses = tuple(pause for pause in waiting if pause.speech == behaviour.id)
            script = insert_pauses(behaviour.action.script, pauses)
            utterance = setup.voice.say(script, rate=rate, pitch=pitch)
            if utterance.sound is not None and audible_duration > MAX_SOUND_DURATION:
                utterance = replace(utterance, sound=None, remarks=(*utterance.remarks, UNHEARD_REMARK))
            audible_duration += 0.0 if utterance.sound is None else utterance.duration
            is_other_agent = behaviour.agent is not None  # other agents speak themselves
            result[behaviour.id] = (
                replace(utterance, sound=None, phonemes=(), remarks=()) if is_other_agent else utterance
            )
    return result


def choose_rate_and_pitch(style: Style) -> tuple[float, float]:
    """Return the rate and pitch factors of a style.

    Faster movement speeds speech up to a quarter; more power or activation raises the pitch up to three semitones.
    Arousal raises tempo and pitch of voices, sadness and calm lower both (Banse and Scherer 1996).
    """
    manner = style.gesture
    return MAX_RATE_FACTOR**manner.temporal, 2.0 ** (SEMITONES_PER_UNIT * (manner.power + manner.activation) / 12.0)


def convert_remarks(block: Block, utterances: Mapping[str, Utterance]) -> list[Notice]:
    """Convert the voice engine's remarks on utterances into notices."""
    return [
        Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, f"{block.id}:{name}", remark)
        for name, utterance in utterances.items()
        for remark in utterance.remarks
    ]


def find_allowed_pauses(block: Block, usual: float) -> dict[str, float]:
    """Return the longest allowed pause [s] before words, by speech.

    Speech with given times has none.

    Args:
        block: its values, or those of each speech, override the default.
        usual: [s] default.
    """
    longest = usual if block.pause is None else block.pause
    result = {
        behaviour.id: longest if behaviour.action.pause is None else behaviour.action.pause
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech) and _can_wait(behaviour.action.script)
    }
    return {name: most for name, most in result.items() if most > 0.0}


def _can_wait(script: Script) -> bool:
    return script.recording is None and all(mark.time is None for mark in script.marks)


def compute_mark_delays(timeline: Timeline, syncs: tuple[SyncTime, ...]) -> dict[Sync, tuple[float, Sync]]:
    """Compute the largest behaviour delay [s] tied to each speech mark.

    Returns:
        Delay, negative if the body is early, and the latest tied sync point, by mark.
    """
    delays = {(sync.behaviour, sync.sync): sync.planned - sync.requested for sync in syncs}
    spoken = {timed.behaviour.id for timed in timeline.timed if isinstance(timed.behaviour.action, Speech)}
    result: dict[Sync, tuple[float, Sync]] = {}
    both = {(bond.earlier, bond.later) for bond in find_bonds(timeline)}
    for mark, sync in both:
        if mark[0] in spoken and (sync, mark) in both and sync in delays and sync[0] not in spoken:
            result[mark] = max((delays[sync], sync), result.get(mark, (-math.inf, sync)))
    return result


def find_required_pauses(
    timeline: Timeline,
    syncs: tuple[SyncTime, ...],
    max_pauses: Mapping[str, float],
    before: tuple[SpeechPause, ...] = (),
) -> tuple[SpeechPause, ...]:
    """Choose pauses that let the body arrive in time for each word.

    A pause delays all following words, so that each mark only needs its additional delay.

    Args:
        timeline: as planned with the earlier pauses.
        syncs: requested and planned times.
        max_pauses: [s] longest pause of each speech that may wait.
        before: earlier pauses.
    """
    delays = compute_mark_delays(timeline, syncs)
    earlier = {(pause.speech, pause.mark): pause for pause in before}
    result: list[SpeechPause] = []
    for timed in timeline.timed:
        name, times = timed.behaviour.id, timed.times
        shift, earlier_delay = 0.0, 0.0
        marks = [mark for mark in _marks(timed.behaviour) if mark in times and name in max_pauses]
        for mark in sorted(marks, key=lambda mark: times[mark]):
            delay, sync = delays.get((name, mark), (earlier_delay, ("", "")))
            waiting = earlier.get((name, mark), SpeechPause(name, mark, 0.0, sync))
            extra = (
                min(delay - earlier_delay, max_pauses[name] - waiting.later)
                if delay - earlier_delay > SHIFT_TO_WARN
                else 0.0
            )
            shift, earlier_delay = shift + extra, delay
            if extra or waiting.duration:
                until = times[mark] - times["start"] + shift
                result.append(replace(waiting, until=until, later=waiting.later + extra))
    return tuple(result)


def _marks(behaviour: Behaviour) -> tuple[str, ...]:
    return tuple(mark.name for mark in behaviour.action.script.marks) if isinstance(behaviour.action, Speech) else ()


def lengthen_pauses(waiting: tuple[SpeechPause, ...], utterances: Mapping[str, Utterance]) -> tuple[SpeechPause, ...]:
    """Lengthen pauses until their marks are spoken late enough.

    A voice may shorten its own pause at a comma if another pause is inserted.
    """
    result: list[SpeechPause] = []
    shift: dict[str, float] = {}
    for pause in waiting:
        missing = pause.until - utterances[pause.speech].marks[pause.mark] - shift.get(pause.speech, 0.0)
        duration = pause.duration + (math.ceil(1000 * missing) / 1000 if missing > PAUSE_TOLERANCE else 0.0)
        result.append(replace(pause, duration=duration))
        shift[pause.speech] = shift.get(pause.speech, 0.0) + result[-1].duration - pause.duration
    return tuple(result)


def insert_pauses(script: Script, waiting: tuple[SpeechPause, ...]) -> Script:
    """Insert additional pauses before the marks of a script."""
    pauses = list(script.pauses)
    for pause in (pause for pause in waiting if pause.duration):
        marks = [mark for mark in script.stops() if isinstance(mark, Mark)]
        position = next(mark.position for mark in marks if mark.name == pause.mark)
        here = [mark.name for mark in marks if mark.position == position]
        pauses.append(Pause(position, pause.duration, here.index(pause.mark)))
    return replace(script, pauses=tuple(pauses))


def describe_pauses(block: Block, waiting: tuple[SpeechPause, ...]) -> list[Notice]:
    """Return a notice for each pause added to a speech."""
    scripts = {b.id: b.action.script for b in block.behaviours if isinstance(b.action, Speech)}
    return [
        Notice(
            NoticeType.IMPOSSIBLE_TO_SCHEDULE,
            f"{block.id}:{pause.speech}",
            f"a pause of {pause.later:.3f} s is made before {_word(scripts[pause.speech], pause.mark)}, "
            f"so that {pause.sync[1]} of '{pause.sync[0]}' is in time",
        )
        for pause in waiting
        if pause.duration
    ]


def _word(script: Script, mark: str) -> str:
    position = next(pause.position for pause in script.marks if pause.name == mark)
    result = re.search(r"\w[\w'\u2019-]*", script.text[position:])
    return f"'{result[0][:MAX_WORD_LENGTH]}' (mark {mark})" if result else f"mark {mark}"
