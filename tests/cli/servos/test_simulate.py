"""Third-party Dynamixel programs on the ports of `kinesic servos simulate`."""

import importlib
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from dynamixel_sdk import COMM_SUCCESS, GroupBulkRead, GroupSyncRead, GroupSyncWrite, PacketHandler, PortHandler

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.wiring import describe_cables

pytestmark = pytest.mark.realtime

WAIT_TIMEOUT = 30.0  # [s] longest wait for a condition, sufficient on a loaded machine
FITTINGS = {fitting.servo: fitting for fitting in describe_cables(Robot.load())[0].fittings}
HINGES = [hinge.name for hinge in Robot.load().skeleton.hinges]

SILENT_SERVO = 28  # id of the servo with a fault


@contextmanager
def simulated(folder: Path, *options: str) -> Iterator[Path]:
    """Simulate the default robot's bus in another process, and yield its port."""
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--folder", str(folder), *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            line = process.stdout.readline()
            assert line == f"body: {folder / 'body'} at 1000000 baud, 23 servos\n"
            yield folder / "body"
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(WAIT_TIMEOUT) == 0


@pytest.fixture(scope="module", params=["servo", "twin"])
def port(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("ports")
    plan = folder / "faults.toml"
    plan.write_text(f'[[fault]]\nkind = "silent"\nservos = [{SILENT_SERVO}]\n', encoding="utf-8")
    with simulated(folder, "--physics", request.param, "--faults", str(plan)) as path:
        yield path
    assert not path.is_symlink()


@pytest.fixture
def sdk(port: Path) -> Iterator[tuple[PortHandler, PacketHandler]]:
    handler = PortHandler(str(port))
    assert handler.openPort()
    assert handler.setBaudRate(1_000_000)
    yield handler, PacketHandler(2.0)
    handler.closePort()


def until(condition: Callable[[], bool]) -> None:
    """Wait until a condition holds."""
    deadline = time.monotonic() + WAIT_TIMEOUT
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def test_dynamixel_sdk_finds_all_simulated_servos_except_a_silent_one(sdk: tuple[PortHandler, PacketHandler]):
    port, protocol = sdk
    outcome, result = protocol.broadcastPing(port)
    assert result == COMM_SUCCESS
    assert sorted(outcome) == sorted(FITTINGS.keys() - {SILENT_SERVO})
    assert protocol.ping(port, 1)[0] == 1130
    port.setBaudRate(57_600)
    assert protocol.ping(port, 1)[1] != COMM_SUCCESS


def test_simulated_servos_support_sync_and_bulk_commands_of_the_dynamixel_sdk(sdk: tuple[PortHandler, PacketHandler]):
    port, protocol = sdk
    neck = [5, 6, 7]
    read, write, bulk = (
        GroupSyncRead(port, protocol, 132, 4),
        GroupSyncWrite(port, protocol, 116, 4),
        GroupBulkRead(port, protocol),
    )
    goals = {servo: FITTINGS[servo].ticks + 40 * servo for servo in neck}
    for servo, goal in goals.items():
        here = protocol.read4ByteTxRx(port, servo, 132)[0]
        assert protocol.write4ByteTxRx(port, servo, 116, here) == (COMM_SUCCESS, 0)
        assert protocol.write1ByteTxRx(port, servo, 64, 1) == (COMM_SUCCESS, 0)
        assert write.addParam(servo, list(goal.to_bytes(4, "little")))
        assert read.addParam(servo)
        assert bulk.addParam(servo, 132, 4)
    assert write.txPacket() == COMM_SUCCESS
    requests = (read.txRxPacket, read.fastSyncRead, bulk.txRxPacket, bulk.fastBulkRead)
    sources = (read, read, bulk, bulk)
    for request, source in zip(requests, sources, strict=True):

        def is_there(request=request, source=source) -> bool:
            if request() != COMM_SUCCESS:
                return False
            return all(abs(source.getData(servo, 132, 4) - goal) <= 8 for servo, goal in goals.items())

        until(is_there)


def test_simulated_servos_support_errors_reboots_and_registered_writes_of_the_sdk(
    sdk: tuple[PortHandler, PacketHandler],
):
    port, protocol = sdk
    assert protocol.write1ByteTxRx(port, 1, 64, 1) == (COMM_SUCCESS, 0)
    assert protocol.write1ByteTxRx(port, 1, 7, 9) == (COMM_SUCCESS, 7), "EEPROM is locked"
    assert protocol.write4ByteTxRx(port, 1, 116, 5000) == (COMM_SUCCESS, 6)
    assert protocol.regWriteTxRx(port, 1, 65, 1, [1]) == (COMM_SUCCESS, 0)
    assert protocol.read1ByteTxRx(port, 1, 65)[0] == 0
    assert protocol.action(port, 1) == COMM_SUCCESS
    # The SDK does not read the answer to the action, and would take it for that of the next request.
    until(lambda: port.clearPort() or protocol.read1ByteTxRx(port, 1, 65)[0] == 1)
    assert protocol.reboot(port, 1) == (COMM_SUCCESS, 0)
    until(lambda: protocol.ping(port, 1)[1] == COMM_SUCCESS)
    assert protocol.read1ByteTxRx(port, 1, 64)[0] == 0


def test_rustypot_reads_and_moves_simulated_servos(port: Path):
    rustypot = pytest.importorskip("rustypot", reason="rustypot is not installed")
    servos = rustypot.Xl430PyController(str(port), 1_000_000, 0.5)
    ids = [5, 6, 7]
    try:
        assert servos.ping(5)
        assert servos.sync_read_model_number(ids) == [1080] * 3
        servos.sync_write_goal_position(ids, servos.sync_read_present_position(ids))
        servos.sync_write_torque_enable(ids, [1] * 3)
        goals = [2100, 2120, 2140]
        servos.sync_write_goal_position(ids, goals)
        for fast in (False, True):
            servos.set_fast_sync_read(fast)
            until(
                lambda: all(abs(a - b) <= 8 for a, b in zip(servos.sync_read_present_position(ids), goals, strict=True))
            )
    finally:
        servos.close()


def test_lerobot_reads_and_moves_simulated_servos(port: Path):
    pytest.importorskip("lerobot", reason="lerobot is not installed")
    module = importlib.import_module("lerobot.motors.dynamixel")
    motors = importlib.import_module("lerobot.motors")
    normal = motors.MotorNormMode.DEGREES
    bus = module.DynamixelMotorsBus(str(port), {"neck": motors.Motor(5, "xl430-w250", normal)})
    bus.connect(handshake=False)
    bus.set_baudrate(1_000_000)
    try:
        here = bus.read("Present_Position", "neck", normalize=False)
        bus.write("Goal_Position", "neck", here, normalize=False)
        bus.write("Torque_Enable", "neck", 1, normalize=False)
        bus.write("Goal_Position", "neck", 2200, normalize=False)
        until(lambda: abs(bus.sync_read("Present_Position", normalize=False)["neck"] - 2200) <= 8)
    finally:
        bus.disconnect()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--baud", "1000001"), "--baud is 1000001, must be one of 9600, 19200, 57600"),
        (("--faults", "nowhere.toml"), "nowhere.toml: no such file"),
        (("--robot", "upper2"), "no robot upper2; did you mean upper22?"),
        (("--physics", "magic"), "'magic' is not one of 'servo', 'twin'"),
    ],
)
def test_invalid_option_of_simulate_is_reported(kinesic, options: tuple[str, ...], message: str):
    ended = kinesic("servos", "simulate", *options)
    assert ended.code == 2
    assert message in ended.err


def test_robot_without_buses_is_refused_by_simulate(kinesic, tmp_path: Path):
    text = Robot.load().path.read_text(encoding="utf-8")
    (tmp_path / "bare.toml").write_text(text[: text.index("[[bus]]")], encoding="utf-8")
    ended = kinesic("servos", "simulate", "--robot", "bare.toml")
    assert ended.code == 2
    assert "no [[bus]], so there are no servos to simulate" in ended.err


@pytest.mark.soak
def test_enter_starts_simulated_joint_rotations_for_manual_calibration(tmp_path: Path):
    zeros = ServoMap.of(Robot.load()).scale.zeros
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--by-hand", "--folder", str(tmp_path)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
    with subprocess.Popen(command, **pipes) as process:
        process.stdout.readline()
        handler, protocol = PortHandler(str(tmp_path / "body")), PacketHandler(2.0)
        assert handler.openPort()
        assert handler.setBaudRate(1_000_000)
        elbow = Register.PRESENT_POSITION.field.address
        assert protocol.read4ByteTxRx(handler, 15, elbow)[0] == zeros[HINGES.index("l_elbow_flexion")]
        process.stdin.write("\n")
        process.stdin.flush()
        until(lambda: protocol.read4ByteTxRx(handler, 15, elbow)[0] > zeros[HINGES.index("l_elbow_flexion")] + 1000)
        handler.closePort()
        process.stdin.close()
        process.send_signal(signal.SIGINT)
        assert process.wait(WAIT_TIMEOUT) == 0


@pytest.mark.soak
def test_simulate_refuses_manual_calibration_with_twin_physics():
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--by-hand", "--physics", "twin"]
    ended = subprocess.run(command, check=False, capture_output=True, text=True, timeout=WAIT_TIMEOUT)
    assert ended.returncode == 2
    assert ended.stderr == "kinesic: --by-hand turns servos without a body; leave out --physics twin\n"
