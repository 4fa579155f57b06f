"""Verbs of `kinesic servos` on virtual servos."""

import json

import pytest

from kinesic.hardware.bus.serial_wire import SerialWire
from kinesic.hardware.protocol.registers import Register

pytestmark = pytest.mark.realtime


def test_scan_prints_id_baud_rate_and_joint_of_each_servo(kinesic, table):
    ended = kinesic("servos", "scan", "--port", table.port, "--baud", "1000000", "--baud", "57600")
    assert (ended.code, ended.out.splitlines()[-1]) == (0, "23 servos")
    row = next(line for line in ended.out.splitlines() if "l_elbow_flexion" in line)
    assert row.split() == ["table", "1000000", "15", "xm430_w210", "52", "Protocol", "2.0", "l_elbow_flexion"]


def test_scan_prints_servos_as_json(kinesic, table):
    ended = kinesic("servos", "scan", "--port", f"body={table.port}", "--baud", "1000000", "--json")
    servos = json.loads(ended.out)
    assert servos[0] == {
        "port": str(table.port),
        "baud": 1000000,
        "id": 1,
        "model": "xm540_w150",
        "firmware": 52,
        "shared": False,
        "protocol": "Protocol 2.0",
    }


def test_show_prints_servo_states_and_registers_that_differ_from_the_required_values(kinesic, table):
    table.set(15, Register.RETURN_DELAY_TIME, 250)
    ended = kinesic("servos", "show", "--port", table.port)
    assert ended.code == 0
    row = next(line for line in ended.out.splitlines() if "l_elbow_flexion" in line)
    assert row.split()[:8] == ["l_elbow_flexion", "15", "xm430_w210", "52", "18.0", "25", "12.0", "off"]
    assert "RETURN_DELAY_TIME 250 (-> 0)" in row


def test_show_exits_with_3_for_a_wrong_servo_model(kinesic, table):
    table.set(15, Register.MODEL_NUMBER, 1060)
    ended = kinesic("servos", "show", "--port", table.port)
    assert ended.code == 3
    assert "xl430_w250, must be xm430_w210" in ended.out


def test_doctor_reports_a_wrong_servo_model(kinesic, table):
    assert kinesic("servos", "doctor", "--port", table.port).out.splitlines()[-1] == "no problems"
    table.set(15, Register.MODEL_NUMBER, 1060)
    ended = kinesic("servos", "doctor", "--port", table.port)
    assert ended.code == 1
    assert "servo 15: is a xl430_w250, must be a xm430_w210" in ended.out
    assert ended.out.splitlines()[-1] == "1 to fix"


@pytest.mark.parametrize("verb", ["show", "release", "doctor", "calibrate"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "no port given; add --port body=PATH; serial ports here:"),
        (("--port", "arm=/dev/null"), "--port arm=/dev/null: no bus arm; known: body; give NAME=PATH"),
        (("--port", "a", "--port", "b"), "--port b: give one path for bus body"),
    ],
)
def test_invalid_port_options_are_reported(kinesic, verb: str, options: tuple[str, ...], message: str):
    ended = kinesic("servos", verb, *options)
    assert ended.code == 2
    assert ended.err.startswith(f"kinesic: {message}")


@pytest.mark.parametrize("verb", ["show", "release", "scan", "calibrate"])
def test_missing_port_is_reported_in_one_line(kinesic, verb: str):
    options = {"release": ("--yes",), "calibrate": ("--yes", "--seconds", "1")}.get(verb, ())
    ended = kinesic("servos", verb, "--port", "/dev/nothing", *options)
    assert ended.code == 2
    assert ended.err.startswith("kinesic: /dev/nothing: no such port; is the adapter plugged in?")
    assert len(ended.err.splitlines()) == 1


def test_release_verb_reports_a_busy_port(kinesic, served):
    wire = SerialWire(served.port, 1_000_000)
    ended = kinesic("servos", "release", "--yes", "--port", served.port)
    wire.close()
    assert ended.code == 2
    assert "another program uses this port" in ended.err


def test_calibrate_without_a_terminal_is_refused_if_option_seconds_is_missing(kinesic):
    ended = kinesic("servos", "calibrate", "--port", "/dev/nothing", "--yes")
    assert ended.code == 2
    assert "standard input is no terminal; give --yes and --seconds N" in ended.err
