"""Whatever comes as a document becomes a block or is refused with its place, and what is told of it is XML."""

import json
import re
from xml.etree.ElementTree import fromstring

from hypothesis import given
from hypothesis import strategies as st

from kinesic.bml.block import BmlError, Speech
from kinesic.bml.feedback import prediction, warning
from kinesic.bml.parse import parse
from kinesic.bml.reading.elements import ACTIONS
from kinesic.bml.reading.vocabulary import ATTRIBUTES
from kinesic.bml.schedule import schedule
from kinesic.body.utterance import Utterance

SYNCS = ("start", "ready", "stroke", "strokeEnd", "relax", "end")
NAMES = sorted({*ACTIONS, "body", "saccade", "sbm:reach", "bmla:interrupt", "blink", "faceVA", "odd"})
WORDS = st.sampled_from(["beat", "NOD", "user", "1 2 3", "LEFT_HAND", "EYES NECK", "1_left", "X", "", "\ud800", "<&>"])
TIMES = st.one_of(
    st.floats(-3, 9).map(lambda time: round(time, 3)),
    st.sampled_from(["g:end+1", "s:start", "x:y", "nan", "after(g:end)"]),
)
READ = sorted({name for names in ATTRIBUTES.values() for name in names})
MORE = ("repeats", "sbm:joint-range", "sbm:target-pos", "poststroke_hold", "shift", "bodyMovement", "emotion", "name")
FIELDS = st.one_of(
    st.tuples(
        st.sampled_from([*READ, *MORE, "id"]), st.one_of(WORDS, st.integers(0, 10**30), st.booleans(), st.none())
    ),
    st.tuples(st.sampled_from(SYNCS), TIMES),
)
BEHAVIOURS = st.tuples(st.sampled_from(NAMES), st.lists(FIELDS, max_size=5)).map(
    lambda each: {"type": each[0], **dict(each[1])}
)
TREES = st.recursive(
    st.one_of(st.none(), st.booleans(), st.floats(), WORDS),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.sampled_from(["type", "data", "text", "pose", "a"]), inner, max_size=3),
    ),
    max_leaves=12,
)


def held(text: str) -> None:
    """A document is refused with its place, or becomes a block whose feedback can be read."""
    refusal = told(text)
    assert refusal == "" or re.match(r"f:\d+:\d+: .+; .+", refusal, re.DOTALL)


def told(text: str) -> str:
    """Why a document is refused; else its feedback is read, as far as it is known before anything moves."""
    try:
        block = parse(text, source="f")
        utterances = {
            each.id: Utterance(1.0, {mark.name: 0.5 for mark in each.action.script.marks})
            for each in block.behaviours
            if isinstance(each.action, Speech)
        }
        timeline = schedule(block, utterances, {})
    except BmlError as error:
        return str(error)
    times = {timed.behaviour.id: timed.times for timed in timeline.timed}
    fromstring(prediction(block, timeline.start, timeline.end, times))
    for notice in timeline.notices:
        fromstring(warning(notice))
    return ""


@given(st.lists(BEHAVIOURS, max_size=4), st.booleans())
def test_behaviours_as_json(behaviours: list[dict[str, object]], in_envelope: bool) -> None:
    held(json.dumps({"id": "b", "data": behaviours} if in_envelope else behaviours))


@given(
    st.one_of(
        st.lists(TREES, max_size=4), st.dictionaries(st.sampled_from(["bml", "data", "required", "constraints"]), TREES)
    )
)
def test_any_json(tree: object) -> None:
    held(json.dumps(tree))


@given(st.lists(BEHAVIOURS, max_size=4))
def test_behaviours_as_fragments(behaviours: list[dict[str, object]]) -> None:
    held("".join(f"<{each['type']} {' '.join(map(attribute, each.items()))}/>" for each in behaviours))


def attribute(item: tuple[str, object]) -> str:
    text = str(item[1]).replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    return "" if item[0] == "type" and item[1] in NAMES else f'{item[0]}="{text}"'


@given(st.text(alphabet='<>/[]{}":, bmlheadgztyp=\n', max_size=60))
def test_any_text(text: str) -> None:
    held(text)
