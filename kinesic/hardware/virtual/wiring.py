"""Description and construction of virtual servo buses."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from kinesic.body.arrays import Floats
from kinesic.body.robot import Robot
from kinesic.hardware.protocol.models import MODELS_BY_NUMBER, SERVO_MODELS, control_table_of
from kinesic.hardware.protocol.registers import TICK_ANGLE, Register
from kinesic.hardware.protocol.servo_map import MID_TICKS, ServoMap
from kinesic.hardware.virtual.bus import ADAPTER_LATENCY, VirtualBus
from kinesic.hardware.virtual.faults import BUILD_KINDS, NO_FAULTS, FaultPlan
from kinesic.hardware.virtual.frame_servo import FrameServo
from kinesic.hardware.virtual.physics import FirstOrder, Motor, Physics, Shaft
from kinesic.hardware.virtual.servo import NEWEST_FIRMWARE, VirtualServo
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation

DEFAULT_MOTOR = Motor()  # Default first-order motor of a servo


@dataclass(frozen=True)
class ServoFitting:
    """Settings of one mounted servo: id, model, firmware and position."""

    servo: int  # id of the servo
    model: str = "xm430_w350"
    firmware: int = NEWEST_FIRMWARE
    ticks: int = MID_TICKS  # [ticks] position of its shaft
    return_delay: int = 0  # [counts of 2 us] delay of replies; 250 in a new servo
    latches_goal: bool = False  # see `VirtualServo`
    motor: Motor = DEFAULT_MOTOR

    def build(self, baud: int) -> VirtualServo:
        """Build the virtual servo for a baud rate [bit/s]."""
        model = SERVO_MODELS[self.model]
        servo = (VirtualServo if model.table is None else FrameServo)(
            model,
            servo=self.servo,
            baud=baud,
            firmware=self.firmware,
            latches_goal=self.latches_goal,
        )
        servo.memory[Register.RETURN_DELAY_TIME] = self.return_delay
        return servo


@dataclass(frozen=True)
class Cable:
    """Virtual bus wire with the servos connected to it."""

    name: str
    fittings: tuple[ServoFitting, ...]
    baud: int = 1_000_000  # [bit/s] of servos and host
    latency: float = ADAPTER_LATENCY  # [s] of the adapter's timer
    faults: FaultPlan = NO_FAULTS


def describe_cables(robot: Robot, posture: Floats | None = None) -> tuple[Cable, ...]:
    """Return the virtual wires of a robot, none without [[bus]] tables.

    Args:
        robot: description.
        posture: (n,) [rad] posture of its servos; None: the rest posture.

    Raises:
        ConfigError: the tables of the buses are invalid, or a servo model is unknown.
    """
    wiring = ServoMap.of(robot)
    if not wiring.buses:
        return ()
    ticks = wiring.scale.ticks(robot.skeleton.rest if posture is None else posture)
    models = [mount.drive.servo for mount in robot.mounts]
    fitted: dict[str, list[ServoFitting]] = {bus.name: [] for bus in wiring.buses}
    for servos, place, model in zip(wiring.servos, ticks, models, strict=True):
        motor = Motor.of(model)
        name = control_table_of(model, f"{robot.path}: {servos.hinge}").name  # the robot's file may name it otherwise
        fitted[servos.bus] += [ServoFitting(k, model=name, ticks=int(place), motor=motor) for k in servos.ids]
    return tuple(Cable(bus.name, tuple(fitted[bus.name]), baud=bus.baud) for bus in wiring.buses)


def independent_motors(wires: Sequence[Cable]) -> FirstOrder:
    """Make a first-order motor for each servo, starting at its shaft position.

    The position is that of its `ServoFitting`.
    """
    fittings = [fitting for wire in wires for fitting in wire.fittings]
    return FirstOrder([fitting.motor for fitting in fittings], [fitting.ticks * TICK_ANGLE for fitting in fittings])


def build_bus(
    wires: Sequence[Cable], physics: Physics | None = None
) -> tuple[ShaftSimulation, Mapping[str, VirtualBus]]:
    """Build virtual servos on virtual wires.

    Args:
        wires: description of the wires.
        physics: physics of the shafts, wire by wire in the order of the fittings; None: first-order motors.

    Returns:
        The simulation of all servos, and each wire by name.
    """
    if physics is None:
        physics = independent_motors(wires)
    groups = [[_altered(fitting, wire.faults).build(wire.baud) for fitting in wire.fittings] for wire in wires]
    for wire, group in zip(wires, groups, strict=True):
        _disguise(group, wire.faults)
    plant = ShaftSimulation([servo for group in groups for servo in group], physics)
    buses = {
        wire.name: VirtualBus(
            plant, [*group, *_intruders(wire)], baud=wire.baud, latency=wire.latency, faults=wire.faults
        )
        for wire, group in zip(wires, groups, strict=True)
    }
    return plant, buses


def _altered(fitting: ServoFitting, faults: FaultPlan) -> ServoFitting:
    for fault in faults.of(frozenset({"old_firmware"})):
        if fault.affects(fitting.servo, fault.start):
            return replace(fitting, firmware=int(fault.effective_value))
    return fitting


def _disguise(servos: Sequence[VirtualServo], faults: FaultPlan) -> None:
    """Overwrite model numbers of servos as a planned fault requires."""
    for fault in faults.of(frozenset({"wrong_model"})):
        for servo in servos:
            if fault.affects(servo.id, fault.start):
                servo.memory[Register.MODEL_NUMBER] = int(fault.effective_value)


def _intruders(wire: Cable) -> Iterator[VirtualServo]:
    """Yield additional servos that duplicate an id on the wire.

    Their shafts do not move.
    """
    for fault in wire.faults.of(BUILD_KINDS):
        if fault.kind != "duplicate_id":
            continue
        for fitting in wire.fittings:
            if fault.affects(fitting.servo, fault.start):
                model = MODELS_BY_NUMBER[int(fault.effective_value)].name if fault.effective_value else fitting.model
                intruder = replace(fitting, model=model).build(wire.baud)
                intruder.electronics.place(Shaft((fitting.ticks // 2) * TICK_ANGLE), 0.0)
                yield intruder
