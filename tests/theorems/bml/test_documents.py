"""Property tests: any document is parsed or refused with its position."""

import json
import re
from xml.etree.ElementTree import fromstring

from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import BmlError, Speech
from kinesic.bml.feedback import write_prediction, write_warning
from kinesic.bml.parse import parse
from kinesic.bml.reading.elements import ACTION_READERS
from kinesic.bml.reading.vocabulary import BEHAVIOUR_ATTRIBUTES
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

SYNC_NAMES = ("start", "ready", "stroke", "strokeEnd", "relax", "end")
ELEMENT_NAMES = sorted({*ACTION_READERS, "body", "saccade", "sbm:reach", "bmla:interrupt", "blink", "faceVA", "odd"})
SAMPLE_WORDS = st.sampled_from(
    ["beat", "NOD", "user", "1 2 3", "LEFT_HAND", "EYES NECK", "1_left", "X", "", "\ud800", "<&>"]
)
TIME_VALUES = st.one_of(
    st.floats(-3, 9).map(lambda time: round(time, 3)),
    st.sampled_from(["g:end+1", "s:start", "x:y", "nan", "after(g:end)"]),
)
READ_ATTRIBUTES = sorted({name for names in BEHAVIOUR_ATTRIBUTES.values() for name in names})
EXTRA_ATTRIBUTES = (
    "repeats",
    "sbm:joint-range",
    "sbm:target-pos",
    "poststroke_hold",
    "shift",
    "bodyMovement",
    "emotion",
    "name",
)
ATTRIBUTE_PAIRS = st.one_of(
    st.tuples(
        st.sampled_from([*READ_ATTRIBUTES, *EXTRA_ATTRIBUTES, "id"]),
        st.one_of(SAMPLE_WORDS, st.integers(0, 10**30), st.booleans(), st.none()),
    ),
    st.tuples(st.sampled_from(SYNC_NAMES), TIME_VALUES),
)
BEHAVIOUR_ITEMS = st.tuples(st.sampled_from(ELEMENT_NAMES), st.lists(ATTRIBUTE_PAIRS, max_size=5)).map(
    lambda each: {"type": each[0], **dict(each[1])}
)
JSON_TREES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.floats(), SAMPLE_WORDS),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.sampled_from(["type", "data", "text", "pose", "a"]), inner, max_size=3),
    ),
    max_leaves=12,
)


def is_parsed_or_refused(text: str) -> None:
    """Assert that a document is parsed, or refused with the error's position."""
    document_error = read_response(text)
    assert document_error == "" or re.match(r"f:\d+:\d+: .+; .+", document_error, re.DOTALL)


def read_response(text: str) -> str:
    """Return the error of a document, or check its feedback."""
    try:
        block = parse(text, source="f")
        utterances = {
            behaviour.id: Utterance(1.0, {mark.name: 0.5 for mark in behaviour.action.script.marks})
            for behaviour in block.behaviours
            if isinstance(behaviour.action, Speech)
        }
        timeline = schedule(block, utterances, {})
    except BmlError as error:
        return str(error)
    times = {timed.behaviour.id: timed.times for timed in timeline.timed}
    fromstring(write_prediction(block, timeline.start, timeline.end, times))
    for notice in timeline.notices:
        fromstring(write_warning(notice))
    return ""


@given(st.lists(BEHAVIOUR_ITEMS, max_size=4), st.booleans())
def test_json_behaviours_are_parsed_or_refused_with_a_position(
    behaviours: list[dict[str, object]], in_envelope: bool
) -> None:
    is_parsed_or_refused(json.dumps({"id": "b", "data": behaviours} if in_envelope else behaviours))


@given(
    st.one_of(
        st.lists(JSON_TREES, max_size=4),
        st.dictionaries(st.sampled_from(["bml", "data", "required", "constraints"]), JSON_TREES),
    )
)
def test_any_json_is_parsed_or_refused_with_a_position(tree: object) -> None:
    is_parsed_or_refused(json.dumps(tree))


@given(st.lists(BEHAVIOUR_ITEMS, max_size=4))
def test_xml_fragments_are_parsed_or_refused_with_a_position(behaviours: list[dict[str, object]]) -> None:
    is_parsed_or_refused(
        "".join(f"<{behaviour['type']} {' '.join(map(attribute, behaviour.items()))}/>" for behaviour in behaviours)
    )


def attribute(item: tuple[str, object]) -> str:
    text = str(item[1]).replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return "" if item[0] == "type" and item[1] in ELEMENT_NAMES else f'{item[0]}="{text}"'


@given(st.text(alphabet='<>/[]{}":, bmlheadgztyp=\n', max_size=60))
def test_any_text_is_parsed_or_refused_with_a_position(text: str) -> None:
    is_parsed_or_refused(text)
