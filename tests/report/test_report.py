"""Style, expressivity parameters and feedback in a report: predictions come before warnings."""

import xml.etree.ElementTree as ElementTree
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from kinesic.controller.dry_run import dry_run
from kinesic.expressivity.keyframes import BodyMove, Turn
from kinesic.expressivity.style.style import EXPRESSIVITY_RANGES, style_preset
from kinesic.planning.setup import Setup
from kinesic.planning.syncs import SHIFT_TO_WARN
from kinesic.report.report import Json, _body, feedback, report
from kinesic.session.plan import plan
from kinesic.session.setup import set_up

BML = """
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:kinesic="urn:kinesic" id="b" kinesic:head.fluidity="0.5">
  <head id="h" lexeme="NOD" start="0" kinesic:power="-0.5"/>
  <wait id="w" duration="0.1"/>
</bml>
"""
BLOCK_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
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
SHIFTED_BLOCKS = ("too soon", "too fast", "both")
UNSHIFTED_BLOCKS = ("feasible", "still", "empty")


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
    return {name: plan(BLOCK_TEMPLATE.format(text), known) for name, text in BLOCKS.items()}


def local(element):
    return element.tag.rpartition("}")[2]


def messages_of(planned):
    return [ElementTree.fromstring(message) for message in feedback(planned)]


def read_shift_warnings(messages):
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
def test_feedback_warns_of_exactly_those_sync_points_that_shift_by_more_than_10_ms(plans, name):
    planned = plans[name]
    moved = Counter(
        (f"b:{sync.behaviour}", sync.sync)
        for sync in planned.syncs
        if abs(sync.planned - sync.requested) > SHIFT_TO_WARN
    )
    assert read_shift_warnings(messages_of(planned)) == moved


def test_feedback_warns_of_shifts_only_for_example_blocks_whose_sync_points_shift(plans):
    for name in SHIFTED_BLOCKS:
        assert read_shift_warnings(messages_of(plans[name])), name
    for name in UNSHIFTED_BLOCKS:
        assert not read_shift_warnings(messages_of(plans[name])), name


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


@pytest.mark.parametrize("name", SHIFTED_BLOCKS)
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
    result = report(dry_run(plan(BLOCK_TEMPLATE.format(gestures + nod), known)), source="x.bml")
    shrug, crossed, head = result["behaviours"]
    assert 12 <= shrug["body"]["shoulders_deg"] <= 20
    assert 5 <= shrug["body"]["head_deg"] <= 8
    assert shrug["body"]["face"].keys() == {"raise_brows", "lower_mouth_corners"}
    assert crossed["body"] is head["body"] is None
    assert shrug["hands"] == crossed["hands"] == ["left", "right"]
    assert head["hands"] == []
    assert result["whole_body"] == {"weight": 1.0, "gestures": 1, "lacking": ""}


@pytest.fixture(scope="module")
def hurried_data(hurried) -> dict[str, Json]:
    return report(hurried, source="hurried.bml", seed=7)


def test_report_separates_requested_from_feasible_hand_shapes(calm) -> None:
    shapes = {"offering": ("open", "fist", "point")}
    planned = replace(calm.plan, keyframes=replace(calm.plan.keyframes, shapes=shapes))
    planned.__dict__["missing_shapes"] = {"offering": ("fist",)}  # what the cached property would work out
    performance = replace(calm, reference=replace(calm.reference, plan=planned))
    (row,) = report(performance, source="x.bml")["behaviours"]
    assert row["shapes"] == {"asked": ["open", "fist", "point"], "made": ["open", "point"]}
    bare = replace(planned, keyframes=replace(planned.keyframes, shapes={}))
    (row,) = report(replace(calm, reference=replace(calm.reference, plan=bare)), source="x.bml")["behaviours"]
    assert row["shapes"] is None


@pytest.mark.parametrize(("miss", "text"), [(0.02, ""), (0.034, "hand stays 3 cm from its target")])
def test_report_names_a_hand_that_misses_its_target_by_more_than_2_cm(calm, miss: float, text: str) -> None:
    planned = replace(calm.plan, postures=replace(calm.plan.postures, misses={"offering": miss}))
    (row,) = report(replace(calm, reference=replace(calm.reference, plan=planned)), source="x.bml")["behaviours"]
    assert row["why"].startswith(text)
    assert bool(row["why"]) == bool(text)


def test_report_has_the_settings_of_its_plan(hurried, hurried_data: dict[str, Json]) -> None:
    setup = hurried.plan.setup
    expected = {
        "schema": 1,
        "robot": setup.robot.name,
        "input": "hurried.bml",
        "seed": 7,
        "variation": setup.variation.amount,
        "idle": setup.idling.amount,
        "prosody": setup.prosody,
        "ok": hurried_data["grade"] != "fail",
        "warnings": [{"type": n.type.value, "id": n.id, "text": n.text} for n in hurried.plan.notices],
    }
    assert {key: hurried_data[key] for key in expected} == expected
    assert hurried_data["synchrony"] == {
        "strokes": len(hurried.stroke_lags),
        "median_s": hurried.median_stroke_lag,
    }


def test_report_has_requested_planned_and_measured_sync_times(hurried, hurried_data: dict[str, Json]) -> None:
    assert len(hurried_data["sync"]) == len(list(hurried.plan.syncs))
    tied = {(lag.behaviour, lag.sync): lag for lag in hurried.stroke_lags}
    for row, sync in zip(hurried_data["sync"], hurried.plan.syncs, strict=True):
        lag, force = hurried.lags.get(sync, 0.0), tied.get((sync.behaviour, sync.sync))
        assert row["id"] == f"block:{sync.behaviour}:{sync.sync}"
        assert (row["asked_s"], row["planned_s"]) == (sync.requested, sync.planned)
        assert row["twin_s"] == (None if lag is None else sync.planned + lag)
        for key, name in (("word", "word"), ("accent_s", "accent"), ("fastest_s", "fastest"), ("fastest_lag_s", "lag")):
            assert row[key] == (None if force is None else getattr(force, name))
    assert any(lag for lag in hurried.lags.values()), "a delay of 0 tells nothing"


def test_report_lists_tracking_errors_and_limit_peaks_and_supply_power_of_the_twin(
    hurried, hurried_data: dict[str, Json]
) -> None:
    names, power = hurried.plan.setup.robot.skeleton.names, hurried.measured.power
    squares = np.degrees(np.nan_to_num(hurried.errors)) ** 2
    moving = np.maximum(hurried.reference.moving.sum(axis=0), 1)
    expected = np.sqrt(squares.sum(axis=0) / moving)
    assert hurried_data["tracking"]["per_joint"] == pytest.approx(dict(zip(names, expected, strict=True)))
    late = hurried.tracking_delays
    assert hurried_data["tracking"]["lateness_s"] == {
        name: lag for name, lag in zip(names, late.tolist(), strict=True) if np.isfinite(lag)
    }
    tracking = hurried.tracking
    assert [hurried_data["tracking"][key] for key in ("rmse_deg", "p95_deg", "max_deg")] == [
        tracking.rmse,
        tracking.p95,
        tracking.max,
    ]
    assert hurried_data["power"] == {
        "peak_a": power.peak.max(),
        "mean_a": pytest.approx(power.mean.mean()),
        "supply_a": hurried.plan.setup.robot.supply.amps,
        "energy_j": power.energy,
        "warming_k": {name: rise.max() for name, rise in power.warming.items()},
    }
    peaks = hurried.reference.peaks.by_quantity
    worst = hurried_data["limits"]["worst"]
    assert worst["ratio"] == max(peak.ratios.max() for peak in peaks.values())
    peak = peaks[worst["quantity"]]
    assert (worst["joint"], worst["time_s"]) == (names[peak.hinge], peak.time)
    lost = np.degrees(hurried.plan.motion.rms_distances)
    assert hurried_data["conditioning"]["lost_deg"] == pytest.approx(dict(zip(names, lost.tolist(), strict=True)))
    assert len(hurried_data["conditioning"]["gave"]) == len(hurried.reference.changes)


def test_report_names_the_two_segments_that_come_nearest_in_plan_or_twin(
    hurried, hurried_data: dict[str, Json]
) -> None:
    plan_, measured = hurried.plan, hurried.measured
    spans = [(plan_.clearance, plan_.clearance_times), (measured.clearance, measured.times)]
    clearance, times = min(spans, key=lambda span: span[0].distances.min())
    row = int(clearance.distances.argmin())
    assert hurried_data["collision"] == {
        "penetrations": 0,
        "min_distance_m": clearance.distances[row],
        "pair": list(clearance.pairs[row]),
        "time_s": times[row],
    }
    hands = hurried_data["smoothness"]["hands"]
    for side, hand in hurried.hand_smoothness.items():
        assert hands[side] == {
            "dimensionless_jerk": hand.planned_jerk,
            "sparc_planned": hand.planned_arc_length,
            "sparc_twin": hand.performed_arc_length,
        }


def test_report_states_parsing_and_planning_times_in_milliseconds(hurried, hurried_data: dict[str, Json]) -> None:
    timing, planned = hurried_data["timing"], hurried.plan
    assert timing["parse_ms"] == pytest.approx(1000 * planned.parse_seconds)
    assert timing["plan_ms"] == pytest.approx(1000 * planned.seconds)
    assert timing["first_command_ms"] == pytest.approx(timing["parse_ms"] + timing["plan_ms"])
    assert timing["real_time_factor"] == pytest.approx(1000 * planned.duration / timing["dry_run_ms"])
    assert (timing["duration_s"], timing["zero_s"]) == (planned.duration, planned.trajectory.zero)


def test_feedback_of_a_performance_has_measured_times(hurried) -> None:
    messages = [ElementTree.fromstring(message) for message in feedback(hurried.plan, hurried.lags)]
    progress = {(m.get("id"), float(m.get("globalTime"))) for m in messages if local(m) == "syncPointProgress"}
    for sync, lag in hurried.lags.items():
        if lag is not None:
            times = [time for id, time in progress if id == f"block:{sync.behaviour}:{sync.sync}"]
            assert times == [pytest.approx(sync.planned + lag, abs=1e-3)]


def test_report_lists_the_largest_head_and_trunk_and_shoulder_rotation_in_degrees() -> None:
    head = Turn(torsion=np.radians(4.0), tilt=np.radians(3.0), roll=np.radians(-2.0))
    trunk = Turn(torsion=np.radians(-6.0), tilt=np.radians(1.0), roll=0.0)
    move = BodyMove(head=head, trunk=trunk, shoulders=np.radians(9.0), nod=np.radians(5.0), shake=np.radians(-2.0))
    result = _body(move)
    assert (result["head_deg"], result["trunk_deg"], result["shoulders_deg"]) == pytest.approx((8.0, 6.0, 9.0))
    assert result["eyes_deg"] is None
    shown = _body(replace(move, eyes=Turn(torsion=np.radians(7.0), tilt=np.radians(5.0), roll=0.0)))
    assert shown["eyes_deg"] == pytest.approx([7.0, -5.0])
