"""Start times, references and ids of requests, without planning."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from kinesic.bml.block import DEFAULT_BLOCK_ID, Notice, NoticeType, Timeline
from kinesic.bml.composition import BlockState
from kinesic.bml.parse import parse
from kinesic.bml.timing.constraints import Point
from kinesic.realizer import request as module
from kinesic.realizer.request import (
    ID_SEARCH_SIZE,
    Message,
    SceneContext,
    TimedRequest,
    anchor_references,
    block_id,
    parse_message,
    read_request,
    refers_elsewhere,
    retime_request,
)

from .conftest import BML_NAMESPACES

BML = f'<bml {BML_NAMESPACES} id="b" {{}}>{{}}</bml>'
NODS = '<head id="h" lexeme="NOD" start="{}"/><head id="k" lexeme="NOD" start="{}"/>'
FML = '<fml-apml><fml><emotion type="joy" start="0" end="3" importance="1"/></fml></fml-apml>'
CONTEXT = SceneContext(
    now=10.0,
    states={"a": BlockState.IN_EXEC, "w": BlockState.LURKING},
    relaxes={"a": 12.0},
    ends={"a": 13.0},
    times={Point("a", "g", "stroke"): 11.0, Point("b", "h", "start"): 99.0},
)


def block(inside: str = "", attributes: str = ""):
    return parse(BML.format(attributes, inside))


def test_default_scene_context_of_a_request_is_at_time_zero_without_blocks():
    empty = SceneContext()
    assert (empty.now, empty.states, empty.relaxes, empty.ends, empty.times) == (0.0, {}, {}, {}, {})
    assert empty.expected_start(block()) == 0.0


@pytest.mark.parametrize(
    ("attributes", "inside", "start"),
    [
        ("", "", 10.0),
        ("", NODS.format("a:g:stroke", "0"), 10.15),
        ("", NODS.format("k:start", "0"), 10.0),
        ('composition="APPEND"', "", 13.0),
        ('composition="APPEND"', NODS.format("a:g:stroke", "0"), 13.0),
        ('bmla:chunkAfter="a"', "", 12.0),
        ('bmla:chunkAfter="w"', "", 10.0),
    ],
)
def test_expected_start_of_a_block_is_after_planning_of_references_and_after_dependencies(attributes, inside, start):
    assert CONTEXT.expected_start(block(inside, attributes)) == pytest.approx(start)


def test_references_to_existing_blocks_become_offsets_from_the_block_start():
    anchored = anchor_references(block(NODS.format("a:g:stroke+0.25", "gone:g:stroke+0.25")), CONTEXT, 10.5)
    known, unknown = (behaviour.syncs["start"] for behaviour in anchored.behaviours)
    assert (known.block, known.behaviour, known.sync) == ("b", "bml", "start")
    assert known.offset == pytest.approx(11.0 - 10.5 + 0.25)
    assert (unknown.block, unknown.offset) == ("gone", 0.25)


def test_time_references_within_a_block_are_kept():
    own = block(NODS.format("k:start+0.5", "0"))
    assert not refers_elsewhere(own)
    assert anchor_references(own, CONTEXT, 10.0) is own
    mixed = block(NODS.format("a:g:stroke", "h:start+0.5"))
    ref = anchor_references(mixed, CONTEXT, 10.0).behaviours[1].syncs["start"]
    assert (ref.behaviour, ref.offset) == ("h", 0.5)


@pytest.mark.parametrize(
    "constraint",
    [
        '<synchronize><sync ref="h:end"/><sync ref="a:g:stroke"/></synchronize>',
        '<after ref="a:g:stroke"><sync ref="h:stroke"/></after>',
        '<after ref="h:stroke"><sync ref="a:g:stroke"/></after>',
        '<before ref="a:g:stroke"><sync ref="h:stroke"/></before>',
    ],
)
def test_references_in_constraints_are_replaced_on_both_sides(constraint):
    made = block(NODS.format("0", "1") + f"<constraint>{constraint}</constraint>")
    assert refers_elsewhere(made)
    assert not refers_elsewhere(anchor_references(made, CONTEXT, 10.0))


def test_request_lists_times_and_notices_of_its_timeline():
    made = block(NODS.format("0", "1"))
    timed = tuple(
        SimpleNamespace(behaviour=behaviour, times={"start": time})
        for behaviour, time in zip(made.behaviours, (-0.5, 2.0), strict=True)
    )
    notice = Notice(NoticeType.IMPOSSIBLE_TO_SCHEDULE, "b", "no")
    request = TimedRequest(4, made, {}, Timeline(made, timed, (), (notice,)), 10.0)
    assert request.times == {"h": {"start": -0.5}, "k": {"start": 2.0}}
    assert request.notices == (notice,)
    assert 'globalStart="9.5" globalEnd="12.0"' in request.prediction
    assert (request.is_anchored, request.is_decided, request.busy_hands) == (False, False, ())


def test_client_message_has_sender_number_zero_by_default():
    message = Message("text")
    assert (message.sender, message.source) == (0, "<text>")


@pytest.mark.parametrize(
    ("inside", "is_anchored", "zero"),
    [
        (NODS.format("-0.5", "1"), False, 10.5),
        (NODS.format("a:g:stroke-5", "1"), True, 10.15),
        ("", False, 10.0),
    ],
)
def test_only_a_block_with_references_is_anchored_and_starts_after_the_planning_time(known, inside, is_anchored, zero):
    found = read_request(Message(BML.format("", inside), 4), known, context=CONTEXT)
    assert (found.is_anchored, found.sender) == (is_anchored, 4)
    assert found.zero == pytest.approx(zero)


@pytest.fixture
def readers(monkeypatch):
    """Record the options of both parsers."""
    calls = []

    def reader(name):
        def take(text, **options):
            calls.append((name, text, options))
            return name

        return take

    for name in ("parse", "parse_fml"):
        monkeypatch.setattr(module, name, reader(name))
    return calls


@pytest.mark.parametrize(
    ("dialect", "text", "size", "name"),
    [
        ("auto", FML, len(FML), "parse_fml"),
        ("fml-apml", FML, len(FML), "parse_fml"),
        ("bml", FML, len(FML), "parse"),
        ("auto", FML, len(FML) - 1, "parse"),
        ("auto", BML.format("", ""), 9999, "parse"),
    ],
)
def test_fml_document_is_parsed_as_fml_unless_too_large_or_declared_as_bml(known, readers, dialect, text, size, name):
    setup = replace(known, dialect=dialect, character="Anna")
    bounds = SimpleNamespace(size=size)
    assert parse_message(text, setup, source="m.xml", known_blocks=("a",), bounds=bounds) == name
    ((_, given, options),) = readers
    assert given == text
    assert (options["source"], options["performer"], options["known_blocks"]) == ("m.xml", "Anna", ("a",))
    assert options["bounds"] is bounds
    if name == "parse":
        assert (options["dialect"], options["recordings"]) == (dialect, setup.recordings)
    else:
        assert (options["sets"], options["seed"]) == (None, setup.idling.seed)


def test_only_speech_that_has_not_started_is_synthesised(known, monkeypatch):
    monkeypatch.setattr(module, "synthesise_block", lambda block, setup: {"s": "fresh"})
    monkeypatch.setattr(module, "natural_durations", lambda context, utterances: utterances)
    monkeypatch.setattr(module, "schedule", lambda block, utterances, durations: (block, utterances, durations))
    made = block()
    early = TimedRequest(4, made, {"s": "spoken"}, Timeline(made, ()), 10.0)
    for is_decided, utterances in ((False, {"s": "fresh"}), (True, {"s": "spoken"})):
        found = retime_request(replace(early, is_decided=is_decided), known)
        assert found.utterances == utterances
        assert found.timeline == (made, utterances, utterances)
        assert (found.zero, found.sender) == (10.0, 4)


@pytest.mark.parametrize(("spare", "expected"), [(0, "late"), (1, DEFAULT_BLOCK_ID)])
def test_block_id_is_searched_only_in_the_beginning_of_a_document(spare, expected):
    opening = '<bml id="late"'
    text = " " * (ID_SEARCH_SIZE + spare - len(opening)) + opening + "/>"
    assert ID_SEARCH_SIZE == 65_536
    assert block_id(text) == expected


def test_block_id_is_that_of_the_first_bml_element_with_an_id():
    assert block_id('<bml id="one"/><bml id="two"/>') == "one"
    assert block_id("<bml x='1' id = 'one'/>") == "one"
    assert block_id("<bml/><x:bml id='two'/>") == "two"
    assert block_id('<head id="h"/>') == DEFAULT_BLOCK_ID
    assert block_id('  {"id": "json"}') == "json"
    assert block_id('[{"id": "json"}]') == DEFAULT_BLOCK_ID
