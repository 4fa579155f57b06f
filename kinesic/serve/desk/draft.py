"""Says what a document would become: when everything happens, how the body moves, and what is not as asked."""

import re
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinesic.bml.block import BmlError, Bounds
from kinesic.bml.parse import parse
from kinesic.body.config import ConfigError
from kinesic.controller.soundtrack import sound
from kinesic.planning.captions import captions
from kinesic.planning.plan import Plan, plan_block
from kinesic.planning.setup import Setup

Json = str | int | float | bool | None | Sequence["Json"] | Mapping[str, "Json"]

RATE = 50.0  # [Hz] of the angles
SOURCE = "<document>"  # no file, so that it names none beside it
PLACE = re.compile(rf"{SOURCE}:(\d+):(\d+): (.*)", re.DOTALL)


def draft(bml: str, changes: tuple[str, ...], setup: Setup, *, bounds: Bounds, longest: float) -> dict[str, Json]:
    """Plans a document that nobody performs.

    Args:
        bml: the document.
        changes: NAME=VALUE of the style.
        setup: what it is planned with.
        bounds: how large it may be.
        longest: [s] that it may last.

    Returns:
        What docs/serve.md says of `plan`; for a document that is refused, the error and its place.
    """
    try:
        return draft_of(plan_draft(bml, changes, setup, bounds=bounds, longest=longest))
    except (BmlError, ConfigError) as error:
        return {"error": place_error(str(error))}


def plan_draft(bml: str, changes: tuple[str, ...], setup: Setup, *, bounds: Bounds, longest: float) -> Plan:
    """Plans a document that nobody performs; the arguments are those of `draft`.

    Raises:
        BmlError: the document is refused.
        ConfigError: the style cannot be changed so.
    """
    known = replace(setup, style=setup.style.changed(changes))
    block = parse(bml, source=SOURCE, dialect=known.dialect, performer=known.character, bounds=bounds)
    planned = plan_block(block, known)
    if planned.duration > longest:
        raise BmlError(f"{SOURCE}:1:1: lasts {planned.duration:.0f} s, at most {longest:g} s; send it in parts")
    return planned


def draft_of(planned: Plan) -> dict[str, Json]:
    """Writes a plan as clients read it; times are those of the performance [s], from its first command."""
    zero, end = planned.trajectory.zero, planned.duration
    times = np.arange(int(np.ceil(end * RATE)) + 1) / RATE
    outcomes = planned.keyframes.outcomes
    return {
        "block": planned.timeline.block.id,
        "duration": round(end, 4),
        "zero": round(zero, 4),
        "behaviours": [
            {
                "id": each.id,
                "type": each.type,
                "outcome": outcomes[each.id].kind if each.id in outcomes else "realised",
                "why": outcomes[each.id].why if each.id in outcomes else "",
            }
            for each in planned.timeline.block.behaviours
        ],
        "syncs": [
            {
                "behaviour": sync.behaviour,
                "sync": sync.sync,
                "asked": round(zero + sync.asked, 4),
                "planned": round(zero + sync.planned, 4),
            }
            for sync in planned.syncs
        ],
        "words": list(_words(planned)),
        "phonemes": list(_phonemes(planned)),
        "loudness": _loudness(planned),
        "notices": [
            {"type": each.type.value, "id": each.id, "text": each.text}
            for each in (*planned.timeline.notices, *planned.notices)
        ],
        "rate": RATE,
        "angles": b64encode(planned.trajectory.sample(times)[0].astype("<f4").tobytes()).decode(),
    }


def place_error(text: str) -> dict[str, Json]:
    """Finds line and column in what is said of an error."""
    found = PLACE.fullmatch(text)
    if found is None:
        return {"line": 1, "column": 1, "text": text}
    return {"line": int(found[1]), "column": int(found[2]), "text": found[3]}


def _words(planned: Plan) -> Iterator[dict[str, Json]]:
    """What is said between two marks, and the mark that it follows."""
    for said in captions(planned):
        if said.text:
            span = {"start": round(said.begin, 4), "end": round(said.end, 4)}
            yield {"speech": said.behaviour, "mark": said.mark, "text": said.text, **span}


def _phonemes(planned: Plan) -> Iterator[list[Json]]:
    """Symbol and start [s] of every sound."""
    for timed in planned.timeline.timed:
        if (utterance := planned.utterances.get(timed.behaviour.id)) is not None:
            begin = planned.trajectory.zero + timed.times["start"]
            for phoneme in utterance.phonemes:
                yield [phoneme.symbol, round(begin + phoneme.start, 4)]


def _loudness(planned: Plan) -> str:
    """The largest sample in each row of the motion, 0..255 of the loudest, as base64; empty where nothing is heard."""
    heard = sound(planned)
    if heard is None:
        return ""
    rows = int(np.ceil(heard.duration * RATE))
    begins = np.minimum(np.arange(rows) * heard.rate / RATE, len(heard.samples) - 1).astype(int)
    peaks = np.maximum.reduceat(np.abs(heard.samples), begins)
    return b64encode(np.round(255.0 * peaks / max(float(peaks.max()), 1e-9)).astype(np.uint8).tobytes()).decode()
