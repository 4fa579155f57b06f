"""Review notes, servos and tables of a robot converted from synthetic parts."""

from math import exp, radians
from pathlib import Path
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from kinesic.sim.importer import convert
from kinesic.sim.importer.convert import (
    UNIT_SERVO,
    Mapped,
    _choose_servos,
    _describe_fingers,
    _describe_fixed_joints,
    _list_uncoupled_hinges,
    _rate_confidence,
    _review,
    _review_servos,
    import_humanoid,
)

LEGS_NOTE = "legs are left out, the trunk stands on a fixed base"
FINGERS_NOTE = "fingers, and where palms look, were found by geometry, straight at zero"


def finger(name="thumb", turns=(), follows=()):
    hinges = tuple(turn for turn in turns if turn.name not in follows)
    return SimpleNamespace(name=name, turns=turns, hinges=hinges, follows=dict.fromkeys(follows))


def hand(*fingers):
    return SimpleNamespace(fingers=fingers)


def figure(
    *,
    off=(0.0, 0.0),
    asymmetry=0.0,
    certain=True,
    by_names=False,
    likeness=3.0,
    follows=(),
    left_out=(),
    doubtful=False,
):
    joints = [SimpleNamespace(name=f"j{k}", follows="driver" if k in follows else None) for k in range(8)]
    tree = SimpleNamespace(joints=joints, below=lambda k: tuple(range(k, 3 if k < 3 else 8)), left_out=left_out)
    arms = {"l": SimpleNamespace(joints=(0, 1), off=off[0]), "r": SimpleNamespace(joints=(3, 4), off=off[1])}
    sides = SimpleNamespace(certain=certain, by_names=by_names)
    return SimpleNamespace(
        tree=tree,
        arms=arms,
        sides=sides,
        asymmetry=asymmetry,
        likeness=likeness,
        legs=(2, 5, 6, 7),
        is_doubtful=doubtful,
        wishes=SimpleNamespace(hinges={}),
    )


def hinge(name, joint=0, *, assumed=False):
    return SimpleNamespace(name=name, joint=joint, assumed=assumed)


BOTH_HANDS = {"l": hand(finger("thumb"), finger("index")), "r": hand(finger("thumb"))}


def test_servos_with_assumed_values_are_counted_in_the_review():
    sources = {"a": "stall: the file's effort; speed assumed", "b": "stall: the file's effort"}
    assert _review_servos(sources) == ["1 of 2 servos have assumed values, named beside them"]
    assert _review_servos({"b": sources["b"]}) == []


@pytest.mark.parametrize(
    ("figure", "hinges", "hands", "notes"),
    [
        (figure(), (), BOTH_HANDS, [f"{FINGERS_NOTE} (left: thumb, index; right: thumb)", LEGS_NOTE]),
        (
            figure(),
            (hinge("a", assumed=True), hinge("b"), hinge("c", assumed=True)),
            {},
            [
                "ranges of a, c are assumed, as the file gives none",
                "palms are assumed to face the thighs",
                "j2, j5, j6, j7 are held: a hand needs a thumb and two fingers",
                LEGS_NOTE,
            ],
        ),
        (
            figure(certain=False, by_names=True, left_out=("a mesh", "a tendon")),
            (),
            BOTH_HANDS,
            [
                "which side is left is a guess",
                "pairs of hinges were found by name, as the file's pose is not symmetric",
                f"{FINGERS_NOTE} (left: thumb, index; right: thumb)",
                LEGS_NOTE,
                "a mesh",
                "a tendon",
            ],
        ),
        (
            figure(off=(0.0, radians(10.6)), asymmetry=0.021, follows=(4,)),
            (hinge("a", 4),),
            {"l": BOTH_HANDS["l"]},
            [
                "arms hang 11 deg off the vertical at best",
                "the arms differ by 2 % of their length",
                f"{FINGERS_NOTE} (left: thumb, index)",
                "j5, j6, j7 are held: a hand needs a thumb and two fingers",
                LEGS_NOTE,
                "j4 follows another hinge in its file, and has a motor here",
            ],
        ),
    ],
)
def test_import_review_notes_name_each_doubt(figure, hinges, hands, notes):
    assert _review(figure, hinges, hands) == notes


def test_import_review_names_joints_without_a_hinge_and_a_missing_arm():
    one_arm = figure()
    one_arm.arms, one_arm.legs, one_arm.is_doubtful = {"l": one_arm.arms["l"]}, (5, 6), True
    notes = _review(one_arm, (hinge("a", 3),), {})
    assert "held, because no hinge of kinesic fits: j4, j7" in notes
    assert any(note.startswith("the robot has no right arm") for note in notes)
    assert "the arms may be legs: neither names nor geometry decide" in notes
    one_arm.legs = ()
    assert "the base is fixed" in _review(one_arm, (), {})


@pytest.mark.parametrize("doubt", [{"off": (radians(9.9), 0.0)}, {"asymmetry": 0.02}])
def test_small_geometric_errors_of_imported_arms_are_not_listed_for_review(doubt):
    assert _review(figure(**doubt), (), BOTH_HANDS)[1:] == [LEGS_NOTE]


def test_import_notes_say_that_hands_without_joints_have_no_fingers():
    bare = figure()
    bare.arms["l"].joints, bare.arms["r"].joints = (1, 2), (6, 7)
    assert _describe_fixed_joints(bare, {}) == "hands have no fingers"
    assert _describe_fingers({}) == f"{FINGERS_NOTE} ()"


def test_coupled_hinges_that_get_their_own_motor_are_listed():
    turns = (hinge("thumb1", 2), hinge("thumb2", 3), hinge("thumb3", 4))
    hands = {"r": hand(finger("thumb", turns, ("thumb2",)))}
    body = (hinge("a", 0), hinge("b", 1))
    assert _list_uncoupled_hinges(figure(follows=(1, 3, 4, 5)), body, hands) == ["j1", "j4"]


@pytest.mark.parametrize(
    ("values", "confidence"),
    [
        ({}, 1.0),
        ({"likeness": 2.5}, 0.75),
        ({"likeness": 3.5}, 1.0),
        ({"likeness": 0.9}, 0.0),
        ({"off": (0.25, 0.1)}, exp(-0.5)),
        ({"off": (0.1, 0.25), "asymmetry": 0.25, "certain": False, "likeness": 2.0}, 0.35 * exp(-1.0)),
    ],
)
def test_import_confidence_is_the_product_of_its_factors(values, confidence):
    assert _rate_confidence(figure(**values), ()) == pytest.approx(confidence)


def test_doubtful_limbs_and_contradicting_names_reduce_the_import_confidence():
    shape = figure()
    shape.is_doubtful = True
    assert _rate_confidence(shape, ()) == pytest.approx(0.5)
    named = figure()
    named.tree.joints[0].name = "left_wrist"
    hinges = (hinge("l_shoulder_flexion", 0), hinge("l_elbow_flexion", 1), hinge("skullbase_tilt", 3))
    assert _rate_confidence(named, hinges) == pytest.approx(np.exp(-1.0))
    assert "names contradict the hinges of left_wrist (l_shoulder_flexion)" in _review(named, hinges, BOTH_HANDS)


@pytest.mark.parametrize(("confidence", "doubtful"), [(0.59, True), (0.6, False), (0.61, False)])
def test_mapping_below_a_confidence_of_0_6_needs_a_review(confidence, doubtful):
    assert Mapped(None, None, (), {}, {}, confidence).doubtful is doubtful


def test_placeholder_servo_has_unit_torque_and_current_without_losses():
    assert (UNIT_SERVO.stall_nm, UNIT_SERVO.stall_a, UNIT_SERVO.no_load_rpm, UNIT_SERVO.gear) == (1.0, 1.0, 60.0, 1.0)
    assert (UNIT_SERVO.model, UNIT_SERVO.volt, UNIT_SERVO.mass, UNIT_SERVO.size) == (0, 48.0, 0.0, (0.01,) * 3)
    assert (UNIT_SERVO.p_gain, UNIT_SERVO.d_gain, UNIT_SERVO.kp_divisor) == (800.0, 0.0, 128.0)
    assert (UNIT_SERVO.armature, UNIT_SERVO.frictionloss, UNIT_SERVO.damping) == (1e-6, 0.0, 0.0)


def test_mirrored_hinges_share_the_servo_chosen_for_the_first_hinge_of_the_pair(monkeypatch):
    load = SimpleNamespace(holding=np.array([1.0, 2.0, 3.0]), inertia=np.array([4.0, 5.0, 6.0]))
    robot = SimpleNamespace(skeleton=SimpleNamespace(joint=["l_a", "b", "r_a"].index))
    monkeypatch.setattr(convert, "robot_from_tables", lambda draft, path: (draft, path))
    monkeypatch.setattr(convert, "Robot", SimpleNamespace(of=lambda tables: robot if tables == ("d", "p") else None))
    monkeypatch.setattr(convert, "MujocoDynamics", lambda found: SimpleNamespace(load=load) if found else None)
    monkeypatch.setattr(
        convert, "servo", lambda joint, *, gravity, inertia: ((joint.name, gravity, inertia), f"of {joint.name}")
    )
    tables, sources = _choose_servos(figure(), (hinge("b", 5), hinge("r_a", 2), hinge("l_a", 1)), "d", "p")
    assert tables == {"b": ("j5", 2.0, 5.0), "a": ("j2", 3.0, 6.0)}
    assert sources == {"b": "of j5", "a": "of j2"}


class Imported(msgspec.Struct):
    """Part of the tables of a robot."""

    servos: dict
    rest: dict
    robot: object


def test_converted_robot_has_servos_rest_pose_and_notes(monkeypatch):
    shape = figure(likeness=2.333)
    turns = (hinge("l_thumb1", 2), hinge("l_thumb2", 6))
    hands = {"l": hand(finger("thumb", turns, ("l_thumb2",)))}
    hinges = (hinge("l_a", 0), hinge("r_a", 3))
    made = {}

    def tables(*arguments):
        made["tables"] = arguments
        return "bare"

    def add_hands(*arguments):
        made["hands"] = arguments
        return Imported({}, {"l_thumb1": 7.0, "l_a": 8.0}, SimpleNamespace(imported=None))

    def choose(*arguments):
        made["servos"] = arguments
        return {"a": "servo"}, {"a": "source"}

    def rest(*arguments):
        made["rest"] = arguments
        return {"l_a": 3.0, "r_a": 0.0}

    stubs = {
        "load_robot_tree": lambda path: ("tree", path),
        "read_wishes": lambda tree, wished: (tree, ("wishes", *wished)),
        "analyse_geometry": lambda *found: shape if found == (("tree", Path("dir/r.xml")), ("wishes", "a=b")) else None,
        "name_hinges": lambda geometry: hinges,
        "lay_out_segments": lambda geometry, named: ("layout", named),
        "find_hand": lambda geometry, side: hands.get(side),
        "find_limits_nearest_to_zero": lambda named: ("limits", named),
        "robot_tables": tables,
        "with_hands": add_hands,
        "_choose_servos": choose,
        "rest_pose": rest,
        "with_exclusions": lambda file, path: made.update(excluded=path) or file,
        "describe_source": lambda turn, name: name,
        "_add_sources": lambda file, sources: made.update(sources=sources) or file,
        "spell_angle": lambda turn, name: f"{turn.name} is {name}",
    }
    for name, stub in stubs.items():
        monkeypatch.setattr(convert, name, stub)
    path = Path("dir/r.xml")
    imported = import_humanoid(path, ["a=b"])
    layout, thumb = ("layout", hinges), turns[0]
    placeholders = dict.fromkeys(("a", "thumb1"), UNIT_SERVO)
    assert made["tables"] == (shape, layout, hinges, placeholders, ("limits", hinges))
    assert made["hands"] == ("bare", hands, shape.tree, layout)
    assert made["servos"][:2] == (shape, (*hinges, thumb))
    assert made["servos"][3] == path
    assert made["rest"][:2] == (shape, hinges)
    assert made["rest"][4] == {"l_thumb1": 7.0}
    assert made["rest"][2].servos == {"a": "servo"}
    assert (made["rest"][3], made["excluded"]) == (path, path)
    assert made["sources"] == {"l_a": "j0", "r_a": "j3", "l_thumb1": "j2", "l_thumb2": "j6"}
    assert imported.file.servos == {"a": "servo"}
    assert imported.file.rest == {"l_a": 3.0, "l_thumb1": 7.0}
    table = imported.file.robot.imported
    assert (table.source, table.confidence) == ("r.xml", 0.67)
    assert table.review == _review(shape, hinges, hands)
    assert imported.remarks == {"l_a": "l_a is j0", "r_a": "r_a is j3", "l_thumb1": "l_thumb1 is j2", "a": "source"}
    assert (imported.figure, imported.hinges, imported.hands) == (shape, hinges, hands)
    assert imported.confidence == pytest.approx(1.333 / 2)
