"""The verbs, as they are typed."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from kinesic.body.robot import Robot
from kinesic.cli.servos import calibrate
from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.supervisor.manifest import Manifest

pytestmark = pytest.mark.realtime

HINGES = {hinge.name: np.degrees([hinge.lower, hinge.upper]) for hinge in Robot.load().skeleton.hinges}


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A robot's file of somebody's own."""
    path = tmp_path / "mine.toml"
    path.write_text(Robot.load().path.read_text(encoding="utf-8"), encoding="utf-8")
    return path


def test_scan_finds_ids_baud_rates_and_hinges(kinesic, table):
    ended = kinesic("servos", "scan", "--port", table.port, "--baud", "1000000", "--baud", "57600")
    assert (ended.code, ended.out.splitlines()[-1]) == (0, "23 servos")
    row = next(line for line in ended.out.splitlines() if "l_elbow_flexion" in line)
    assert row.split() == ["table", "1000000", "15", "xm430_w210", "52", "l_elbow_flexion"]


def test_scan_tells_programs_too(kinesic, table):
    ended = kinesic("servos", "scan", "--port", f"body={table.port}", "--baud", "1000000", "--json")
    found = json.loads(ended.out)
    assert found[0] == {
        "port": str(table.port),
        "baud": 1000000,
        "id": 1,
        "model": "xm540_w150",
        "firmware": 52,
        "shared": False,
    }


def test_show_tells_how_each_servo_is(kinesic, table):
    table.set(15, Register.RETURN_DELAY_TIME, 250)
    ended = kinesic("servos", "show", "--port", table.port)
    assert ended.code == 0
    row = next(line for line in ended.out.splitlines() if "l_elbow_flexion" in line)
    assert row.split()[:8] == ["l_elbow_flexion", "15", "xm430_w210", "52", "25.0", "25", "12.0", "off"]
    assert "RETURN_DELAY_TIME 250 (-> 0)" in row


def test_show_exits_with_a_fault_when_a_servo_is_another(kinesic, table):
    table.set(15, Register.MODEL_NUMBER, 1060)
    ended = kinesic("servos", "show", "--port", table.port)
    assert ended.code == 3
    assert "xl430_w250, must be xm430_w210" in ended.out


def test_release_lets_go_of_all_and_says_so(kinesic, table):
    table.energise()
    ended = kinesic("servos", "release", "--yes", "--port", table.port)
    assert (ended.code, ended.out) == (0, "all 23 servos are limp\n")
    assert table.energised == 0


def test_release_says_what_will_fall(kinesic, table):
    raised = next(member for member in table.members if member.hinge == "l_elbow_flexion")
    k = [fitting.servo for fitting in table.cable.fittings].index(raised.id)
    rest = np.degrees(Robot.load().skeleton.rest[raised.joint])
    table.physics.turn(k, table.physics.shafts()[k].angle + raised.turns * np.radians(70.0))
    table.plant.advance(0.01)
    table.set(raised.id, Register.GOAL_POSITION, table.plant.servos[k].electronics.here())
    table.energise()
    ended = kinesic("servos", "release", "--port", table.port, stdin=b"n\n")
    assert ended.code == 130
    assert table.energised == 23
    (line,) = [line for line in ended.err.splitlines() if line.startswith("will fall: ")]
    ticks = np.full(23, table.plant.servos[k].electronics.here())
    stood = np.degrees(Manifest.of(Robot.load()).scale.angles(ticks)[table.members.index(raised)])
    assert line == f"will fall: l_elbow_flexion at {stood:.0f} deg (rest: {rest:.0f})"


def test_release_asks_first(kinesic, table):
    table.energise()
    ended = kinesic("servos", "release", "--port", table.port, stdin=b"n\n")
    assert ended.code == 130
    assert table.energised == 23


def test_doctor_says_what_to_mend(kinesic, table):
    assert kinesic("servos", "doctor", "--port", table.port).out.splitlines()[-1] == "all well"
    table.set(15, Register.MODEL_NUMBER, 1060)
    ended = kinesic("servos", "doctor", "--port", table.port)
    assert ended.code == 1
    assert "servo 15: is a xl430_w250, must be a xm430_w210" in ended.out
    assert ended.out.splitlines()[-1] == "1 to mend"


def test_calibrate_writes_what_hands_have_shown(kinesic, table, mine, monkeypatch):
    begun = calibrate.read_zero_posture

    def beginning(*given, **named):
        travel = begun(*given, **named)
        table.turn(
            lambda hinge: 15.0 if hinge != "vl5_roll" else -15.0,
            lambda hinge: HINGES[hinge][1] if hinge != "l_elbow_flexion" else 110.0,
            lambda hinge: HINGES[hinge][0],
        )
        return travel

    monkeypatch.setattr(calibrate, "read_zero_posture", beginning)
    table.set(15, Register.MIN_POSITION_LIMIT, 1000)
    table.set(15, Register.HOMING_OFFSET, 100)
    options = ("--robot", mine, "--port", table.port, "--yes", "--seconds", "2")
    ended = kinesic("servos", "calibrate", *options)
    path = mine.with_name("mine.calibration.toml")
    assert (ended.code, ended.err) == (0, "")
    assert ended.out.splitlines()[-1] == f"calibration: {path}"
    assert "l_elbow_flexion goes 0..110 deg only" in ended.out
    found = tomllib.loads(path.read_text(encoding="utf-8"))
    assert found["zero_ticks"]["l_elbow_flexion"] == 2332
    assert [hinge for hinge, inverted in found["inverted"].items() if inverted] == ["vl5_roll"]
    assert found["range_deg"] == {"l_elbow_flexion": [0, 110]}
    assert np.degrees(Robot.load(mine).skeleton.upper[Robot.load().skeleton.joint("l_elbow_flexion")]) == 110
    assert "servo 15: HOMING_OFFSET 100 -> 0\nservo 15: MIN_POSITION_LIMIT 1000 -> 0\n" in ended.out
    assert table.energised == 0


def test_calibrate_follows_no_link(kinesic, table, mine):
    path = mine.with_name("mine.calibration.toml")
    path.symlink_to("nowhere.toml")
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "1")
    assert ended.code == 2
    assert ended.err == f"kinesic: {path} is a link, and links are never followed; name the file itself\n"
    assert not mine.with_name("nowhere.toml").exists()


def test_calibrate_wants_limp_servos(kinesic, table, mine):
    table.energise()
    ended = kinesic("servos", "calibrate", "--robot", mine, "--port", table.port, "--yes", "--seconds", "1")
    assert ended.code == 2
    assert "has torque, like 22 others" in ended.err
    assert not mine.with_name("mine.calibration.toml").exists()


@pytest.mark.parametrize("verb", ["show", "release", "doctor", "calibrate"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "no port given; add --port body=PATH; serial ports here:"),
        (("--port", "arm=/dev/null"), "--port arm=/dev/null: no bus arm; known: body; give NAME=PATH"),
        (("--port", "a", "--port", "b"), "--port b: give one path for bus body"),
    ],
)
def test_ports_that_are_named_wrongly(kinesic, verb: str, options: tuple[str, ...], message: str):
    ended = kinesic("servos", verb, *options)
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {message}")


@pytest.mark.parametrize("verb", ["show", "release", "scan", "calibrate"])
def test_no_such_port_is_one_line(kinesic, verb: str):
    silent = {"release": ("--yes",), "calibrate": ("--yes", "--seconds", "1")}.get(verb, ())
    ended = kinesic("servos", verb, "--port", "/dev/nothing", *silent)
    assert ended.code == 2
    assert ended.err.startswith("kinesic: /dev/nothing: no such port; is the adapter plugged in?")
    assert len(ended.err.splitlines()) == 1


def test_a_port_that_another_program_uses(kinesic, served):
    wire = SerialWire(served.port, 1_000_000)
    ended = kinesic("servos", "release", "--yes", "--port", served.port)
    wire.close()
    assert ended.code == 2
    assert "another program uses this port" in ended.err


def test_calibrate_without_a_terminal_does_not_ask(kinesic):
    ended = kinesic("servos", "calibrate", "--port", "/dev/nothing", "--yes")
    assert ended.code == 2
    assert "standard input is no terminal; give --yes and --seconds N" in ended.err
