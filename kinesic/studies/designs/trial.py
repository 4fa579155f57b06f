"""What a design is worth: what it weighs and costs, whether it holds itself, and how it performs documents."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass

from kinesic.bml.block import BmlError
from kinesic.body.config import ConfigError, locate
from kinesic.body.robot import Robot
from kinesic.body.robot_extension import read_robot
from kinesic.body.robot_schema import RobotFile
from kinesic.controller.perform import perform, set_up
from kinesic.controller.performance import Performance
from kinesic.planning.setup import Setup
from kinesic.planning.workspace import workspace
from kinesic.report.checks import checks
from kinesic.report.checks.twin import stroke_errors
from kinesic.sim.robot_check import RobotCheck, check_robot
from kinesic.studies.designs.variant import Design, build

STALL = 0.8  # share of the stall torque above which a servo gives way or overheats, as reports judge it
LOST = 1.0  # [s] that a stroke counts as late which never came


@dataclass(frozen=True)
class BodyFigures:
    """What a design is before it performs."""

    price: float | None  # [US$] of all servos; None: that of a servo is not known
    mass: float  # [kg] of what moves
    arm_length: float  # [m]
    torque: float  # share of stall of the hinge that needs most, in its worst posture
    hinge: str  # which one
    sectors: int  # of gesture space that the left hand reaches, torso upright


@dataclass(frozen=True)
class DocumentFigures:
    """How a design performs one document in the twin."""

    file: str
    strokes: int
    late: float  # [s] off the asked time, summed over the strokes
    worst: float  # [s] off the asked time, of the latest stroke
    violations: tuple[str, ...]  # checks that fail, behaviours that are dropped, or why nothing is performed


@dataclass(frozen=True)
class DesignTask:
    """A design that performs some documents; with none of them it is only weighed."""

    design: Design
    documents: tuple[tuple[str, bytes], ...]  # name and content: workers need not see the folder that they lie in
    settings: str  # everything else that its result depends on

    @property
    def key(self) -> str:
        """Of its result."""
        digest = hashlib.blake2b(repr((self.design, self.settings)).encode(), digest_size=16)
        for name, content in self.documents:
            digest.update(name.encode() + b"\0" + hashlib.blake2b(content).digest())
        return digest.hexdigest()


@dataclass(frozen=True)
class Trial:
    """What is known of a design."""

    design: Design
    out: str = ""  # why it is none; empty where it can be built and holds itself
    body: BodyFigures | None = None  # None where it cannot be built
    documents: tuple[DocumentFigures, ...] = ()

    @property
    def lateness(self) -> float:
        """Of a stroke, in the mean [s]."""
        return sum(one.late for one in self.documents) / max(1, sum(one.strokes for one in self.documents))

    @property
    def worst(self) -> float:
        """Of the latest stroke [s]."""
        return max((one.worst for one in self.documents), default=0.0)

    @property
    def violations(self) -> int:
        """Checks that fail, behaviours that are dropped, and documents that are not performed."""
        return sum(len(one.violations) for one in self.documents)


def prepare_trials(robot: str, style: str) -> Callable[[DesignTask], Trial]:
    """Reads a robot's file, and gives the function that tries designs of it; the last one is kept for its next task."""
    path = locate("robot", robot)
    file = read_robot(path, RobotFile)
    kept: dict[Design, Setup] = {}

    def do(task: DesignTask) -> Trial:
        if task.design not in kept:
            kept.clear()
            try:
                body = build(file, task.design, path)
            except ConfigError as error:
                return Trial(task.design, str(error))
            kept[task.design] = set_up(body, style=style)
        known = kept[task.design]
        if not task.documents:
            return weigh(task.design, known.robot)
        return Trial(task.design, documents=tuple(_perform(name, content, known) for name, content in task.documents))

    return do


def weigh(design: Design, robot: Robot) -> Trial:
    """Weighs a design, and says why it is out where it collides at rest or does not hold itself."""
    found = check_robot(robot)
    hinge = int(found.worst_ratios.argmax())
    models = [(mount.drive.servo.price_usd, mount.drive.count) for mount in robot.mounts]
    known = [price * count for price, count in models if price is not None]
    body = BodyFigures(
        price=sum(known) if len(known) == len(models) else None,
        mass=found.moving_mass,
        arm_length=robot.arm_length,
        torque=float(found.worst_ratios[hinge]),
        hinge=robot.skeleton.names[hinge],
        sectors=len(workspace(robot).reached),
    )
    return Trial(design, _fault(robot, found, body), body)


def _fault(robot: Robot, found: RobotCheck, body: BodyFigures) -> str:
    least = robot.least_clearance
    if found.rest_gap.distance < least:
        a, b = found.rest_gap.pair
        gap = f"{1000 * found.rest_gap.distance:.0f} mm"
        return f"it collides: at rest {a} and {b} are {gap} apart, at least {1000 * least:.0f} mm are asked for"
    if body.torque > STALL:
        return f"it does not hold itself: {body.hinge} needs {body.torque:.2f} of its stall torque, {STALL:g} at most"
    return ""


def _perform(name: str, content: bytes, known: Setup) -> DocumentFigures:
    try:
        performance = perform(content, known, source=name)
    except BmlError as error:
        return DocumentFigures(name, 0, 0.0, 0.0, (str(error),))
    errors = [LOST if error is None else abs(error) for error, _ in stroke_errors(performance)]
    return DocumentFigures(name, len(errors), sum(errors), max(errors, default=0.0), tuple(_violations(performance)))


def _violations(performance: Performance) -> list[str]:
    failed = [check.name for check in checks(performance) if check.status == "fail"]
    outcomes = performance.plan.keyframes.outcomes
    return failed + [
        f"{name} dropped: {outcome.why}" for name, outcome in outcomes.items() if outcome.kind == "dropped"
    ]
