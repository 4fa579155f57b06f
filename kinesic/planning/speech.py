"""What a block says, in the manner of its style."""

from collections.abc import Mapping

from kinesic.bml.block import Block, Notice, NoticeType, Speech
from kinesic.body.utterance import Utterance
from kinesic.expressivity.style.style import Style
from kinesic.planning.setup import Setup
from kinesic.planning.speech_pauses import SpeechPause, insert_pauses

FASTER = 1.25  # rate of temporal 1; its inverse at -1
HIGHER = 1.5  # [semitones] of power 1, and of activation 1


def synthesise_block(block: Block, setup: Setup, waiting: tuple[SpeechPause, ...] = ()) -> dict[str, Utterance]:
    """Each speech of a block by its id, as it will be said.

    Args:
        block: what was asked.
        setup: who speaks, in which style.
        waiting: pauses that are made for the body.
    """
    rate, pitch = delivery(setup.style)
    scripts = {b.id: b.action.script for b in block.behaviours if isinstance(b.action, Speech)}
    return {
        name: setup.voice.say(
            insert_pauses(script, tuple(each for each in waiting if each.speech == name)), rate=rate, pitch=pitch
        )
        for name, script in scripts.items()
    }


def delivery(style: Style) -> tuple[float, float]:
    """How fast and how high a style speaks, in times the voice's own.

    Who moves faster speaks faster, up to a quarter; who moves with more power, or more at all, speaks higher, up to
    three semitones: arousal raises tempo and pitch of voices, sadness and calm lower both (Banse and Scherer 1996).
    A neutral style speaks as the voice does.
    """
    manner = style.gesture
    return FASTER**manner.temporal, 2.0 ** (HIGHER * (manner.power + manner.activation) / 12.0)


def remarks(block: Block, utterances: Mapping[str, Utterance]) -> list[Notice]:
    """What the listeners of a block do not get as asked."""
    return [
        Notice(NoticeType.CANNOT_CREATE_BEHAVIOR, f"{block.id}:{name}", remark)
        for name, utterance in utterances.items()
        for remark in utterance.remarks
    ]
