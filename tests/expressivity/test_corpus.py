"""Documents that others wrote: nearly all their gestures, heads and gazes are performed."""

import os
from collections import Counter
from pathlib import Path

import pytest

from kinesic.bml.block import BmlError, Gaze, Gesture, Head, Manner, Speech
from kinesic.bml.manner import modality_of
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance
from kinesic.expressivity.durations import spans
from kinesic.expressivity.realise import keyframes
from kinesic.expressivity.sources import told
from kinesic.expressivity.style import RANGES, Style, preset

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
LETTER = 0.06  # [s] that a letter takes to say


def performed(path: Path, pace, lexicon) -> Counter:
    """How often behaviours of this document were realised, substituted or dropped."""
    try:
        block = parse(path.read_text(encoding="utf-8", errors="replace"), source=path.name)
    except BmlError:
        return Counter()
    utterances = {
        behaviour.id: Utterance(
            LETTER * max(1, len(behaviour.action.script.text)),
            {mark.name: LETTER * mark.position for mark in behaviour.action.script.marks},
        )
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech)
    }
    natural = spans(block, style=Style(), lexicon=lexicon, pace=pace)
    frames = keyframes(schedule(block, utterances, natural), style=Style(), lexicon=lexicon, pace=pace)
    assert set(frames.outcomes) == {behaviour.id for behaviour in block.behaviours}
    return Counter(
        frames.outcomes[behaviour.id].kind
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Gesture | Head | Gaze)
    )


def test_nearly_all_gestures_heads_and_gazes_are_performed(pace, lexicon):
    folder = CORPUS / "greta" / "bml"
    if not folder.is_dir():
        pytest.skip(f"no corpus at {CORPUS}; KINESIC_CORPUS names another place")
    counts = sum((performed(path, pace, lexicon) for path in sorted(folder.rglob("*.xml"))), Counter())
    assert counts.total() > 100
    assert counts["dropped"] <= 0.05 * counts.total()


def test_what_the_documents_carry_of_expressivity_is_what_behaviours_are_moved_with():
    folder = CORPUS / "greta" / "bml"
    if not folder.is_dir():
        pytest.skip(f"no corpus at {CORPUS}; KINESIC_CORPUS names another place")
    carried: Counter = Counter()
    for path in sorted(folder.rglob("*.xml")):
        try:
            block = parse(path.read_text(encoding="utf-8", errors="replace"), source=path.name)
        except BmlError:
            continue
        for behaviour in block.behaviours:
            modality = modality_of(behaviour.action)
            if modality is None or behaviour.manner == Manner():
                continue
            found = told(preset("sad"), modality, block, behaviour)
            for name in RANGES:
                said = getattr(behaviour.manner, name)
                assert getattr(found.expressivity, name) == (
                    getattr(preset("sad").of(modality), name) if said is None else said
                )
                assert found.sources[name] == ("style" if said is None else "behaviour")
                carried[name] += said not in (None, 0.0)
    assert all(carried[name] > 50 for name in ("spatial", "temporal", "fluidity", "power", "repetition"))
