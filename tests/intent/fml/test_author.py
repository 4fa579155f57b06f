import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

from kinesic.bml.block import BmlError
from kinesic.bml.composition import Composition
from kinesic.bml.parse import parse
from kinesic.intent.behaviour_sets import builtin_sets
from kinesic.intent.fml.author import author_fml, is_fml, parse_fml

CORPUS_FOLDER = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
needs_corpus = pytest.mark.skipif(not CORPUS_FOLDER.is_dir(), reason=f"no corpus at {CORPUS_FOLDER}")

GREETING_DOCUMENT = """<?xml version="1.0"?><!DOCTYPE fml-apml SYSTEM "fml-apml.dtd" []>
<fml-apml composition="append"><bml><speech id="s1" start="0.5">
<tm id="tm1"/>Hello &amp; welcome <tm id="tm2"/>to the old and quiet town <tm id="tm3"/>
<pitchaccent type="Hstar" start="s1:tm2" end="s1:tm3"/></speech><gesture id="g1" lexeme="beat" start="9"/></bml>
<fml>
  <performative type="greet" start="s1:tm1" end="s1:tm3" importance="1.0"/>
  <emotion type="joy" start="s1:tm3" end="s1:tm9" importance="0.7" intensity="0.5"/>
  <deictic start="s1:tm3+2" importance="0.9" target="door"/>
  <nothing type="known" start="3"/>
  <emotion type="anger" start="s7:tm1"/>
</fml></fml-apml>"""


@pytest.fixture(scope="module")
def greeting():
    return parse_fml(GREETING_DOCUMENT)


def of_intention(block, name):
    return [behaviour for behaviour in block.behaviours if f"({name}," in behaviour.reason]


def test_fml_intentions_without_behaviour_set_or_valid_time_are_reported_with_the_reason(greeting):
    for name in ("performative-greet", "emotion-joy", "deictic-any"):
        assert of_intention(greeting, name)
    unshown = [notice.text for notice in greeting.notices if notice.text.startswith("not shown")]
    assert any("element nothing is unknown; known: adjectival, " in item for item in unshown)
    (timeless,) = (item for item in unshown if "'s7:tm1' is not a time of a speech" in item)
    line = next(k for k, text in enumerate(GREETING_DOCUMENT.splitlines(), 1) if "s7:tm1" in text)
    assert timeless.startswith(f"not shown: emotion-anger, <emotion> at {line}:")


def test_bml_generated_from_fml_contains_the_speech_and_gesture_of_the_document(greeting):
    speech, own = greeting.behaviours[0], next(behaviour for behaviour in greeting.behaviours if behaviour.id == "g1")
    assert "Hello & welcome" in speech.action.script.text
    assert not own.reason
    assert (greeting.dialect, greeting.composition) == ("fml-apml", Composition.APPEND)
    assert len({behaviour.id for behaviour in greeting.behaviours}) == len(greeting.behaviours)


def test_gesture_stroke_of_an_fml_intention_is_on_its_pitch_accent():
    tree = ElementTree.fromstring(author_fml(GREETING_DOCUMENT)[0])
    strokes = {item.get("stroke") for item in tree if "(performative-greet," in str(item.attrib) and item.get("stroke")}
    assert strokes == {"s1:tm2+0.20"}


def test_fml_emotion_starts_at_its_mark_and_is_limited_by_its_intensity():
    tree = ElementTree.fromstring(author_fml(GREETING_DOCUMENT)[0])
    face = next(item for item in tree if item.tag == "faceLexeme" and "(emotion-joy," in str(item.attrib))
    assert face.get("start") == "s1:tm3-0.10"
    assert float(face.get("amount")) <= 0.5  # Limited by the intensity of the intent


def test_fml_intention_with_a_target_gives_a_pointing_behaviour_to_that_target(greeting):
    pointing = of_intention(greeting, "deictic-any")
    assert [(item.type, item.action.target) for item in pointing if item.type == "pointing"] == [("pointing", "door")]


def test_same_fml_document_and_seed_give_the_same_bml():
    assert author_fml(GREETING_DOCUMENT, seed=3) == author_fml(GREETING_DOCUMENT, seed=3)
    assert len({author_fml(GREETING_DOCUMENT, seed=seed)[0] for seed in range(8)}) > 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (GREETING_DOCUMENT, True),
        (b"\xef\xbb\xbf<!-- <bml> --><fml-apml>", True),
        ("<fml-apml/>".encode("utf-16"), True),
        ("<bml id='b'><!-- <fml-apml> --></bml>", False),
        ("", False),
    ],
)
def test_fml_is_recognised_by_its_root_element(text, expected):
    assert is_fml(text) is expected


def test_fml_without_bml_gives_a_face_and_a_gesture_behaviour():
    text = '<fml-apml><fml><emotion id="e" type="joy" start="0" end="3" importance="1"/></fml></fml-apml>'
    block = parse_fml(text)
    assert [item.type for item in of_intention(block, "emotion-joy")] == ["faceLexeme", "gesture"]
    assert len(block.behaviours) == 2


def test_behaviours_and_errors_of_fml_name_the_line_of_the_file(greeting):
    places = {behaviour.id: behaviour.place.line for behaviour in greeting.behaviours}
    assert (places["s1"], places["g1"]) == (2, 4)
    assert {item.place.line for item in of_intention(greeting, "emotion-joy")} == {7}
    wrong = GREETING_DOCUMENT.replace('start="9"', 'start="1e9"')
    with pytest.raises(BmlError, match=r"^my\.xml:4:65: .*1e9"):
        parse_fml(wrong, source="my.xml")


@needs_corpus
def test_fml_documents_of_the_corpus_become_bml_with_known_intentions():
    documents = sorted((CORPUS_FOLDER / "greta/fml").rglob("*.xml"))
    assert len(documents) >= 60
    for path in documents:
        bml, unshown = author_fml(path.read_bytes(), source=path.name)
        assert parse(bml).behaviours or "<speech" not in bml
        assert not [
            item for item in unshown if item.startswith("not shown") and ("unknown" in item or "no type" in item)
        ]


@needs_corpus
def test_builtin_behaviour_sets_cover_all_intentions_of_the_greta_lexicon():
    lexicon = ElementTree.parse(CORPUS_FOLDER / "greta/behaviorplanner/IntentionLexicon/lexicon.xml")
    names = [item.get("name") for item in lexicon.getroot()]
    assert len(names) == 115
    assert [name for name in names if builtin_sets().find(name) is None] == []
