"""Other people's programs, unmodified, on the ports that `kinesic servos simulate` opens."""

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
from kinesic.hardware.virtual.wiring import cables

pytestmark = pytest.mark.realtime

PATIENCE = 30.0  # [s] that a loaded machine may take
FITTINGS = {fitting.servo: fitting for fitting in cables(Robot.load())[0].fittings}

SILENT = 28  # the id of a servo that the file of faults keeps from answering


@contextmanager
def simulated(folder: Path, *options: str) -> Iterator[Path]:
    """The port of the default robot's bus, served by another process."""
    command = [sys.executable, "-m", "kinesic", "servos", "simulate", "--folder", str(folder), *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            line = process.stdout.readline()
            assert line == f"body: {folder / 'body'} at 1000000 baud, 23 servos\n"
            yield folder / "body"
        finally:
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0


@pytest.fixture(scope="module", params=["servo", "twin"])
def port(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("ports")
    plan = folder / "faults.toml"
    plan.write_text(f'[[fault]]\nkind = "silent"\nservos = [{SILENT}]\n', encoding="utf-8")
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


def until(answers: Callable[[], bool]) -> None:
    """Waits for something that takes its time on the servos' clock."""
    limit = time.monotonic() + PATIENCE
    while not answers():
        assert time.monotonic() < limit
        time.sleep(0.02)


def test_the_sdk_finds_every_servo_but_the_one_that_a_fault_silences(sdk: tuple[PortHandler, PacketHandler]):
    port, protocol = sdk
    found, result = protocol.broadcastPing(port)
    assert result == COMM_SUCCESS
    assert sorted(found) == sorted(FITTINGS.keys() - {SILENT})
    assert protocol.ping(port, 1)[0] == 1130
    port.setBaudRate(57_600)
    assert protocol.ping(port, 1)[1] != COMM_SUCCESS


def test_the_sdk_moves_them_and_reads_them_in_every_way(sdk: tuple[PortHandler, PacketHandler]):
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
    asks = (read.txRxPacket, read.fastSyncRead, bulk.txRxPacket, bulk.fastBulkRead)
    sources = (read, read, bulk, bulk)
    for ask, source in zip(asks, sources, strict=True):

        def there(ask=ask, source=source) -> bool:
            if ask() != COMM_SUCCESS:
                return False
            return all(abs(source.getData(servo, 132, 4) - goal) <= 8 for servo, goal in goals.items())

        until(there)


def test_the_sdk_sees_errors_reboots_and_registered_writes(sdk: tuple[PortHandler, PacketHandler]):
    port, protocol = sdk
    assert protocol.write1ByteTxRx(port, 1, 64, 1) == (COMM_SUCCESS, 0)
    assert protocol.write1ByteTxRx(port, 1, 7, 9) == (COMM_SUCCESS, 7), "EEPROM is locked"
    assert protocol.write4ByteTxRx(port, 1, 116, 5000) == (COMM_SUCCESS, 6)
    assert protocol.regWriteTxRx(port, 1, 65, 1, [1]) == (COMM_SUCCESS, 0)
    assert protocol.read1ByteTxRx(port, 1, 65)[0] == 0
    assert protocol.action(port, 1) == COMM_SUCCESS
    time.sleep(0.05)  # it does not wait for the answer, and would take it for the next one's
    assert protocol.read1ByteTxRx(port, 1, 65)[0] == 1
    assert protocol.reboot(port, 1) == (COMM_SUCCESS, 0)
    until(lambda: protocol.ping(port, 1)[1] == COMM_SUCCESS)
    assert protocol.read1ByteTxRx(port, 1, 64)[0] == 0


def test_rustypot_reads_and_moves_them(port: Path):
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


def test_lerobot_reads_and_moves_them(port: Path):
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
        (("--baud", "1000001"), "--baud is 1000001, must be one of 9600, 57600"),
        (("--faults", "nowhere.toml"), "nowhere.toml: no such file"),
        (("--robot", "upper2"), "no robot upper2; did you mean upper22?"),
        (("--physics", "magic"), "'magic' is not one of 'servo', 'twin'"),
    ],
)
def test_bad_input_is_one_line(kinesic, options: tuple[str, ...], message: str):
    ended = kinesic("servos", "simulate", *options)
    assert ended.code == 2
    assert message in ended.err


def test_a_robot_without_buses_has_nothing_to_simulate(kinesic, tmp_path: Path):
    text = Robot.load().path.read_text(encoding="utf-8")
    (tmp_path / "bare.toml").write_text(text[: text.index("[[bus]]")], encoding="utf-8")
    ended = kinesic("servos", "simulate", "--robot", "bare.toml")
    assert ended.code == 2
    assert "no [[bus]], so there are no servos to simulate" in ended.err
