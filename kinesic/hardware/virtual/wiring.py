"""Describes which virtual servos stand on which wires, and builds them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.models import BY_NUMBER, MODELS
from kinesic.hardware.protocol.registers import TICK, Register
from kinesic.hardware.protocol.servo_map import MID_TICKS, ServoMap
from kinesic.hardware.virtual.bus import LATENCY, VirtualBus
from kinesic.hardware.virtual.faults import BUILD_KINDS, CALM, FaultPlan
from kinesic.hardware.virtual.physics import FirstOrder, Motor, Physics, Shaft
from kinesic.hardware.virtual.servo import NEWEST, VirtualServo
from kinesic.hardware.virtual.shaft_simulation import ShaftSimulation

USUAL = Motor()


@dataclass(frozen=True)
class ServoFitting:
    """One servo as it is mounted."""

    servo: int  # id
    model: str = "xm430_w350"
    firmware: int = NEWEST
    ticks: int = MID_TICKS  # where its shaft stands
    return_delay: int = 0  # [2 us], 250 in a new one
    latches_goal: bool = False  # see `VirtualServo`
    motor: Motor = USUAL

    def build(self, baud: int) -> VirtualServo:
        """Builds the servo, which talks at a baud rate."""
        servo = VirtualServo(
            MODELS[self.model],
            servo=self.servo,
            baud=baud,
            firmware=self.firmware,
            latches_goal=self.latches_goal,
        )
        servo.memory[Register.RETURN_DELAY_TIME] = self.return_delay
        return servo


@dataclass(frozen=True)
class Cable:
    """One wire with its servos."""

    name: str
    fittings: tuple[ServoFitting, ...]
    baud: int = 1_000_000  # [bit/s] of servos and host
    latency: float = LATENCY  # [s] of the adapter
    faults: FaultPlan = CALM


def cables(robot: Robot) -> tuple[Cable, ...]:
    """Describes the wires of a robot, its servos at rest."""
    wiring = ServoMap.of(robot)
    if not wiring.buses:
        return ()
    ticks = wiring.scale.ticks(robot.skeleton.rest)
    models = [mount.drive.servo for mount in robot.mounts]
    fitted: dict[str, list[ServoFitting]] = {bus.name: [] for bus in wiring.buses}
    for servos, place, model in zip(wiring.servos, ticks, models, strict=True):
        motor = Motor.of(model)
        fitted[servos.bus] += [ServoFitting(k, model=model.name, ticks=int(place), motor=motor) for k in servos.ids]
    return tuple(Cable(bus.name, tuple(fitted[bus.name]), baud=bus.baud) for bus in wiring.buses)


def build_bus(
    wires: Sequence[Cable], physics: Physics | None = None
) -> tuple[ShaftSimulation, Mapping[str, VirtualBus]]:
    """Builds virtual servos on virtual wires.

    Args:
        wires: what to build.
        physics: of the shafts, wire by wire in the order of the fittings; motors of the first order if not given.

    Returns:
        The plant of all servos, and each wire by name.
    """
    fittings = [fitting for wire in wires for fitting in wire.fittings]
    if physics is None:
        physics = FirstOrder([fitting.motor for fitting in fittings], [fitting.ticks * TICK for fitting in fittings])
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
        if fault.strikes(fitting.servo, fault.start):
            return replace(fitting, firmware=int(fault.figure))
    return fitting


def _disguise(servos: Sequence[VirtualServo], faults: FaultPlan) -> None:
    """Servos of another model than the robot's description says."""
    for fault in faults.of(frozenset({"wrong_model"})):
        for servo in servos:
            if fault.strikes(servo.id, fault.start):
                servo.memory[Register.MODEL_NUMBER] = int(fault.figure)


def _intruders(wire: Cable) -> Iterator[VirtualServo]:
    """Second servos with an id of the wire, on shafts that nothing turns."""
    for fault in wire.faults.of(BUILD_KINDS):
        if fault.kind != "duplicate_id":
            continue
        for fitting in wire.fittings:
            if fault.strikes(fitting.servo, fault.start):
                model = BY_NUMBER[int(fault.figure)].name if fault.figure else fitting.model
                intruder = replace(fitting, model=model).build(wire.baud)
                intruder.electronics.place(Shaft((fitting.ticks // 2) * TICK), 0.0)
                yield intruder
