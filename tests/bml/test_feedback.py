"""Feedback is well-formed BML 1.0 and says what it was told."""

from xml.etree import ElementTree

from kinesic.bml.block import Behaviour, Block, Head, Notice, NoticeType, Place, Speech
from kinesic.bml.feedback import block_progress, prediction, sync_point_progress, warning
from kinesic.bml.reading.namespaces import KINESIC
from kinesic.bml.timing.constraints import Point
from kinesic.body.utterance import Script

NAMESPACE = "{http://www.bml-initiative.org/bml/bml-1.0}"


def test_prediction() -> None:
    times = {"g": {"start": -0.5, "stroke": 0.1 + 0.2, "stroke:2": 1.0}, "s": {"start": 0.0, "m": 1.0, "end": 2.0}}
    named = (("g", "head", Head("NOD")), ("s", "speech", Speech(Script("m"))))
    behaviours = tuple(Behaviour(id, type, action, Place(1, 1)) for id, type, action in named)
    text = prediction(Block("b", behaviours, character="c"), -0.5, 2.0, times, zero=10.0)
    root = ElementTree.fromstring(text)
    block, head, speech = root
    assert (root.tag, root.attrib) == (f"{NAMESPACE}predictionFeedback", {"characterId": "c"})
    assert block.attrib == {"id": "b", "globalStart": "9.5", "globalEnd": "12.0"}
    assert (head.tag, head.attrib) == (f"{NAMESPACE}head", {"id": "b:g", "start": "-0.5", "stroke": "0.3"})
    assert head[0].attrib == {"id": "stroke:2", "time": "1.0"}
    assert speech[0].attrib == {"id": "m", "time": "1.0"}


def test_progress() -> None:
    root = ElementTree.fromstring(block_progress("b", "start", -0.0))
    assert (root.tag, root.attrib) == (f"{NAMESPACE}blockProgress", {"id": "b:start", "globalTime": "0.0"})
    root = ElementTree.fromstring(sync_point_progress(Point("b", "h", "stroke:2"), 1.25, 7.5))
    assert root.attrib == {"id": "b:h:stroke:2", "time": "1.25", "globalTime": "7.5"}


def test_warnings_are_escaped() -> None:
    notice = Notice(NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED, 'b:"<&>', "a < b & c > 'd' \"e\"")
    root = ElementTree.fromstring(warning(notice))
    assert root.attrib == {"id": 'b:"<&>', "type": "CUSTOM_BEHAVIOUR_NOT_SUPPORTED"}
    assert root.text == notice.text


OWN = "{" + KINESIC + "}"


def test_what_the_body_was_seen_to_do_stands_in_a_namespace_of_its_own() -> None:
    root = ElementTree.fromstring(
        sync_point_progress(Point("b", "h", "stroke"), 1.25, 7.5, character="c", measured=7.58)
    )
    assert root.attrib == {
        "characterId": "c",
        "id": "b:h:stroke",
        "time": "1.25",
        "globalTime": "7.5",
        f"{OWN}measuredGlobalTime": "7.58",
        f"{OWN}lag": "0.08",
    }
    root = ElementTree.fromstring(block_progress("b", "end", 3.0, character="c", state="INTERRUPTED", measured=3.1))
    assert root.attrib == {
        "characterId": "c",
        "id": "b:end",
        "globalTime": "3.0",
        f"{OWN}state": "INTERRUPTED",
        f"{OWN}measuredGlobalTime": "3.1",
    }
    assert (
        ElementTree.fromstring(warning(Notice(NoticeType.PARSING_FAILURE, "b", "x"), character="c")).get("characterId")
        == "c"
    )


def test_a_behaviour_without_a_known_type_is_a_behavior_and_prefixes_are_left_out() -> None:
    behaviours = (Behaviour("g", "own:gesture", Head("NOD"), Place(1, 1)),)
    root = ElementTree.fromstring(prediction(Block("b", behaviours), 0.0, 1.0, {"g": {"start": 1e-7}, "x": {}}))
    _, known, other = root
    assert (known.tag, known.get("start"), other.tag) == (f"{NAMESPACE}gesture", "0.0", f"{NAMESPACE}behavior")
    assert "characterId" not in root.attrib
