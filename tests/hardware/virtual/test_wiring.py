from kinesic.body.robot import Robot
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import MODELS
from kinesic.hardware.protocol.packet import BROADCAST, Reader
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus, cables


def test_a_robot_is_its_buses_with_its_servos_at_rest():
    robot = Robot.load()
    wiring = ServoMap.of(robot)
    (cable,) = cables(robot)
    assert (cable.name, cable.baud) == ("body", 1_000_000)
    fitted = {fitting.servo: fitting for fitting in cable.fittings}
    assert set(fitted) == {servo for servos in wiring.servos for servo in servos.ids}
    rest = wiring.scale.ticks(robot.skeleton.rest)
    for servos, ticks, drive in zip(wiring.servos, rest, robot.drives, strict=True):
        for servo in servos.ids:
            assert (fitted[servo].ticks, fitted[servo].model) == (ticks, drive.servo.name)


def test_its_servos_answer_with_their_models_and_places():
    (cable,) = cables(Robot.load())
    plant, buses = build_bus([cable])
    wire = MemoryWire(buses["body"])
    wire.write(packet.ping(BROADCAST))
    got = b""
    while came := wire.read(0.1):
        got += came
    found = {status.id: int.from_bytes(status.data[:2], "little") for status in Reader().feed(got)}
    assert found == {fitting.servo: MODELS[fitting.model].number for fitting in cable.fittings}
    for servo, fitting in zip(plant.servos, cable.fittings, strict=True):
        assert servo.electronics.here() == fitting.ticks
        assert servo.memory[Register.TORQUE_ENABLE] == 0


def test_two_wires_move_through_the_same_time():
    plant, buses = build_bus([Cable("left", (ServoFitting(1),)), Cable("right", (ServoFitting(1), ServoFitting(2)))])
    left, right = (MemoryWire(buses[name]) for name in ("left", "right"))
    left.write(packet.write_packet(1, 64, b"\1"))
    assert [servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos] == [1, 0, 0]
    right.write(packet.write_packet(1, 64, b"\1"))
    assert [servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos] == [1, 1, 0]
