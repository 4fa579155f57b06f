from kinesic.body.robot import Robot
from kinesic.hardware.protocol import packet
from kinesic.hardware.protocol.models import SERVO_MODELS
from kinesic.hardware.protocol.packet import BROADCAST_ID, Reader
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.protocol.servo_map import ServoMap
from kinesic.hardware.virtual.memory_wire import MemoryWire
from kinesic.hardware.virtual.wiring import Cable, ServoFitting, build_bus, describe_cables


def test_bus_description_of_a_robot_lists_servo_models_and_rest_ticks():
    robot = Robot.load()
    wiring = ServoMap.of(robot)
    (cable,) = describe_cables(robot)
    assert (cable.name, cable.baud) == ("body", 1_000_000)
    fitted = {fitting.servo: fitting for fitting in cable.fittings}
    assert set(fitted) == {servo for servos in wiring.servos for servo in servos.ids}
    rest = wiring.scale.ticks(robot.skeleton.rest)
    for servos, ticks, drive in zip(wiring.servos, rest, robot.drives, strict=True):
        for servo in servos.ids:
            assert (fitted[servo].ticks, fitted[servo].model) == (ticks, drive.servo.name)


def test_virtual_servos_of_a_robot_answer_with_their_models_and_positions():
    (cable,) = describe_cables(Robot.load())
    plant, buses = build_bus([cable])
    wire = MemoryWire(buses["body"])
    wire.write(packet.ping(BROADCAST_ID))
    got = b""
    while came := wire.read(0.1):
        got += came
    model_numbers = {status.id: int.from_bytes(status.data[:2], "little") for status in Reader().feed(got)}
    assert model_numbers == {fitting.servo: SERVO_MODELS[fitting.model].number for fitting in cable.fittings}
    for servo, fitting in zip(plant.servos, cable.fittings, strict=True):
        assert servo.electronics.present_position() == fitting.ticks
        assert servo.memory[Register.TORQUE_ENABLE] == 0


def test_servos_with_equal_ids_on_two_buses_are_simulated_separately_in_one_plant():
    plant, buses = build_bus([Cable("left", (ServoFitting(1),)), Cable("right", (ServoFitting(1), ServoFitting(2)))])
    left, right = (MemoryWire(buses[name]) for name in ("left", "right"))
    left.write(packet.write_packet(1, 64, b"\1"))
    assert [servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos] == [1, 0, 0]
    right.write(packet.write_packet(1, 64, b"\1"))
    assert [servo.memory[Register.TORQUE_ENABLE] for servo in plant.servos] == [1, 1, 0]
