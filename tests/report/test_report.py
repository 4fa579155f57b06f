"""Style, manners and feedback in a report: predictions first, then a warning for each shift."""

import xml.etree.ElementTree as ElementTree
from collections import Counter
from dataclasses import replace

import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, style_preset
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.report import Json, feedback, report
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="b" kinesic:head.fluidity="0.5">
  <head id="h" lexeme="NOD" start="0" kinesic:power="-0.5"/>
  <wait id="w" duration="0.1"/>
</bml>
"""
ROOT = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
BLOCKS = {
    "feasible": '<gesture id="g" lexeme="beat" mode="RIGHT_HAND" stroke="2.5"/><head id="h" lexeme="NOD" start="2"/>',
    "still": '<faceLexeme id="f" lexeme="OPEN_MOUTH"/>',
    "empty": "",
    "too soon": '<gesture id="g" lexeme="up" mode="RIGHT_HAND" stroke="0.05"/>',
    "too fast": '<gesture id="a" lexeme="up" mode="RIGHT_HAND" stroke="1.5"/>'
    '<gesture id="z" lexeme="belly" mode="RIGHT_HAND" stroke="1.65"/>'
    '<head id="h" lexeme="SHAKE" start="1" end="1.2"/>',
    "both": '<gesture id="a" lexeme="large" mode="BOTH_HANDS" stroke="0.1"/><head id="h" lexeme="NOD" start="6"/>',
    "with speech": '<speech id="s"><text>Well, <sync id="m"/>hello.</text></speech>'
    '<gesture id="g" lexeme="offer" mode="RIGHT_HAND" stroke="s:m"/>',
}
MOVED = ("too soon", "too fast", "both")
KEPT = ("feasible", "still", "empty")


@pytest.fixture(scope="module")
def data(known: Setup) -> dict[str, Json]:
    style = style_preset("calm").changed(["head.spatial=0.25"])
    return report(dry_run(plan(BML, replace(known, style=style))), source="x.bml")


def test_report_lists_style_parameters_per_modality_with_changes(data: dict[str, Json]) -> None:
    style = data["style"]
    assert style["name"] == "calm"
    assert {name: style[name] for name in EXPRESSIVITY_RANGES} == style["gesture"]
    assert (style["head"]["spatial"], style["torso"]["spatial"]) == (0.25, style_preset("calm").torso.spatial)
    assert style["settings"] == ["head.spatial=0.25"]
    assert style["block"] == {"head": {"fluidity": 0.5}}


def test_report_lists_style_parameters_of_a_behaviour_with_their_sources(data: dict[str, Json]) -> None:
    nod, wait = data["behaviours"]
    sources = {"power": (-0.5, "behaviour"), "fluidity": (0.5, "block"), "spatial": (0.25, "setting")}
    for name, own in vars(style_preset("calm").head).items():
        value, source = sources.get(name, (own, "style"))
        assert (nod["manner"]["values"][name], nod["manner"]["sources"][name]) == (value, source)
    assert (nod["manner"]["modality"], nod["manner"]["intensity"]) == ("head", None)
    assert wait["manner"] is None


@pytest.fixture(scope="module")
def plans():
    known = set_up()
    return {name: plan(ROOT.format(text), known) for name, text in BLOCKS.items()}


def local(element):
    return element.tag.rpartition("}")[2]


def messages_of(planned):
    return [ElementTree.fromstring(message) for message in feedback(planned)]


def shifts_told(messages):
    """Return (id, sync point) of each warning of a time shift."""
    return Counter(
        (message.get("id"), sync)
        for message in messages
        if local(message) == "warningFeedback" and " planned at " in message.text
        for sync in message.text.partition(" requested at ")[0].split(" and ")
    )


@pytest.mark.parametrize("name", BLOCKS)
def test_prediction_feedback_is_first_and_warnings_precede_motion(plans, name):
    names = [local(message) for message in messages_of(plans[name])]
    moves = names.index("blockProgress")
    assert names[0] == "predictionFeedback"
    assert names.count("predictionFeedback") == 1
    assert set(names[1:moves]) <= {"warningFeedback"}
    assert "warningFeedback" not in names[moves:]


@pytest.mark.parametrize("name", BLOCKS)
def test_only_sync_point_shifts_above_10_ms_cause_a_warning(plans, name):
    planned = plans[name]
    moved = Counter(
        (f"b:{sync.behaviour}", sync.sync)
        for sync in planned.syncs
        if abs(sync.planned - sync.requested) > SHIFT_TO_WARN
    )
    assert shifts_told(messages_of(planned)) == moved


def test_only_example_blocks_with_shifted_sync_points_report_shifts(plans):
    for name in MOVED:
        assert shifts_told(messages_of(plans[name])), name
    for name in KEPT:
        assert not shifts_told(messages_of(plans[name])), name


@pytest.mark.parametrize("name", BLOCKS)
def test_prediction_feedback_has_planned_times(plans, name):
    planned = plans[name]
    prediction = messages_of(planned)[0]
    times = {}
    for element in list(prediction)[1:]:
        behaviour = element.get("id").removeprefix("b:")
        times |= {(behaviour, key): float(value) for key, value in element.attrib.items() if key != "id"}
        times |= {(behaviour, sync.get("id")): float(sync.get("time")) for sync in element}
    assert times == pytest.approx({(sync.behaviour, sync.sync): sync.planned for sync in planned.syncs}, abs=1e-6)


@pytest.mark.parametrize("name", MOVED)
def test_shift_warning_names_both_times_and_the_limiting_joint(plans, name):
    planned = plans[name]
    texts = [m.text for m in messages_of(planned) if local(m) == "warningFeedback" and " planned at " in m.text]
    hinges = planned.setup.robot.skeleton.names
    for text in texts:
        assert " requested at " in text
        assert any(hinge in text for hinge in hinges), text


def test_accompanying_body_motion_is_reported_per_gesture(known: Setup) -> None:
    gestures = '<gesture id="g" lexeme="doubt_shrug" stroke="2"/><gesture id="r" lexeme="arms_crossed" start="6"/>'
    nod = '<head id="h" lexeme="NOD" stroke="3"/>'
    result = report(dry_run(plan(ROOT.format(gestures + nod), known)), source="x.bml")
    shrug, crossed, head = result["behaviours"]
    assert 12 <= shrug["body"]["shoulders_deg"] <= 20
    assert 5 <= shrug["body"]["head_deg"] <= 8
    assert shrug["body"]["face"].keys() == {"raise_brows", "lower_mouth_corners"}
    assert crossed["body"] is head["body"] is None
    assert shrug["hands"] == crossed["hands"] == ["left", "right"]
    assert head["hands"] == []
    assert result["whole_body"] == {"weight": 1.0, "gestures": 1, "lacking": ""}
