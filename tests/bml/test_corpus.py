"""Documents of other realizers: each is performed, or refused with its place, and nothing else happens."""

import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from kinesic.bml.block import Block, BmlError, Gesture, Posture, Speech
from kinesic.bml.parse import parse
from kinesic.bml.reading.sync_names import sync_name
from kinesic.bml.reading.vocabulary import AGENTS, ATTRIBUTES, BLOCK_ATTRIBUTES, SPOKEN
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance
from kinesic.speech.writing import unreadable_letters

from ..naming import about

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[3] / "shared" / "corpus"))
FOLDERS = ("greta/bml", "greta/fml", "greta/malformed", "openbmlparser", "realizertester", "asap")
FILES = sorted(path for folder in FOLDERS for path in (CORPUS / folder).rglob("*.xml"))
REFUSED = {  # and why
    "B0.xml": "duplicate attribute",
    "test_bml_gaze_attributes.xml": "mismatched tag",
    "testinvalidxml.xml": "mismatched tag",
    "testspeech_unknownbehavior.xml": "no behaviour 'unknownbeh'",
}
DROPPED = {  # document -> behaviours, all of them impossible as written, or tied to blocks that are not there
    "BML-FierteExpPrecendentes_FrdBigDecr.xml": 1,
    "testnod_invalidtime.xml": 1,
    "testspeech_unknownsync.xml": 1,
    "volumechange.xml": 1,
}
if not FILES:
    pytest.skip(f"no corpus at {CORPUS}", allow_module_level=True)


@pytest.mark.parametrize("folder", FOLDERS)
def test_documents_are_performed_or_refused(folder: str, spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    for path in FILES:
        if path.is_relative_to(CORPUS / folder):
            with about(path):
                check_document(path, spoken)


def check_document(path: Path, spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    """Refused for its reason, or in order, with no more dropped than is known."""
    reason = REFUSED.get(path.name)
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
    if path.name != "testspeechinterrupt.xml":  # one of several of that name refers to another block
        assert len(timeline.dropped) == DROPPED.get(path.name, 0)


FRAGMENTS = CORPUS / "smartbody" / "fragments.jsonl"
SPELLINGS = {  # attributes of behaviours, as other dialects spell them -> ours
    "strokeStart": ("stroke_start", "stroke-start", "STROKESTART"),
    "strokeEnd": ("stroke_end", "stroke-end"),
    "relax": ("relax_start",),
}
READ = {
    "id",
    "xmlns",
    *BLOCK_ATTRIBUTES,
    *AGENTS,
    *(name for names in (*ATTRIBUTES.values(), *SPOKEN.values()) for name in names),
}


def blocks() -> list[tuple[Path, bytes, Block]]:
    """Every document that is read, with its block."""
    texts = [(path, path.read_bytes()) for path in FILES if path.name not in REFUSED]
    return [(path, text, parse(text, source=path.name)) for path, text in texts]


def test_every_attribute_is_read_or_named_by_a_warning() -> None:
    seen = 0
    for path, text, block in blocks():
        told = " ".join(notice.text for notice in block.notices)
        inside = text.decode("utf-8", "replace").partition("<bml")[2].partition("</bml>")[0]
        for tag in re.finditer(r"<([A-Za-z]\w*)((?:\s+[\w:.-]+\s*=\s*(?:\"[^\"]*\"|'[^']*'))+)", inside):
            for name in re.findall(r"\s([\w-]+)\s*=\s*[\"']", tag[2]):
                unread = name not in READ and sync_name(name) is None and tag[1] in ATTRIBUTES
                seen += unread
                assert not unread or f"attribute {name} " in told, (path.name, tag[0])
    assert seen == 0  # upstream's authors knew their attributes


def test_every_element_of_a_speech_is_read_or_named_by_a_warning() -> None:
    count = 0
    for path, text, block in blocks():
        told = " ".join(notice.text for notice in block.notices)
        for speech in re.findall(rb"<speech\b.*?</speech>", text, re.DOTALL):
            for name in {tag.decode() for tag in re.findall(rb"<([A-Za-z]\w*)", speech)} - {*ATTRIBUTES, "description"}:
                unread = name not in SPOKEN and b'type="gretabml"' not in speech
                count += unread
                assert not unread or f"<{name}>" in told, (path.name, name)
    assert count > 0


def test_dialects_may_spell_sync_points_otherwise(spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    count = 0
    for path, text, block in blocks():
        for ours, others in SPELLINGS.items():
            for other in others:
                changed = re.sub(rf"\b{ours}(?==|[\"'\s+-])".encode(), other.encode(), text)
                if changed != text and b"tm id" not in text:
                    again = parse(changed, source=path.name)
                    assert schedule(again, spoken(again), {}).timed == schedule(block, spoken(block), {}).timed
                    count += 1
    assert count >= 10


def test_every_behaviour_may_end_with_its_block(spoken: Callable[[Block], dict[str, Utterance]]) -> None:
    for path, _, block in blocks():
        for first in block.behaviours[:1]:
            tag = f'end="bml:end" id="{first.id}"'
            alone = f'<bml id="b"><{first.type.rpartition(":")[2]} {tag} lexeme="NOD" target="user" type="x"/></bml>'
            again = parse(alone, source=path.name)
            found = schedule(again, spoken(again), {})
            assert (found.dropped, found.start) == ((), 0.0)


def test_every_speech_is_said_whatever_its_end(spoken: Callable[[Block], dict[str, Utterance]]) -> None:
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


def test_the_hand_that_a_fragment_names_does_it() -> None:
    fragments = [json.loads(line)["bml"] for line in FRAGMENTS.read_text(encoding="utf-8").splitlines()]
    hips = {parse(text).behaviours[0].action for text in fragments if "LHandOnHip" in text}
    assert hips == {Posture(poses=(("LEFT_ARM", "LHandOnHip_Motex"),), shift=True)}
    rights = [parse(text).behaviours[0].action for text in fragments if "Rt01" in text]
    assert [(g.lexeme, g.mode) for g in rights if isinstance(g, Gesture)] == [
        ("BeatMidRt01", "right"),
        ("NegateRightMidRt01", "right"),
        ("NoLeftRt01", "right"),
    ]


def test_kanji_is_lost_with_its_letters() -> None:
    japanese = [(path, block) for path, _, block in blocks() if "DemoJP" in path.parts]
    assert japanese
    for _, block in japanese:
        for behaviour in block.behaviours:
            if isinstance(behaviour.action, Speech):
                text = behaviour.action.script.text
                han = {letter for letter in text if "\u4e00" <= letter <= "\u9fff"}
                assert set(unreadable_letters(text, "jpx/ja")) == han
