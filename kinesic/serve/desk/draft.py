"""Preview of a document's plan for clients: times, motion and notices."""

import re
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinesic.bml.block import BmlError, DocumentBounds
from kinesic.bml.timing.syllables import find_accented_vowels
from kinesic.body.config import ConfigError
from kinesic.controller.soundtrack import sound
from kinesic.planning.captions import make_captions
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.planning.standing_plan import plan_standing_block
from kinesic.realizer.request import parse_message
from kinesic.serve.desk.behaviour_tracks import label_behaviour, list_tracks

Json = str | int | float | bool | None | Sequence["Json"] | Mapping[str, "Json"]

ANGLE_RATE = 50.0  # [Hz] sample rate of the joint angles in a preview
DOCUMENT_SOURCE = "<document>"  # source name of client documents; not a path, so that relative paths do not resolve
ERROR_PATTERN = re.compile(rf"{DOCUMENT_SOURCE}:(\d+):(\d+): (.*)", re.DOTALL)  # line, column and text of an error


def draft(
    bml: str, changes: tuple[str, ...], setup: Setup, *, bounds: DocumentBounds, max_duration: float
) -> dict[str, Json]:
    """Plan a document without performing it and return the JSON answer.

    Args:
        bml: the document.
        changes: style changes as NAME=VALUE.
        setup: setup for planning.
        bounds: limits for the document size.
        max_duration: maximum duration [s].

    Returns:
        The answer to `plan` as in docs/reference/wire-protocol.md; for a refused document, the error with its location.
    """
    try:
        return draft_json(plan_draft(bml, changes, setup, bounds=bounds, max_duration=max_duration))
    except (BmlError, ConfigError) as error:
        return {"error": locate_error(str(error))}


def plan_draft(
    bml: str, changes: tuple[str, ...], setup: Setup, *, bounds: DocumentBounds, max_duration: float
) -> Plan:
    """Plan a document without performing it.

    Arguments as in `draft`.

    Raises:
        BmlError: the document is refused.
        ConfigError: the style change is invalid.
    """
    updated_setup = replace(setup, style=setup.style.changed(changes))
    block = parse_message(bml, updated_setup, source=DOCUMENT_SOURCE, bounds=bounds)
    plan = plan_standing_block(block, updated_setup)
    if plan.duration > max_duration:
        raise BmlError(
            f"{DOCUMENT_SOURCE}:1:1: lasts {plan.duration:.0f} s, at most {max_duration:g} s; send it in parts"
        )
    return plan


def draft_json(plan: Plan) -> dict[str, Json]:
    """Convert a plan to the JSON values of a `plan` answer.

    Times count from the first command [s].
    """
    zero, end = plan.trajectory.zero, plan.duration
    times = np.arange(int(np.ceil(end * ANGLE_RATE)) + 1) / ANGLE_RATE
    outcomes = plan.keyframes.outcomes
    return {
        "block": plan.timeline.block.id,
        "duration": round(end, 4),
        "zero": round(zero, 4),
        "behaviours": [
            {
                "id": behaviour.id,
                "type": behaviour.type,
                "label": label_behaviour(behaviour),
                "tracks": list_tracks(behaviour, plan),
                "outcome": outcomes[behaviour.id].kind if behaviour.id in outcomes else "realised",
                "why": outcomes[behaviour.id].why if behaviour.id in outcomes else "",
            }
            for behaviour in plan.timeline.block.behaviours
        ],
        "syncs": [
            {
                "behaviour": sync.behaviour,
                "sync": sync.sync,
                "asked": round(zero + sync.requested, 4),
                "planned": round(zero + sync.planned, 4),
            }
            for sync in plan.syncs
        ],
        "words": list(_words(plan)),
        "phonemes": list(_phonemes(plan)),
        "accents": sorted(_accents(plan)),
        "loudness": _loudness(plan),
        "notices": [{"type": notice.type.value, "id": notice.id, "text": notice.text} for notice in plan.notices],
        "rate": ANGLE_RATE,
        "angles": b64encode(plan.trajectory.sample(times)[0].astype("<f4").tobytes()).decode(),
    }


def locate_error(text: str) -> dict[str, Json]:
    """Split an error message into line, column and text.

    A message without a place gets line 1, column 1.
    """
    match = ERROR_PATTERN.fullmatch(text)
    if match is None:
        return {"line": 1, "column": 1, "text": text}
    return {"line": int(match[1]), "column": int(match[2]), "text": match[3]}


def _words(plan: Plan) -> Iterator[dict[str, Json]]:
    """Yield captions of a plan's speeches with start and end [s].

    Times count from the first command.
    """
    for caption in make_captions(plan):
        if caption.text:
            span = {"start": round(caption.begin, 4), "end": round(caption.end, 4)}
            yield {"speech": caption.behaviour, "mark": caption.mark, "text": caption.text, **span}


def _phonemes(plan: Plan) -> Iterator[list[Json]]:
    """Yield each phoneme's symbol and start [s after the first command]."""
    for timed in plan.timeline.timed:
        if (utterance := plan.utterances.get(timed.behaviour.id)) is not None:
            begin = plan.trajectory.zero + timed.times["start"]
            for phoneme in utterance.phonemes:
                yield [phoneme.symbol, round(begin + phoneme.start, 4)]


def _accents(plan: Plan) -> Iterator[float]:
    """Yield the times of the voice's accents [s after the first command]."""
    for timed in plan.timeline.timed:
        if (utterance := plan.utterances.get(timed.behaviour.id)) is not None:
            begin = plan.trajectory.zero + timed.times["start"]
            for accent in utterance.accents or find_accented_vowels(utterance.phonemes):
                yield round(begin + accent, 4)


def _loudness(plan: Plan) -> str:
    """Return the speech's peak amplitude per angle sample, as base64 bytes.

    Values are 0 to 255, relative to the loudest row; empty without sound.
    """
    audio = sound(plan)
    if audio is None:
        return ""
    rows = int(np.ceil(audio.duration * ANGLE_RATE))
    begins = np.minimum(np.arange(rows) * audio.rate / ANGLE_RATE, len(audio.samples) - 1).astype(int)
    peaks = np.maximum.reduceat(np.abs(audio.samples), begins)
    return b64encode(np.round(255.0 * peaks / max(float(peaks.max()), 1e-9)).astype(np.uint8).tobytes()).decode()
