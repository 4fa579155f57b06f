"""Tests of the XML of BML 1.0 feedback."""

from xml.etree import ElementTree

from kinesic.bml.block import Behaviour, Block, Head, Notice, NoticeType, Place, Speech
from kinesic.bml.feedback import write_block_progress, write_prediction, write_sync_point_progress, write_warning
from kinesic.bml.reading.namespaces import KINESIC_NAMESPACE
from kinesic.bml.timing.constraints import Point
from kinesic.body.utterance import Script

BML_TAG = "{http://www.bml-initiative.org/bml/bml-1.0}"


def test_prediction_feedback_contains_the_times_of_all_sync_points() -> None:
    times = {"g": {"start": -0.5, "stroke": 0.1 + 0.2, "stroke:2": 1.0}, "s": {"start": 0.0, "m": 1.0, "end": 2.0}}
    named = (("g", "head", Head("NOD")), ("s", "speech", Speech(Script("m"))))
    behaviours = tuple(Behaviour(id, type, action, Place(1, 1)) for id, type, action in named)
    text = write_prediction(Block("b", behaviours, character="c"), -0.5, 2.0, times, zero=10.0)
    root = ElementTree.fromstring(text)
    block, head, speech = root
    assert (root.tag, root.attrib) == (f"{BML_TAG}predictionFeedback", {"characterId": "c"})
    assert block.attrib == {"id": "b", "globalStart": "9.5", "globalEnd": "12.0"}
    assert (head.tag, head.attrib) == (f"{BML_TAG}head", {"id": "b:g", "start": "-0.5", "stroke": "0.3"})
    assert head[0].attrib == {"id": "stroke:2", "time": "1.0"}
    assert speech[0].attrib == {"id": "m", "time": "1.0"}


def test_progress_feedback_contains_block_and_global_time() -> None:
    root = ElementTree.fromstring(write_block_progress("b", "start", -0.0))
    assert (root.tag, root.attrib) == (f"{BML_TAG}blockProgress", {"id": "b:start", "globalTime": "0.0"})
    root = ElementTree.fromstring(write_sync_point_progress(Point("b", "h", "stroke:2"), 1.25, 7.5))
    assert root.attrib == {"id": "b:h:stroke:2", "time": "1.25", "globalTime": "7.5"}


def test_warning_id_and_text_are_escaped_in_xml() -> None:
    notice = Notice(NoticeType.CUSTOM_BEHAVIOUR_NOT_SUPPORTED, 'b:"<&>', "a < b & c > 'd' \"e\"")
    root = ElementTree.fromstring(write_warning(notice))
    assert root.attrib == {"id": 'b:"<&>', "type": "CUSTOM_BEHAVIOUR_NOT_SUPPORTED"}
    assert root.text == notice.text


KINESIC_TAG = "{" + KINESIC_NAMESPACE + "}"


def test_progress_feedback_contains_measured_time_and_lag_as_kinesic_attributes() -> None:
    root = ElementTree.fromstring(
        write_sync_point_progress(Point("b", "h", "stroke"), 1.25, 7.5, character="c", measured=7.58)
    )
    assert root.attrib == {
        "characterId": "c",
        "id": "b:h:stroke",
        "time": "1.25",
        "globalTime": "7.5",
        f"{KINESIC_TAG}measuredGlobalTime": "7.58",
        f"{KINESIC_TAG}lag": "0.08",
    }
    root = ElementTree.fromstring(
        write_block_progress("b", "end", 3.0, character="c", state="INTERRUPTED", measured=3.1)
    )
    assert root.attrib == {
        "characterId": "c",
        "id": "b:end",
        "globalTime": "3.0",
        f"{KINESIC_TAG}state": "INTERRUPTED",
        f"{KINESIC_TAG}measuredGlobalTime": "3.1",
    }
    assert (
        ElementTree.fromstring(write_warning(Notice(NoticeType.PARSING_FAILURE, "b", "x"), character="c")).get(
            "characterId"
        )
        == "c"
    )


def test_prediction_feedback_removes_element_prefixes_and_uses_behavior_for_unknown_ids() -> None:
    behaviours = (Behaviour("g", "own:gesture", Head("NOD"), Place(1, 1)),)
    root = ElementTree.fromstring(write_prediction(Block("b", behaviours), 0.0, 1.0, {"g": {"start": 1e-7}, "x": {}}))
    _, ids, other = root
    assert (ids.tag, ids.get("start"), other.tag) == (f"{BML_TAG}gesture", "0.0", f"{BML_TAG}behavior")
    assert "characterId" not in root.attrib
