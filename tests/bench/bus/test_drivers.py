"""lerobot in the fault matrix, as a test double or installed package."""

import sys
from enum import Enum
from functools import partial
from types import ModuleType, SimpleNamespace

import pytest
from dynamixel_sdk import COMM_SUCCESS, GroupSyncRead, GroupSyncWrite, PacketHandler, PortHandler

from kinesic.bench.bus.drivers import LerobotDriver, why_lerobot_is_missing
from kinesic.bench.bus.matrix import TrialResult, list_cases, run_trial

FAULT_CASES = {case.name: case for case in list_cases()}
MODEL_NUMBERS = {"xm430-w350": 1020}
REGISTER_ADDRESSES = {"Goal_Position": 116, "Present_Position": 132}


class FakeLerobotBus:
    """Test double of lerobot's bus, built on the Dynamixel SDK."""

    def __init__(self, port: str, motors: dict[str, SimpleNamespace]) -> None:
        self.motors, self.port_handler = motors, PortHandler(port)
        self.packets = PacketHandler(2.0)
        self.sync_reader = GroupSyncRead(self.port_handler, self.packets, 0, 4)
        self.sync_writer = GroupSyncWrite(self.port_handler, self.packets, 0, 4)

    def connect(self, handshake: bool = True) -> None:
        assert handshake
        assert not self.port_handler.is_open
        assert self.port_handler.openPort()
        for name, motor in self.motors.items():
            number, _, _ = self.packets.ping(self.port_handler, motor.id)
            if number != MODEL_NUMBERS[motor.model]:
                raise RuntimeError(f"check failed\n\n{name}: found {number}\n\nFull expected motor list: all of them")

    def sync_write(self, data_name: str, values: dict[str, int], *, normalize: bool, num_retry: int) -> None:
        assert not normalize
        self.sync_writer.clearParam()
        self.sync_writer.start_address = REGISTER_ADDRESSES[data_name]
        for name, value in values.items():
            self.sync_writer.addParam(self.motors[name].id, list(value.to_bytes(4, "little")))
        self.sync_writer.txPacket()

    def sync_read(self, data_name: str, *, normalize: bool, num_retry: int) -> dict[str, int]:
        assert not normalize
        address = self.sync_reader.start_address = REGISTER_ADDRESSES[data_name]
        self.sync_reader.clearParam()
        for motor in self.motors.values():
            self.sync_reader.addParam(motor.id)
        for _ in range(1 + num_retry):
            if self.sync_reader.txRxPacket() == COMM_SUCCESS:
                return {name: self.sync_reader.getData(motor.id, address, 4) for name, motor in self.motors.items()}
        raise ConnectionError("Failed to sync read")


@pytest.fixture
def double(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the lerobot modules by a test double."""
    motors, dynamixel = ModuleType("lerobot.motors"), ModuleType("lerobot.motors.dynamixel")
    mode = Enum("MotorNormMode", ["DEGREES"])
    vars(motors).update(
        MotorNormMode=mode, Motor=lambda id, model, norm_mode: SimpleNamespace(id=id, model=model, mode=norm_mode)
    )
    vars(dynamixel).update(DynamixelMotorsBus=FakeLerobotBus)
    for module in (ModuleType("lerobot"), motors, dynamixel):
        monkeypatch.setitem(sys.modules, module.__name__, module)


def run_case(name: str, *, retries: int = 0, cycles: int = 60) -> TrialResult:
    make_driver = partial(LerobotDriver, retries=retries)
    return run_trial(FAULT_CASES[name], make_driver, servos=5, baud=1_000_000, seed=1, cycles=cycles)


@pytest.mark.usefixtures("double")
def test_lerobot_reads_the_simulated_servos_without_errors():
    result = run_case("calm")
    assert why_lerobot_is_missing() == ""
    assert (result.exceptions, result.wrong, result.fresh) == (0, 0, 1.0)
    assert result.duration(50) < 0.01


@pytest.mark.usefixtures("double")
def test_lerobot_raises_for_lost_replies_unless_it_retries_reads():
    once, again = run_case("lost 5%"), run_case("lost 5%", retries=3)
    assert once.exceptions > 0
    assert again.exceptions == 0
    assert again.duration(99) > 0.01


@pytest.mark.usefixtures("double")
def test_lerobot_driver_reports_a_servo_of_the_wrong_model_in_one_line():
    assert run_case("wrong model").refused == "check failed servo2: found 1060"


def test_missing_lerobot_package_is_reported(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "lerobot", None)
    assert why_lerobot_is_missing().startswith("lerobot is not installed: ")


def test_installed_lerobot_package_drives_the_simulated_servos_without_errors():
    if why := why_lerobot_is_missing():
        pytest.skip(why)
    result = run_case("calm")
    assert (result.exceptions, result.wrong, result.fresh) == (0, 0, 1.0)
