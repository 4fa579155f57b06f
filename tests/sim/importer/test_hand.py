"""Import of hands with four or five fingers, couplings and mimic joints."""

import re
from dataclasses import replace

import numpy as np
import pytest

from kinesic.body.robot import SIDES, Robot
from kinesic.body.robot_schema import robot_text
from kinesic.expressivity.hands.fingers import finger_joints, lacking_shapes, shape_angles
from kinesic.expressivity.lexicon.hand_shapes import FINGER_NAMES, hand_shapes
from kinesic.session.plan import plan
from kinesic.session.setup import set_up
from kinesic.sim.importer.convert import import_humanoid

PHALANX_LENGTH = 0.03


def finger(name: str, place: str, along: str, turns: list[str], *, last: str = "") -> str:
    """Return MJCF of a finger: hinges, each flexion with its phalanx."""
    text = ""
    for k, turn in enumerate(turns):
        at = place if k == 0 else along if "spread" not in turns[k - 1] and "oppose" not in turns[k - 1] else "0 0 0"
        thick = (
            ""
            if "spread" in turn or "oppose" in turn
            else f'<geom type="capsule" fromto="0 0 0 {along}" size="0.006"/>'
        )
        text += f'<body pos="{at}"><inertial pos="0 0 0" mass="0.003" diaginertia="1e-6 1e-6 1e-6"/>{turn}{thick}'
    return text + "</body>" * len(turns)


def hinge(name: str, axis: str, low: float, high: float) -> str:
    return f'<joint name="{name}" axis="{axis}" range="{low} {high}"/>'


def hand(side: str, count: int, *, flexions: int, spread: bool) -> str:
    """Return a hand stretched to the side, palm down and thumb forward."""
    s = 1 if side == "l_" else -1
    text = ""
    for k, name in enumerate(FINGER_NAMES[1:count]):
        turns = [hinge(f"{side}{name}_spread", "0 0 1", -0.3, 0.3)] if spread else []
        turns += [hinge(f"{side}{name}{n}", f"{-s} 0 0", 0, 1.4) for n in range(1, flexions + 1)]
        text += finger(name, f"{0.03 - 0.02 * k} {0.1 * s} 0", f"0 {PHALANX_LENGTH * s} 0", turns)
    turns = [hinge(f"{side}t_oppose", "0 1 0", 0, 1.2)]
    turns += [hinge(f"{side}t{n}", f"0 0 {s}", 0, 1) for n in range(1, flexions + 1)]
    return text + finger("t", f"0.035 {0.03 * s} 0", f"{PHALANX_LENGTH} {0.4 * PHALANX_LENGTH * s} 0", turns)


def with_hands(puppet: str, count: int, *, flexions: int, spread: bool = False, ties: str = "") -> str:
    for side in ("l_", "r_"):
        own = hand(side, count, flexions=flexions, spread=spread)
        puppet = re.sub(rf'<body pos="0.02 \S+ 0"><joint name="{side}thumb".*?</body>', own, puppet)
        puppet = re.sub(rf'<body pos="-0.02 \S+ 0"><joint name="{side}finger".*?</body>', "", puppet)
    return puppet.replace("</mujoco>", f"{ties}</mujoco>")


def ties() -> str:
    rows = [
        f'<joint joint1="{side}{finger}{k + 1}" joint2="{side}{finger}1" polycoef="0.02 {0.4 + 0.3 * k} 0 0 0"/>'
        for side in ("l_", "r_")
        for finger in ("t", *FINGER_NAMES[1:])
        for k in (1, 2)
    ]
    return f"<equality>{''.join(rows)}</equality>"


@pytest.fixture(scope="module")
def robots(written, puppets, tmp_path_factory):
    """Import each test robot: name -> conversion result and loaded robot."""
    plain = puppets.puppet()
    texts = {
        "coupled": with_hands(plain, 5, flexions=3, ties=ties()),
        "four": with_hands(plain, 4, flexions=2, spread=True),
    }
    results = {}
    for name, text in texts.items():
        mapped = import_humanoid(written(f"{name}.xml", text))
        path = tmp_path_factory.mktemp("hands") / f"{name}.toml"
        path.write_text(robot_text(mapped.file, heading=[], remarks=mapped.remarks), encoding="utf-8")
        results[name] = mapped, Robot.load(path)
    return results


def drives(robot, side):
    return {robot.skeleton.names[joint][2:] for joint in finger_joints(robot, side)}


@pytest.mark.parametrize("side", SIDES)
def test_five_fingers_are_named_and_mimic_hinges_become_couplings(robots, side):
    _, robot = robots["coupled"]
    assert drives(robot, side) == {"thumb_abduct", *(f"{finger}_flexion1" for finger in FINGER_NAMES)}
    led = {c.name: (robot.skeleton.names[c.driver], c.ratio) for c in robot.skeleton.couplings if c.name[0] == side}
    assert led == {
        f"{side}_{finger}_flexion{k}": (f"{side}_{finger}_flexion1", pytest.approx(0.4 + 0.3 * (k - 1)))
        for finger in FINGER_NAMES
        for k in (2, 3)
    }
    assert all(c.offset == pytest.approx(0.02, abs=1e-5) for c in robot.skeleton.couplings)
    assert lacking_shapes(hand_shapes(), robot) == ()


@pytest.mark.parametrize("name", ["coupled", "four"])
@pytest.mark.parametrize("side", SIDES)
def test_fist_closes_towards_the_palm_and_pinched_tips_meet(robots, name, side):
    _, robot = robots[name]

    def tips(shape):
        posture = robot.skeleton.rest.copy()
        posture[list(finger_joints(robot, side))] = shape_angles(hand_shapes()[shape], robot, side)
        frames = robot.skeleton.frames(posture)
        k, palm = robot.arm(side).wrist, robot.arm(side).palm
        ends = {
            n: frames.origins[t.segment] + frames.rotations[t.segment] @ t.place
            for n, t in robot.finger_tips(side).items()
        }
        return {n: frames.rotations[k].T @ (end - frames.origins[k]) - palm.position for n, end in ends.items()}, palm

    (flat, palm), (fist, _), (ring, _) = tips("flat"), tips("fist"), tips("ring")
    along = palm.position / np.linalg.norm(palm.position)
    for finger in set(flat) - {"thumb"}:
        assert (fist[finger] - flat[finger]) @ palm.facing > 0.01, finger
        assert (fist[finger] - flat[finger]) @ along < -0.02, finger
    apart = np.linalg.norm(flat["index"] - flat["thumb"])
    assert np.linalg.norm(ring["index"] - ring["thumb"]) < 0.35 * apart


def test_hand_with_four_fingers_lacks_the_little_finger_and_hand_shapes_that_need_it(robots):
    mapped, robot = robots["four"]
    assert {finger.name for finger in mapped.hands["l"].fingers} == {"thumb", "index", "middle", "ring"}
    assert "index_abduct" in drives(robot, "l")
    assert not robot.skeleton.couplings
    lacking = lacking_shapes(hand_shapes(), robot)
    assert {"little", "horns", "phone"} <= set(lacking)
    assert not {"fist", "index", "two", "thumb", "ring", "spread"} & set(lacking)


def test_spread_hand_shape_moves_fingertips_apart(robots):
    _, robot = robots["four"]
    roots = {}
    for shape in ("flat", "spread"):
        posture = robot.skeleton.rest.copy()
        posture[list(finger_joints(robot, "l"))] = shape_angles(hand_shapes()[shape], robot, "l")
        frames = robot.skeleton.frames(posture)
        tips = robot.finger_tips("l")
        ends = {n: frames.origins[t.segment] + frames.rotations[t.segment] @ t.place for n, t in tips.items()}
        roots[shape] = np.linalg.norm(ends["index"] - ends["ring"])
    assert roots["spread"] > roots["flat"] + 0.015


def test_import_review_lists_found_fingers_and_omitted_parts(robots, written, puppets, tee_mapped):
    mapped, _ = robots["coupled"]
    review = " | ".join(mapped.file.robot.imported.review)
    assert "left: thumb, index, middle, ring, pinky" in review
    assert "palms are assumed" not in review
    plain = " | ".join(tee_mapped.file.robot.imported.review)
    assert "l_thumb, l_finger, r_thumb, r_finger are held: a hand needs a thumb and two fingers" in plain
    curved = (
        ties().replace("0.7 0 0 0", "0.7 0.3 0 0")
        + '<tendon><fixed name="t"><joint joint="l_t1" coef="1"/></fixed></tendon>'
    )
    odd = import_humanoid(written("odd.xml", with_hands(puppets.puppet(), 5, flexions=3, ties=curved)))
    said = " | ".join(odd.file.robot.imported.review)
    assert "l_t2 follows l_t1 linearly, but non-linearly in the file" in said
    assert "1 tendons are left out" in said


def test_urdf_mimic_joints_become_couplings(written, puppets):
    text = puppets.urdf()
    for side, y in (("left", 1), ("right", -1)):
        text = re.sub(rf'<joint name="{side}_(grip|mimic)_joint".*?</joint>', "", text, flags=re.DOTALL)
        text = re.sub(rf'<link name="{side}_(grip|mimic)">.*?</link>', "", text, flags=re.DOTALL)
        text = text.replace("</robot>", urdf_hand(side, y) + "</robot>")
    mapped = import_humanoid(written("mimic.urdf", text))
    led = {row.name: (row.driver, row.ratio, row.offset_deg) for row in mapped.file.coupling}
    assert set(led) == {f"{side}_{finger}_flexion2" for side in SIDES for finger in ("thumb", "index", "middle")}
    for name, (driver, ratio, offset) in led.items():
        assert driver == name.replace("flexion2", "flexion1")
        assert ratio == pytest.approx(0.8)
        assert offset == pytest.approx(np.degrees(0.05), abs=1e-3)


def urdf_hand(side: str, y: int) -> str:
    """Return a thumb and two fingers below a hanging arm.

    The palm faces the thigh and the thumb points forward.
    """
    text = ""
    places = {
        "thumb": (0.04, -0.05, "0.02 0 -0.02"),
        "index": (0.02, -0.1, "0 0 -0.03"),
        "middle": (-0.02, -0.1, "0 0 -0.03"),
    }
    for name, (x, z, along) in places.items():
        parent = f"{side}_turn"
        axis = "0 1 0" if name == "thumb" else f"{-y} 0 0"
        for k in (1, 2):
            own = f"{side}_{name}{k}"
            at = f"{x} 0 {z - 0.24}" if k == 1 else along
            mimic = f'<mimic joint="{side}_{name}1_joint" multiplier="0.8" offset="0.05"/>' if k == 2 else ""
            text += f'''<link name="{own}"><inertial><origin xyz="{along}"/><mass value="0.01"/>
              <inertia ixx="1e-5" iyy="1e-5" izz="1e-5" ixy="0" ixz="0" iyz="0"/></inertial></link>
              <joint name="{own}_joint" type="revolute"><parent link="{parent}"/><child link="{own}"/>
              <origin xyz="{at}"/><axis xyz="{axis}"/><limit lower="0" upper="1.4" effort="1" velocity="5"/>
              {mimic}</joint>'''
            parent = own
    return text


@pytest.mark.soak
def test_import_of_fingers_is_deterministic(robots, written, puppets):
    mapped, _ = robots["four"]
    again = import_humanoid(written("four.xml", with_hands(puppets.puppet(), 4, flexions=2, spread=True)))
    texts = (robot_text(item.file, heading=[], remarks=item.remarks) for item in (mapped, replace(again)))
    assert len({re.sub(r"folder puppets\d+", "folder", text) for text in texts}) == 1


@pytest.mark.parametrize("name", ["coupled", "four"])
def test_imported_hand_performs_a_hand_shape(robots, name, tmp_path):
    mapped, robot = robots[name]
    path = tmp_path / "hand.toml"
    path.write_text(robot_text(mapped.file, heading=[], remarks=mapped.remarks), encoding="utf-8")
    gesture = '<gesture id="g" lexeme="victory" stroke="2"/>'
    text = f'<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0">{gesture}</bml>'
    planned = plan(text, set_up(path))
    assert planned.keyframes.outcomes["g"].kind == "realised"
    angles = planned.trajectory.sample(np.array([planned.trajectory.zero + 2.0]))[0][0]
    wanted = shape_angles(hand_shapes()["two"], robot, "r")
    np.testing.assert_allclose(angles[list(finger_joints(robot, "r"))], wanted, atol=0.03)
