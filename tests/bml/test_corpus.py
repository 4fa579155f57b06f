"""Tests that documents of other realizers are performed or properly rejected."""

import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from kinesic.bml.block import Block, BmlError, Gesture, Posture, Speech
from kinesic.bml.parse import parse
from kinesic.bml.reading.sync_names import find_sync_name
from kinesic.bml.reading.vocabulary import AGENT_ATTRIBUTES, BEHAVIOUR_ATTRIBUTES, BLOCK_ATTRIBUTES, SPEECH_ATTRIBUTES
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance
from kinesic.speech.writing import unreadable_letters

from ..naming import about

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
DOCUMENT_FOLDERS = ("greta/bml", "greta/fml", "greta/malformed", "openbmlparser", "realizertester", "asap")
DOCUMENT_PATHS = sorted(path for folder in DOCUMENT_FOLDERS for path in (CORPUS_FOLDER / folder).rglob("*.xml"))
REJECTED_DOCUMENTS = {  # document -> reason for the rejection
    "B0.xml": "duplicate attribute",
    "test_bml_gaze_attributes.xml": "mismatched tag",
    "testinvalidxml.xml": "mismatched tag",
    "testspeech_unknownbehavior.xml": "no behaviour 'unknownbeh'",
}
DROPPED_BEHAVIOURS = {  # document -> number of infeasible or unresolved behaviours
    "BML-FierteExpPrecendentes_FrdBigDecr.xml": 1,
    "testnod_invalidtime.xml": 1,
    "testspeech_unknownsync.xml": 1,
    "volumechange.xml": 1,
}
if not DOCUMENT_PATHS:
    pytest.skip(f"no corpus at {CORPUS_FOLDER}", allow_module_level=True)


@pytest.mark.parametrize("folder", DOCUMENT_FOLDERS)
def test_corpus_documents_are_performed_or_rejected(
    folder: str, spoken: Callable[[Block], dict[str, Utterance]]
) -> None:
    for path in DOCUMENT_PATHS:
        if path.is_relative_to(CORPUS_FOLDER / folder):
            with about(path):
                check_document(path, spoken)


def check_document(path: Path, spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    """Check that a document is performed in order or rejected as expected.

    No more behaviours than expected may be dropped.
    """
    reason = REJECTED_DOCUMENTS.get(path.name)
    if reason is not None:
        with pytest.raises(BmlError, match=rf"^{path.name}:\d+:\d+: .*{reason}.*; "):
            parse(path.read_bytes(), source=path.name)
        return
    block = parse(path.read_bytes(), source=path.name)
    timeline = schedule(block, spoken(block), {})
    assert len(timeline.timed) + len(timeline.dropped) == len(block.behaviours)
    for timed in timeline.timed:
        times = list(timed.times.values())
        assert times == sorted(times)
    if path.name != "testspeechinterrupt.xml":  # one of several such files refers to another block
        assert len(timeline.dropped) == DROPPED_BEHAVIOURS.get(path.name, 0)


FRAGMENTS_FILE = CORPUS_FOLDER / "smartbody" / "fragments.jsonl"
SYNC_SPELLINGS = {  # BML sync point -> spellings in other dialects
    "strokeStart": ("stroke_start", "stroke-start", "STROKESTART"),
    "strokeEnd": ("stroke_end", "stroke-end"),
    "relax": ("relax_start",),
}
READ_ATTRIBUTES = {  # attributes that the parser reads
    "id",
    "xmlns",
    *BLOCK_ATTRIBUTES,
    *AGENT_ATTRIBUTES,
    *(name for names in (*BEHAVIOUR_ATTRIBUTES.values(), *SPEECH_ATTRIBUTES.values()) for name in names),
}


def blocks() -> list[tuple[Path, bytes, Block]]:
    """Return every valid document with its text and block."""
    texts = [(path, path.read_bytes()) for path in DOCUMENT_PATHS if path.name not in REJECTED_DOCUMENTS]
    return [(path, text, parse(text, source=path.name)) for path, text in texts]


def test_every_attribute_of_corpus_documents_is_read_or_reported() -> None:
    seen = 0
    for path, text, block in blocks():
        notice_texts = " ".join(notice.text for notice in block.notices)
        inside = text.decode("utf-8", "replace").partition("<bml")[2].partition("</bml>")[0]
        for tag in re.finditer(r"<([A-Za-z]\w*)((?:\s+[\w:.-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))+)", inside):
            for name in re.findall(r"\s([\w-]+)\s*=\s*[\"']", tag[2]):
                unread = name not in READ_ATTRIBUTES and find_sync_name(name) is None and tag[1] in BEHAVIOUR_ATTRIBUTES
                seen += unread
                assert not unread or f"attribute {name} " in notice_texts, (path.name, tag[0])
    assert seen == 0  # the corpus has no unknown attributes


def test_every_speech_element_of_corpus_documents_is_read_or_reported() -> None:
    count = 0
    for path, text, block in blocks():
        notice_texts = " ".join(notice.text for notice in block.notices)
        for speech in re.findall(rb"<speech\b.*?</speech>", text, re.DOTALL):
            for name in {tag.decode() for tag in re.findall(rb"<([A-Za-z]\w*)", speech)} - {
                *BEHAVIOUR_ATTRIBUTES,
                "description",
            }:
                unread = name not in SPEECH_ATTRIBUTES and b'type="gretabml"' not in speech
                count += unread
                assert not unread or f"<{name}>" in notice_texts, (path.name, name)
    assert count > 0


def test_alternative_spellings_of_sync_points_give_equal_times(spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    count = 0
    for path, text, block in blocks():
        for name, spellings in SYNC_SPELLINGS.items():
            for other in spellings:
                changed = re.sub(rf"\b{name}(?==|[\"'\s+-])".encode(), other.encode(), text)
                if changed != text and b"tm id" not in text:
                    changed_block = parse(changed, source=path.name)
                    assert (
                        schedule(changed_block, spoken(changed_block), {}).timed
                        == schedule(block, spoken(block), {}).timed
                    )
                    count += 1
    assert count >= 10


def test_first_behaviour_of_each_corpus_document_can_be_tied_to_the_block_end(
    spoken: Callable[[Block], dict[str, Utterance]],
) -> None:
    for path, _, block in blocks():
        for first in block.behaviours[:1]:
            tag = f'end="bml:end" id="{first.id}"'
            alone = f'<bml id="b"><{first.type.rpartition(":")[2]} {tag} lexeme="NOD" target="user" type="x"/></bml>'
            changed_block = parse(alone, source=path.name)
            timeline = schedule(changed_block, spoken(changed_block), {})
            assert (timeline.dropped, timeline.start) == ((), 0.0)


def test_speech_with_an_infeasible_end_time_is_not_dropped(spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    count = 0
    for path, text, _ in blocks():
        changed = re.sub(rb"<speech (?![^>]*\bend=)(?=[^>]*\bstart=.0)", b'<speech end="0.05" ', text)
        block = parse(changed, source=path.name)
        lost = {drop.behaviour.id for drop in schedule(block, spoken(block), {}).dropped}
        for behaviour in block.behaviours:
            if isinstance(behaviour.action, Speech) and b'end="0.05"' in changed:
                count += 1
                assert behaviour.id not in lost, path.name
    assert count > 50


def test_smartbody_gestures_are_read_with_the_hand_in_their_name() -> None:
    fragments = [json.loads(line)["bml"] for line in FRAGMENTS_FILE.read_text(encoding="utf-8").splitlines()]
    hips = {parse(text).behaviours[0].action for text in fragments if "LHandOnHip" in text}
    assert hips == {Posture(poses=(("LEFT_ARM", "LHandOnHip_Motex"),), shift=True)}
    rights = [parse(text).behaviours[0].action for text in fragments if "Rt01" in text]
    assert [(g.lexeme, g.mode) for g in rights if isinstance(g, Gesture)] == [
        ("BeatMidRt01", "right"),
        ("NegateRightMidRt01", "right"),
        ("NoLeftRt01", "right"),
    ]


def test_unreadable_letters_of_the_japanese_voice_are_exactly_the_kanji() -> None:
    japanese = [(path, block) for path, _, block in blocks() if "DemoJP" in path.parts]
    assert japanese
    for _, block in japanese:
        for behaviour in block.behaviours:
            if isinstance(behaviour.action, Speech):
                text = behaviour.action.script.text
                han = {letter for letter in text if "\u4e00" <= letter <= "\u9fff"}
                assert set(unreadable_letters(text, "jpx/ja")) == han
