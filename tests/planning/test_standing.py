"""Tests of standing postures of styles: ranges, clearance, variation and overriding documents."""

from dataclasses import replace

import numpy as np
import pytest

from kinesic.bml.parse import parse
from kinesic.body.config import names_of
from kinesic.body.robot import Robot
from kinesic.expressivity.keyframes import Turn
from kinesic.expressivity.style.standing import Standing
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.turns import rest_head_turn, rest_turn, turn_angles
from kinesic.planning import standing as standing_module
from kinesic.planning.arm_directions import ARM_FEATURES, measure_arm
from kinesic.planning.clearance import LAG_RESERVE
from kinesic.planning.face_track import compute_action_units
from kinesic.planning.quick_plan import plan_quickly
from kinesic.planning.stance import STANCE_FEATURES, draw_arm_pose, draw_deviation, read_stances
from kinesic.planning.standing import STANDING_STREAM, _take_rest_gesture, draw_rest, standing_robot
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.distances import CapsuleDistances

# document whose {} is replaced by behaviours
BML_TEMPLATE = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">{}</bml>'
TESTED_ROBOTS = {name: Robot.load(name) for name in ("human", "upper22", "upper36")}  # robots by name


@pytest.fixture(scope="module")
def lexicon():
    return set_up().lexicon


@pytest.fixture(scope="module")
def sad():
    return set_up(style="sad")


def wrist(robot, side="l"):
    return (robot.skeleton.rest_frames.origins[robot.arm(side).wrist] - robot.gesture_origin) / robot.arm_length


@pytest.mark.parametrize("name", TESTED_ROBOTS)
@pytest.mark.parametrize("style", names_of("style"))
def test_standing_posture_keeps_joint_ranges_and_clearance(name, style, lexicon):
    robot = TESTED_ROBOTS[name]
    standing = standing_robot(robot, Style.load(style), lexicon, CapsuleDistances(robot))
    rest, skeleton = standing.skeleton.rest, standing.skeleton
    gaps, own_gaps = CapsuleDistances(standing).gaps(np.stack([rest, robot.skeleton.rest]))
    assert np.all((rest >= skeleton.lower) & (rest <= skeleton.upper))
    assert np.all(gaps >= np.minimum(robot.min_clearance + LAG_RESERVE, own_gaps) - 1e-9)
    assert (standing is robot) == (style == "neutral")


@pytest.mark.parametrize("style", ["sad", "angry"])
def test_robot_keeps_its_rest_posture_if_no_standing_posture_is_collision_free(style, lexicon, monkeypatch):
    monkeypatch.setattr(standing_module, "_is_clear", lambda *_: False)
    robot = TESTED_ROBOTS["upper22"]
    without_gesture = replace(Style.load(style), standing=replace(Style.load(style).standing, rest=""))
    assert standing_robot(robot, without_gesture, lexicon, CapsuleDistances(robot)) is robot


@pytest.mark.parametrize("name", TESTED_ROBOTS)
def test_standing_postures_of_styles_differ_in_head_trunk_shoulders_and_hands(name, lexicon):
    robot = TESTED_ROBOTS[name]
    bodies = {s: standing_robot(robot, Style.load(s), lexicon, CapsuleDistances(robot)) for s in names_of("style")}
    tilts = {style: np.degrees(rest_head_turn(body).tilt) for style, body in bodies.items()}
    leans = {style: np.degrees(rest_turn(body, "torso").tilt) for style, body in bodies.items()}
    lift = robot.skeleton.joint("l_sternoclavicular_abduct")
    assert tilts["sad"] > 15.0 > tilts["neutral"] == 0.0 > tilts["joyful"] > tilts["proud"]
    assert leans["proud"] < -5.0 < 5.0 < leans["angry"]
    assert np.degrees(bodies["sad"].skeleton.rest[lift]) < -3.0 < 5.0 < np.degrees(bodies["shy"].skeleton.rest[lift])
    assert abs(wrist(bodies["angry"])[1]) > abs(wrist(bodies["neutral"])[1]) + 0.05


def test_middle_finger_of_an_angry_standing_posture_is_bent_by_over_20_degrees(lexicon):
    robot = TESTED_ROBOTS["upper36"]
    angry = standing_robot(robot, Style.load("angry"), lexicon, CapsuleDistances(robot))
    bend = robot.skeleton.joint("l_middle_flexion1")
    assert np.degrees(angry.skeleton.rest[bend] - robot.skeleton.rest[bend]) > 20.0


def test_posture_weight_zero_keeps_the_rest_posture_and_a_neutral_face():
    plain = set_up(style="sad", settings=["posture=0"])
    assert np.array_equal(plain.robot.skeleton.rest, set_up().robot.skeleton.rest)
    made = plan_quickly(parse(BML_TEMPLATE.format('<wait id="w" duration="2"/>')), plain)
    assert "L15" not in compute_action_units(made, np.linspace(0.0, 1.5, 4))


def test_lowered_standing_head_nods_from_its_lowered_position(sad):
    made = plan_quickly(parse(BML_TEMPLATE.format('<head id="h" lexeme="NOD" start="0.5"/>')), sad)
    tilt = sad.robot.skeleton.joint("skullbase_tilt")
    angles = made.trajectory.sample(np.linspace(0.0, made.trajectory.duration, 200))[0][:, tilt]
    rest = sad.robot.skeleton.rest[tilt]
    assert angles[0] == pytest.approx(rest, abs=1e-6) == angles[-1]
    assert angles.max() > rest + np.radians(3.0)
    assert angles.min() > rest - np.radians(8.0)


def test_explicit_trunk_posture_overrides_the_standing_one(sad):
    made = plan_quickly(
        parse(
            BML_TEMPLATE.format(
                '<postureShift id="p" start="0" end="2"><stance type="STANDING"/>'
                '<pose part="TRUNK" lexeme="upright"/></postureShift>'
            )
        ),
        sad,
    )
    assert made.keyframes.outcomes["p"].kind == "realised"
    tilt = sad.robot.skeleton.joint("vl5_tilt")
    assert made.trajectory.controls[-1, tilt] == pytest.approx(0.0, abs=np.radians(0.5))


def test_face_shows_the_affect_of_the_style_until_the_document_shows_another(sad):
    face = '<faceLexeme id="f" lexeme="joy" amount="1" start="1" attackPeak="1.3" relax="3" end="3.3"/>'
    made = plan_quickly(parse(BML_TEMPLATE.format(face)), sad)
    units = compute_action_units(made, np.array([0.2, 2.0]) + made.trajectory.zero)
    assert units["L15"][0] > 0.2
    assert units["L15"][1] < 0.02 < units["L12"][1]


def test_style_of_a_block_sets_its_facial_affect():
    text = BML_TEMPLATE.replace(' id="b"', ' xmlns:k="urn:kinesic" id="b" k:style="sad"')
    made = plan_quickly(parse(text.format('<wait id="w" duration="2"/>')), set_up())
    assert "L15" in compute_action_units(made, np.linspace(0.0, 1.5, 4))


@pytest.mark.parametrize("style", ["sad", "proud"])
def test_standing_posture_with_negligible_variation_equals_that_of_the_style(style):
    own, varied = (set_up(style=style, variation=amount).robot.skeleton.rest for amount in (0.0, 1e-6))
    np.testing.assert_allclose(varied, own, atol=np.radians(0.01))


def test_standing_posture_varies_with_the_seed_and_is_asymmetric():
    bodies = [set_up(variation=1.0, seed=seed).robot.skeleton.rest for seed in (0, 0, 1)]
    mirrored = [TESTED_ROBOTS["upper22"].skeleton.joint(f"{side}_elbow_flexion") for side in "lr"]
    assert np.array_equal(bodies[0], bodies[1])
    assert np.degrees(np.abs(bodies[0] - bodies[2]).max()) > 3.0
    assert abs(np.degrees(bodies[0][mirrored[0]] - bodies[0][mirrored[1]])) > 0.5
    assert np.array_equal(set_up(seed=1).robot.skeleton.rest, TESTED_ROBOTS["upper22"].skeleton.rest)


def find_seeds(*, hanging, count):
    """Return seeds of neutral standing postures with hanging or other arms."""
    drawn = {}
    for seed in range(60):
        chance = np.random.default_rng((seed, STANDING_STREAM))
        draw_deviation(read_stances().hanging, chance)
        drawn[seed] = draw_arm_pose(read_stances(), chance)
    return [seed for seed, pose in drawn.items() if (pose is None) == hanging][:count]


@pytest.mark.parametrize("name", TESTED_ROBOTS)
def test_varied_standing_arm_postures_keep_limits_and_clearance(name):
    robot = TESTED_ROBOTS[name]
    for seed in find_seeds(hanging=False, count=4):
        setup = set_up(name, variation=1.0, seed=seed)
        rest, skeleton = setup.robot.skeleton.rest, robot.skeleton
        gaps, own_gaps = setup.distances.gaps(np.stack([rest, robot.skeleton.rest]))
        assert np.all(gaps >= np.minimum(robot.min_clearance + LAG_RESERVE, own_gaps) - 1e-9)
        assert np.all((rest >= skeleton.lower) & (rest <= skeleton.upper))
        arms = np.array([measure_arm(setup.robot, side, rest) for side in "lr"])
        assert arms[:, ARM_FEATURES.index("forearm_forward")].max() > 40.0


def test_forearms_of_a_varied_standing_posture_rise_with_the_variation():
    seed = find_seeds(hanging=False, count=1)[0]
    bends = []
    for amount in (0.0, 0.5, 1.0):
        body = set_up("human", variation=amount, seed=seed).robot
        bends.append(max(measure_arm(body, side, body.skeleton.rest)[2] for side in "lr"))
    assert bends[0] < bends[1] - 10.0 < bends[2] - 20.0


def test_variation_turns_the_forearms_of_a_sad_standing_posture_by_less_than_30_degrees():
    own = set_up("human", style="sad").robot
    for seed in find_seeds(hanging=False, count=2):
        body = set_up("human", style="sad", variation=1.0, seed=seed).robot
        offsets = [
            measure_arm(body, side, body.skeleton.rest) - measure_arm(own, side, own.skeleton.rest) for side in "lr"
        ]
        assert np.abs(np.array(offsets)[:, ARM_FEATURES.index("forearm_forward")]).max() < 30.0


@pytest.mark.parametrize("seed", range(4))
def test_standing_trunk_and_head_of_a_seed_are_equal_on_two_robots(seed):
    bodies = [set_up(name, variation=1.0, seed=seed).robot for name in ("human", "upper36")]
    turns = [[*turn_angles(rest_turn(body, "torso")), *turn_angles(rest_head_turn(body))] for body in bodies]
    assert np.degrees(turns[0]) == pytest.approx(np.degrees(turns[1]), abs=0.5)


@pytest.mark.parametrize("name", ["human", "upper36"])
def test_shoulder_height_difference_of_a_varied_standing_posture_equals_the_random_draw(name):
    elevations, expected = [], []
    for seed in find_seeds(hanging=True, count=4):
        robot = set_up(name, variation=1.0, seed=seed).robot
        left, right = (robot.skeleton.rest_frames.origins[robot.arm(side).shoulder] for side in "lr")
        line = left - right
        elevations.append(np.degrees(np.arcsin(line[2] / np.linalg.norm(line))))
        features = draw_deviation(read_stances().hanging, np.random.default_rng((seed, STANDING_STREAM)))
        expected.append(sum(features[STANCE_FEATURES.index(part)] for part in ("trunk_roll", "shoulder_rise")))
    assert elevations == pytest.approx(expected, abs=0.4)
    assert max(elevations) - min(elevations) > 1.5


@pytest.mark.parametrize("name", ["human", "upper36"])
def test_changed_rest_posture_moves_arms_and_trunk_but_keeps_the_head_level(name):
    setup = set_up(name, variation=1.0)
    body, standing, roll = setup.robot, setup.style.standing, np.radians(2.0)
    for seed in range(4):
        angles = draw_rest(body, standing, setup.distances, np.random.default_rng(seed), roll=roll)
        gaps, own_gaps = setup.distances.gaps(np.stack([angles, body.skeleton.rest]))
        assert np.all(gaps >= np.minimum(body.min_clearance + LAG_RESERVE, own_gaps) - 1e-9)
        offsets = np.degrees(angles - body.skeleton.rest)
        assert max(abs(offsets[list(body.arm(side).joints)]).max() for side in "lr") > 2.0
        trunk, neck = (offsets[body.skeleton.joint(joint)] for joint in ("vl5_roll", "skullbase_roll"))
        assert trunk == pytest.approx(2.0, abs=0.01) == -neck


def test_eyes_of_a_sad_robot_look_down_for_40_to_95_percent_of_the_time(sad):
    setup = replace(sad, idling=replace(sad.idling, amount=1.0))
    made = plan_quickly(parse(BML_TEMPLATE.format('<wait id="w" duration="12"/>')), setup)
    units = compute_action_units(made, np.arange(0.0, 11.0, 0.1))
    down = units["64"] > 0.3
    assert 0.4 < down.mean() < 0.95


def test_robot_stands_in_the_style_of_the_block_unless_the_posture_weight_is_set(sad):
    text = BML_TEMPLATE.replace(' id="b"', ' xmlns:k="urn:kinesic" id="b" k:style="sad"').format(
        '<wait id="w" duration="1"/>'
    )
    setup = set_up()
    made = plan(text, setup)
    assert made.trajectory.controls[0] == pytest.approx(sad.robot.skeleton.rest, abs=1e-9)
    assert made.trajectory.controls[-1] == pytest.approx(sad.robot.skeleton.rest, abs=1e-9)
    assert made.setup.limits is setup.limits
    kept = plan(text, set_up(settings=["posture=0"]))
    assert kept.trajectory.controls[0] == pytest.approx(setup.robot.skeleton.rest, abs=1e-9)


def test_document_without_a_style_keeps_the_posture_of_the_performance(sad):
    made = plan(BML_TEMPLATE.format('<wait id="w" duration="1"/>'), sad)
    assert made.setup is sad


@pytest.mark.parametrize("mirrored", [False, True])
def test_ik_of_a_rest_gesture_starts_from_the_rest_posture_with_raised_shoulders(mirrored, lexicon, monkeypatch):
    starts: list[np.ndarray] = []

    def reach(start, *_: object) -> np.ndarray:
        starts.append(start)
        return start

    monkeypatch.setattr(standing_module, "with_arms", reach)
    robot = TESTED_ROBOTS["upper22"]
    rest = robot.skeleton.rest
    arms = (("sternoclavicular_abduct", 0.05), ("shoulder_flexion", 0.1))
    standing = Standing(rest="hand_on_hip", arms=arms, mirrored=mirrored)
    _take_rest_gesture(np.array(rest), robot, standing, lexicon, CapsuleDistances(robot))
    raised = {robot.skeleton.names[joint]: starts[0][joint] - rest[joint] for joint in np.flatnonzero(starts[0] - rest)}
    assert raised == {f"{side}_sternoclavicular_abduct": pytest.approx(0.05) for side in "lr"}


@pytest.mark.parametrize("lexeme", ["hush", pytest.param("heart", marks=pytest.mark.soak), "offer"])
def test_hand_position_of_a_gesture_relative_to_the_trunk_does_not_depend_on_the_standing_lean(lexeme):
    wrists = {}
    for tilt in (0.0, 8.0):
        style = Style.load("neutral")
        lean = replace(style, standing=Standing(trunk=Turn(tilt=np.radians(tilt))))
        setup = set_up("human", style=lean)
        body = setup.robot
        text = f'<gesture id="g" lexeme="{lexeme}" mode="RIGHT_HAND" stroke="2"/>'
        made = plan_quickly(parse(BML_TEMPLATE.format(text)), setup)
        stroke = next(key for key in made.postures.postures if any(sync == "stroke" for _, sync in key.syncs))
        frames, arm = body.skeleton.frames(stroke.angles), body.arm("r")
        trunk = body.skeleton.segment("vt1")
        offset = frames.origins[arm.wrist] - frames.origins[trunk]
        wrists[tilt] = frames.rotations[trunk].T @ offset
    assert np.linalg.norm(wrists[8.0] - wrists[0.0]) < 0.025
