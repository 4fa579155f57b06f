"""Verb `kinesic servos accept` on virtual servos."""

import json
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.metrics.acceptance import compare_peak_velocities, find_fast_postures, pushing_force
from kinesic.sim.kinematics import body_frames
from kinesic.sim.log import Log, write_log
from kinesic.sim.model import build_model

pytestmark = pytest.mark.realtime

ENERGY = 0.2  # [J] largest planned energy of a contact
ANSWERS = ("0.7", "10", "10", "10", "150", "6", "9", "0", "0", "0")  # mass, pushes, strike, stop, unplug, rods


def swing(scale: float = 1.0) -> Log:
    """Return a motion of the right arm whose peak velocity depends on `scale`.

    The peak is scale * 2 rad/s.
    """
    robot, times = Robot.load(), np.arange(0.0, 4.0, 0.01)
    angles = np.tile(robot.skeleton.rest, (len(times), 1))
    angles[:, robot.skeleton.joint("r_shoulder_flexion")] += scale * (1.0 - np.cos(2.0 * times))
    return Log(times, angles, angles)


@pytest.fixture
def performed(tmp_path: Path) -> Path:
    """Write the report of a performance on servos near adults."""
    folder = tmp_path / "performed"
    folder.mkdir()
    for name, scale in (("measured", 1.0), ("servos", 1.02)):
        write_log(swing(scale), Robot.load(), folder / f"{name}.npz")
    contact = {
        "near": "adult",
        "source": "limits of a test",
        "forces": {"hand": {"force_n": 131.2, "limit_n": 140.0}, "face": {"force_n": 160.0, "limit_n": None}},
        "energy": {"energy_j": ENERGY, "segment": "r_wrist", "at_s": 0.8},
    }
    change(
        folder,
        robot="upper22",
        input="swing.bml",
        checks=[{"name": "safety.force", "value": 0.94}],
        contact=contact,
        servos={"ending": "performed"},
    )
    return folder


def change(folder: Path, **values: object) -> None:
    path = folder / "report.json"
    earlier = json.loads(path.read_text()) if path.exists() else {}
    path.write_text(json.dumps(earlier | values))


@pytest.fixture
def accept(kinesic, table, performed: Path):
    """Return a function that runs the test with given answers."""

    def run(*answers: str, source: Path = performed, options: tuple[str, ...] = ()):
        lines = "".join(f"{answer}\n" for answer in answers).encode()
        return kinesic("servos", "accept", source, "--port", table.port, "--person", "Ada", *options, stdin=lines)

    return run


def test_passed_acceptance_test_writes_a_report_with_values_and_bounds(accept, tmp_path: Path):
    ended = accept(*ANSWERS)
    report = json.loads((tmp_path / "acceptance.json").read_text())
    steps = {step["name"]: step for step in report["steps"]}
    assert (ended.code, report["passed"], len(steps)) == (0, True, 13)
    assert (report["person"], report["near"], report["limits"]) == ("Ada", "adult", "limits of a test")
    assert steps["velocity"]["value"] == pytest.approx(1.02, abs=0.001)
    assert steps["policy"]["value"] == 0.94
    assert steps["strike"]["bound"] == pytest.approx(sqrt(2 * 75e3 * ENERGY))
    assert steps["push 1"]["ratio"] == pytest.approx(10.0 / steps["push 1"]["bound"])
    assert [servo["firmware"] for servo in report["robot"]["servos"]] == [52] * 23
    assert "at most 131 N on a free hand" in ended.out
    assert "Not safety-rated, no risk assessment." in ended.out
    assert not {"safe", "compliant"} & set(ended.out.replace(".", " ").split())


def test_acceptance_bounds_of_mass_push_and_overrun_are_computed_from_the_robot_model(accept, tmp_path: Path):
    accept(*ANSWERS)
    bounds = {step["name"]: step["bound"] for step in json.loads((tmp_path / "acceptance.json").read_text())["steps"]}
    robot = Robot.load()
    model, arm = build_model(robot), robot.arm("r")
    mass = sum(model.body(name).mass[0] for name in arm.segments[-3:])
    postures = find_fast_postures(robot, swing())
    path = body_frames(robot, swing().angles).origins[arm.wrist].T
    speed = np.linalg.norm(np.diff(path, axis=0), axis=1).max() / 0.01
    assert bounds["velocity"] == 1.05
    assert bounds["mass"] == pytest.approx(1.1 * mass)
    assert [bounds[f"push {k + 1}"] for k in range(3)] == pytest.approx([1.2 * posture.force for posture in postures])
    assert bounds["stop"] == pytest.approx(12.0 * speed, rel=0.01)
    assert bounds["unplug"] == pytest.approx(32.0 * speed, rel=0.01)


def test_acceptance_test_fails_if_a_step_exceeds_its_bound_or_is_skipped(accept, tmp_path: Path):
    for index, answer in ((4, "174"), (4, ""), (9, "1")):
        answers = [*ANSWERS]
        answers[index] = answer
        ended = accept(*answers, options=("--force",))
        report = json.loads((tmp_path / "acceptance.json").read_text())
        failed = [step["name"] for step in report["steps"] if not step["passed"]]
        assert (ended.code, report["passed"]) == (1, False)
        assert failed == ["strike" if index == 4 else "rod 25 mm"]
        assert f"not passed: {failed[0]}\n" in ended.out


def test_acceptance_test_asks_again_after_an_invalid_value(accept):
    assert accept("-1", "nan", "inf", "a kilo", *ANSWERS).code == 0


def test_acceptance_test_fails_after_a_servo_fault(accept, table, tmp_path: Path):
    table.plant.servos[4].mute = True
    assert accept(*ANSWERS).code == 1
    first = json.loads((tmp_path / "acceptance.json").read_text())["steps"][0]
    assert (first["name"], first["value"] > 0, first["passed"]) == ("servos", True, False)


def test_acceptance_test_refuses_unsuitable_performances_before_any_question(accept, performed: Path, tmp_path: Path):
    contact = json.loads((performed / "report.json").read_text())["contact"]
    for values, message in (
        ({"contact": contact | {"near": "nobody"}}, "performed without a policy; repeat it with --near adult"),
        ({"servos": {"ending": "stopped"}, "contact": contact}, "servos did not perform to the end"),
        ({"servos": None}, "servos did not perform to the end"),
        ({"robot": "upper36"}, "upper36 performed, not upper22; give --robot upper36"),
        ({"checks": 3}, "report.json"),
    ):
        change(performed, **values)
        ended = accept()
        assert ended.code == 2
        assert message in ended.err
    assert not (tmp_path / "acceptance.json").exists()


def test_acceptance_report_becomes_invalid_if_firmware_or_gains_change(accept, table, tmp_path: Path):
    report = tmp_path / "acceptance.json"
    accept(*ANSWERS)
    ended = accept(source=report)
    assert ended.code == 0
    assert "robot as tested on " in ended.out
    table.set(15, Register.FIRMWARE_VERSION, 53)
    ended = accept(source=report)
    assert ended.code == 1
    old, new = "xm430_w210 with firmware 52", "xm430_w210 with firmware 53"
    assert f"expired: servo 15 (l_elbow_flexion): {old} -> {new}\n" in ended.out
    table.set(15, Register.FIRMWARE_VERSION, 52)
    for key, message in (("gains", "other gains"), ("limbs", "other masses or lengths")):
        content = json.loads(report.read_text())
        content["robot"][key] = "0"
        other = tmp_path / f"{key}.json"
        other.write_text(json.dumps(content))
        ended = accept(source=other)
        assert (ended.code, message in ended.out) == (1, True)


def test_failed_acceptance_report_stays_failed_on_the_unchanged_robot(accept, tmp_path: Path):
    accept(*ANSWERS[:-1], "2")
    ended = accept(source=tmp_path / "acceptance.json")
    assert (ended.code, "the test was not passed\n" in ended.out) == (1, True)


def test_comparison_of_peak_velocities_ignores_tick_rounding_and_names_the_fastest_joint():
    robot = Robot.load()
    planned, measured = swing(), swing(1.1)
    tick = 2.0 * np.pi / 4096
    rounded = Log(measured.times, measured.setpoints, np.round(measured.angles / tick) * tick)
    ratio, hinge = compare_peak_velocities(robot, planned, rounded)
    assert hinge == "r_shoulder_flexion"
    assert ratio == pytest.approx(1.1, abs=0.01)


def test_expected_pushing_force_is_stall_torque_divided_by_lever_arm():
    robot = Robot.load()
    postures = find_fast_postures(robot, swing())
    assert [posture.side for posture in postures] == ["r"] * len(postures)
    assert 2 <= len(postures) <= 3
    joint = robot.skeleton.joint("r_shoulder_flexion")
    frames = body_frames(robot, robot.skeleton.rest[None])
    hand, shoulder = (frames.origins[k][:, 0] for k in (robot.arm("r").wrist, robot.arm("r").shoulder))
    sideways = np.cross([0.0, 1.0, 0.0], hand - shoulder)
    lever = np.linalg.norm(sideways)
    force = pushing_force(robot, "r", robot.skeleton.rest, sideways / lever)
    assert force <= 1.001 * robot.drives.stall[joint] / lever
