"""Tests with third-party documents: nearly all behaviours are performed."""

import json
import os
from collections import Counter
from pathlib import Path

import pytest

from kinesic.bml.block import Action, Block, BmlError, Gaze, Gesture, Head, Manner, Pointing, Speech, find_modality
from kinesic.bml.parse import parse
from kinesic.bml.schedule import schedule
from kinesic.body.arrays import sealed
from kinesic.body.utterance import Utterance
from kinesic.expressivity.context import BlockContext, Context
from kinesic.expressivity.durations import natural_durations
from kinesic.expressivity.keyframes import KeyFrames
from kinesic.expressivity.realise import make_keyframes
from kinesic.expressivity.style.resolve import resolve_numbers
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, Style, style_preset

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
LETTER_DURATION = 0.06  # Speech duration per letter [s]


def performed(path: Path, pace, lexicon) -> Counter:
    """Count realised, substituted and dropped behaviours of a document."""
    try:
        block = parse(path.read_text(encoding="utf-8", errors="replace"), source=path.name)
    except BmlError:
        return Counter()
    outcomes = played(block, pace, lexicon).outcomes
    return Counter(
        outcomes[behaviour.id].kind
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Gesture | Head | Gaze)
    )


def played(block: Block, pace, lexicon, targets=None) -> KeyFrames:
    """Return the key frames of a block."""
    utterances = {
        behaviour.id: Utterance(
            LETTER_DURATION * max(1, len(behaviour.action.script.text)),
            {mark.name: LETTER_DURATION * mark.position for mark in behaviour.action.script.marks},
        )
        for behaviour in block.behaviours
        if isinstance(behaviour.action, Speech)
    }
    context = BlockContext(block, Context(Style(), lexicon, pace, targets or {}))
    timeline = schedule(block, utterances, natural_durations(context))
    frames = make_keyframes(timeline, context)
    assert set(frames.outcomes) == {behaviour.id for behaviour in block.behaviours}
    return frames


def test_at_most_5_percent_of_corpus_behaviours_are_dropped(pace, lexicon):
    folder = CORPUS_FOLDER / "greta" / "bml"
    if not folder.is_dir():
        pytest.skip(f"no corpus at {CORPUS_FOLDER}; KINESIC_CORPUS names another place")
    counts = sum((performed(path, pace, lexicon) for path in sorted(folder.rglob("*.xml"))), Counter())
    assert counts.total() > 100
    assert counts["dropped"] <= 0.05 * counts.total()


def test_smartbody_fragments_of_the_corpus_are_performed_or_named_in_warnings(pace, lexicon):
    file = CORPUS_FOLDER / "smartbody" / "fragments.jsonl"
    if not file.is_file():
        pytest.skip(f"no corpus at {CORPUS_FOLDER}; KINESIC_CORPUS names another place")
    rows = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    counts: dict[str, Counter] = {}
    for row in rows:
        if row["dynamic"]:
            continue
        block = parse(row["bml"])
        targets = {
            behaviour.action.target: sealed([1.5, 0.3, 1.2])
            for behaviour in block.behaviours
            if is_aimed(behaviour.action)
        }
        frames = played(block, pace, lexicon, targets)
        for behaviour in block.behaviours:
            outcome = frames.outcomes[behaviour.id]
            name = "pointing" if isinstance(behaviour.action, Pointing) else behaviour.type
            counts.setdefault(name, Counter())[outcome.kind] += 1
            if outcome.kind == "dropped":
                texts = [notice.text for notice in frames.notices if notice.id == f"{block.id}:{behaviour.id}"]
                assert texts
                assert behaviour.type.rpartition(":")[2] in f"{behaviour.id} {texts}"
    for name in ("gaze", "head", "gesture", "face", "speech", "pointing"):
        assert counts[name].total() > 0
        assert counts[name]["dropped"] <= 0.05 * counts[name].total(), (name, counts[name])


def is_aimed(action: Action) -> bool:
    return isinstance(action, Gaze | Pointing) and action.target is not None


def test_expressivity_in_corpus_documents_overrides_the_style():
    folder = CORPUS_FOLDER / "greta" / "bml"
    if not folder.is_dir():
        pytest.skip(f"no corpus at {CORPUS_FOLDER}; KINESIC_CORPUS names another place")
    carried: Counter = Counter()
    for path in sorted(folder.rglob("*.xml")):
        try:
            block = parse(path.read_text(encoding="utf-8", errors="replace"), source=path.name)
        except BmlError:
            continue
        for behaviour in block.behaviours:
            modality = find_modality(behaviour.action)
            if modality is None or behaviour.manner == Manner():
                continue
            resolved = resolve_numbers(style_preset("sad"), modality, block, behaviour)
            for name in EXPRESSIVITY_RANGES:
                said = getattr(behaviour.manner, name)
                assert getattr(resolved.expressivity, name) == (
                    getattr(style_preset("sad").of(modality), name) if said is None else said
                )
                assert resolved.sources[name] == ("style" if said is None else "behaviour")
                carried[name] += said not in (None, 0.0)
    assert all(carried[name] > 50 for name in ("spatial", "temporal", "fluidity", "power", "repetition"))
