import os
from pathlib import Path
from xml.etree import ElementTree

import pytest

from kinesic.bml.composition import Composition
from kinesic.bml.parse import parse
from kinesic.intent.behaviour_sets import own_sets
from kinesic.intent.fml.author import author_fml, is_fml, parse_fml

CORPUS = Path(os.environ.get("KINESIC_CORPUS", Path(__file__).parents[4] / "shared" / "corpus"))
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason=f"no corpus at {CORPUS}")

GREETING = """<?xml version="1.0"?><!DOCTYPE fml-apml SYSTEM "fml-apml.dtd" []>
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
    return parse_fml(GREETING)


def of_intention(block, name):
    return [each for each in block.behaviours if f"({name}," in each.reason]


def test_every_intention_is_shown_or_has_a_reason_why_not(greeting):
    for name in ("performative-greet", "emotion-joy", "deictic-any"):
        assert of_intention(greeting, name)
    unshown = [each.text for each in greeting.notices if each.text.startswith("not shown")]
    assert any("no behaviour set is called nothing-known" in each for each in unshown)
    assert any("emotion-anger" in each and "'s7:tm1' is no time of a speech" in each for each in unshown)


def test_the_block_keeps_what_its_document_says(greeting):
    speech, own = greeting.behaviours[0], next(each for each in greeting.behaviours if each.id == "g1")
    assert "Hello & welcome" in speech.action.script.text
    assert not own.reason
    assert (greeting.dialect, greeting.composition) == ("fml-apml", Composition.APPEND)
    assert len({each.id for each in greeting.behaviours}) == len(greeting.behaviours)


def test_a_stroke_is_on_the_pitch_accent_of_its_intention():
    tree = ElementTree.fromstring(author_fml(GREETING)[0])
    strokes = {each.get("stroke") for each in tree if "(performative-greet," in str(each.attrib) and each.get("stroke")}
    assert strokes == {"s1:tm2+0.20"}


def test_an_end_that_no_speech_has_is_the_end_of_the_speech():
    tree = ElementTree.fromstring(author_fml(GREETING)[0])
    face = next(each for each in tree if each.tag == "faceLexeme" and "(emotion-joy," in str(each.attrib))
    assert face.get("start") == "s1:tm3-0.10"
    assert float(face.get("amount")) <= 0.5  # its intensity


def test_a_target_is_pointed_at(greeting):
    pointing = of_intention(greeting, "deictic-any")
    assert [(each.type, each.action.target) for each in pointing if each.type == "pointing"] == [("pointing", "door")]


def test_the_same_document_has_the_same_bml():
    assert author_fml(GREETING, seed=3) == author_fml(GREETING, seed=3)
    assert len({author_fml(GREETING, seed=seed)[0] for seed in range(8)}) > 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (GREETING, True),
        (b"\xef\xbb\xbf<!-- <bml> --><fml-apml>", True),
        ("<fml-apml/>".encode("utf-16"), True),
        ("<bml id='b'><!-- <fml-apml> --></bml>", False),
        ("", False),
    ],
)
def test_fml_is_known_by_its_root(text, expected):
    assert is_fml(text) is expected


@needs_corpus
def test_every_intention_of_the_corpus_has_a_set_and_every_document_becomes_bml():
    documents = sorted((CORPUS / "greta/fml").rglob("*.xml"))
    assert len(documents) >= 60
    for path in documents:
        bml, unshown = author_fml(path.read_bytes(), source=path.name)
        assert parse(bml).behaviours or "<speech" not in bml
        assert not [each for each in unshown if "no behaviour set" in each]


@needs_corpus
def test_the_sets_cover_the_names_of_gretas_lexicon():
    lexicon = ElementTree.parse(CORPUS / "greta/behaviorplanner/IntentionLexicon/lexicon.xml")
    names = [each.get("name") for each in lexicon.getroot()]
    assert len(names) == 115
    assert [name for name in names if own_sets().find(name) is None] == []
