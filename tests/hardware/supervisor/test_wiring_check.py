"""Bus load and supply voltage of robots, computed from their files."""

from dataclasses import replace
from types import MappingProxyType

import pytest

from kinesic.body.description import Supply
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.wire import BusError
from kinesic.hardware.servos import Servos
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.preflight import prepare_servos
from kinesic.hardware.supervisor.wiring_check import (
    compute_bus_loads,
    explain_missing_watchdog,
    explain_rare_answers,
    find_supply_faults,
)
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import build_bus, describe_cables

from .conftest import manifest_of


def manifest_at(baud: int) -> Manifest:
    manifest = Manifest.of(Robot.load())
    return replace(manifest, bauds=MappingProxyType(dict.fromkeys(manifest.bauds, baud)))


def test_bus_load_counts_goals_query_and_fast_reply():
    (load,) = compute_bus_loads(manifest_at(1_000_000), period=0.01)
    # 14 + 5 N goals, 10 + 5 N query of different addresses, 8 + 22 N reply
    assert (load.servos, load.octets) == (23, 14 + 5 * 23 + 10 + 5 * 23 + 8 + 22 * 23)
    assert load.fits
    assert load.text == "23 servos at 1000000 baud use 77 % of the bus"


def test_bus_load_equals_the_bytes_of_a_real_cycle():
    robot = Robot.load()
    (cable,) = describe_cables(robot)
    _, buses = build_bus([cable])
    wire = MemoryWire(buses[cable.name])
    axes = prepare_servos(Manifest.of(robot), {cable.name: wire}, period=0.01)
    sent, received = list[int](), list[int]()
    write, read = wire.write, wire.read

    def write_counted(data: bytes | bytearray) -> None:
        sent.append(len(data))
        write(data)

    def read_counted(deadline: float) -> bytes:
        data = read(deadline)
        received.append(len(data))
        return data

    wire.write, wire.read = write_counted, read_counted
    axes.cycle(axes.cycle(None).positions.astype(int))
    (load,) = compute_bus_loads(axes.manifest, period=0.01)
    goals = 14 + 5 * load.servos
    assert sum(sent) + sum(received) == 2 * load.octets - goals  # the first cycle has no goals


def test_error_for_a_too_slow_bus_names_a_sufficient_baud_rate():
    manifest = manifest_at(57_600)
    (load,) = compute_bus_loads(manifest, period=0.01)
    assert not load.fits
    assert load.text.endswith("set servos and robot file to 1000000 baud: `kinesic servos set-baud`")
    (fast,) = compute_bus_loads(manifest, period=0.0005)
    assert fast.text.endswith("distribute them over several buses")
    text = explain_rare_answers(manifest, ["port: servo 1 (hinge)"], period=0.01)
    assert text.startswith("1 of 23 servos answer too rarely; bus body: 23 servos at 57600 baud use ")
    assert text.endswith(" (port: servo 1 (hinge))")


def test_robot_with_a_too_slow_bus_is_refused_before_a_port_is_opened(tmp_path):
    robot_file = tmp_path / "slow.toml"
    text = Robot.load().path.read_text(encoding="utf-8")
    robot_file.write_text(text.replace("baud = 1_000_000", "baud = 57_600"), encoding="utf-8")
    with pytest.raises(BusError, match=r"bus body is too slow: 23 servos at 57600 baud use 1333 % of the bus"):
        Servos(Robot.load(robot_file), {"body": tmp_path / "missing"})


@pytest.mark.parametrize(("volts", "count"), [(12.0, 0), (14.8, 1), (17.0, 5), (5.0, 5)])
def test_error_for_an_unsuitable_supply_voltage_names_servo_models_and_hinges(volts: float, count: int):
    robot = Robot.load()
    robot = replace(robot, supply=Supply(volts, 10.0))
    lines = find_supply_faults(robot)
    assert len(lines) == count
    if count == 5:
        assert any("xm430_w210 takes 9.5..16.0 V (l_shoulder_twisting" in line for line in lines)
    assert all(line.startswith(f"[supply] has {volts:g} V, but ") for line in lines)


def test_robot_file_without_supply_voltage_gives_no_supply_faults():
    robot = Robot.load()
    assert find_supply_faults(replace(robot, supply=None)) == ()


def test_wiring_check_states_the_safety_of_servos_without_a_bus_watchdog():
    assert explain_missing_watchdog(manifest_of(2, 1_000_000)) == ""
    text = explain_missing_watchdog(manifest_of(2, 1_000_000, "sts3215"))
    assert text.startswith("servos of bus body have no bus watchdog: if the supervisor process")
    assert "hold it with torque" in text


def test_bus_load_of_servos_that_are_read_singly_includes_the_adapter_latency():
    (sts,) = compute_bus_loads(manifest_of(14, 1_000_000, "sts3215"), period=0.01)
    (few,) = compute_bus_loads(manifest_of(8, 1_000_000, "ax12"), period=0.01)
    (many,) = compute_bus_loads(manifest_of(26, 1_000_000, "ax12"), period=0.01)
    assert (sts.octets, sts.cycles) == (8 + 3 * 14 + 8 + 14 + 21 * 14, 1)
    assert sts.fits
    assert (few.fits, few.cycles) == (True, 3)
    assert not many.fits
    assert many.text.endswith("distribute them over several buses")
