"""Steps of an owner's acceptance test, with bounds for each measurement.

The owner measures forces, masses and distances at the robot. Each bound follows from the model and the performed
motion. The test compares the robot with its model; it is not safety-rated and replaces no risk assessment.
"""

from dataclasses import dataclass
from hashlib import sha256
from math import sqrt

import mujoco
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.body.robot import Robot, Side
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS
from kinesic.sim.kinematics import body_frames
from kinesic.sim.log import Log
from kinesic.sim.model import build_model

MAX_VELOCITY_RATIO = 1.05  # largest peak velocity of a servo, relative to the twin
MAX_MASS_RATIO = 1.10  # largest mass of an arm, relative to the model; it raises forces by at most 5 %
MAX_PUSH_RATIO = 1.20  # largest pushing force, relative to the stall torques of the model
PAD_STIFFNESS = 75e3  # [N/m] stiffness of the pad on the scale, which stands for a hand or a face
STOP_TIME = 0.12  # [s] longest emergency stop from peak velocity in the model
UNPLUGGED_TIME = STOP_TIME + DEFAULT_SETTINGS.patient_watchdog  # [s] longest stop after the loss of the bus
ROD_DIAMETERS_MM = (8, 12, 25)  # [mm] diameters of the rods that stand for fingers
PUSH_COUNT = 3  # number of postures in which the hand pushes
PUSH_SEPARATION = 0.3  # [s] smallest time between two postures in which the hand pushes
SLOPE_WINDOW = 5  # samples of a velocity's least-squares line, which smooths the ticks of the encoder
SAMPLE_RATE = 100.0  # [Hz] of the resampled angles
MOVING_FRACTION = 0.2  # smallest peak velocity of a compared hinge, relative to the fastest hinge
ANGLE_STEP = 1e-5  # [rad] step of the finite differences of hand positions
MIN_LEVER = 1e-3  # [m] smallest lever of a hinge that limits the pushing force


@dataclass(frozen=True)
class Step:
    """One step of the acceptance test: a measured value and its bound."""

    name: str
    instruction: str  # text for the owner
    bound: float  # largest accepted value
    unit: str
    value: float | None = None  # measured without the owner; None: the owner answers


@dataclass(frozen=True, eq=False)
class FastPosture:
    """Posture with a fast hand, and the pushing force of the hand."""

    side: Side
    time: float  # [s] time in the log
    speed: float  # [m/s] of the hand
    force: float  # [N] in the direction of motion, at the stall torque of the weakest hinge


def list_measured_steps(robot: Robot, *, faults: int, force_ratio: float, planned: Log, measured: Log) -> list[Step]:
    """Return the acceptance test steps whose values are measured automatically.

    Args:
        robot: the robot.
        faults: number of faults that the diagnosis of the servos found.
        force_ratio: largest planned force on a person, relative to the limit of the policy.
        planned: motion of the twin.
        measured: motion of the servos.
    """
    ratio, hinge = compare_peak_velocities(robot, planned, measured)
    return [
        Step("servos", "faults of ports and servos", 0.0, "faults", float(faults)),
        Step("policy", "planned force relative to the limit of the policy", 1.0, "of limit", force_ratio),
        Step("velocity", f"peak velocity relative to the twin, most {hinge}", MAX_VELOCITY_RATIO, "of twin", ratio),
    ]


def list_manual_steps(robot: Robot, *, energy: float, segment: str, time: float, planned: Log) -> list[Step]:
    """Return the acceptance test steps that the robot's owner measures.

    Args:
        robot: the robot.
        energy: [J] largest planned energy of a contact, with its margin.
        segment: segment with this energy.
        time: [s] performance time of this energy.
        planned: motion of the twin.
    """
    fast = find_fast_postures(robot, planned)
    speed = max((posture.speed for posture in fast), default=0.0)
    strike = sqrt(2.0 * PAD_STIFFNESS * energy)
    mass = MAX_MASS_RATIO * arm_mass(robot)
    steps = [Step("mass", "Weigh one arm before you mount it, from the shoulder to the hand.", mass, "kg")]
    steps += [
        Step(
            f"push {number}",
            f"Stop the performance just before {posture.time:.2f} s (space). Hold a scale before the "
            f"{'left' if posture.side == 'l' else 'right'} hand, in its way, and continue (Enter). Read the peak.",
            MAX_PUSH_RATIO * posture.force,
            "N",
        )
        for number, posture in enumerate(fast, start=1)
    ]
    steps += [
        Step(
            "strike",
            f"Fix a scale with peak hold and a pad of 75 N/mm where {segment} passes at {time:.2f} s. Perform.",
            strike,
            "N",
        ),
        Step("stop", "Press the stop key at full speed. How far does the hand go on?", 100 * speed * STOP_TIME, "cm"),
        Step(
            "unplug",
            "Unplug the bus at full speed. How far does the hand go on?",
            100 * speed * UNPLUGGED_TIME,
            "cm",
        ),
    ]
    return steps + [
        Step(
            f"rod {diameter} mm",
            f"Hold a rod of {diameter} mm into every gap that a hinge closes. How many gaps hold it?",
            0.0,
            "gaps",
        )
        for diameter in ROD_DIAMETERS_MM
    ]


def compare_peak_velocities(robot: Robot, planned: Log, measured: Log) -> tuple[float, str]:
    """Return the largest ratio of peak velocities, and its hinge.

    Raises:
        ConfigError: no hinge moves in the planned motion.
    """
    peaks = _peak_velocities(planned)
    moving = np.flatnonzero((peaks > 0.0) & (peaks >= MOVING_FRACTION * peaks.max()))
    if not len(moving):
        raise ConfigError("no hinge moves in this performance; perform a document with gestures")
    ratios = _peak_velocities(measured)[moving] / peaks[moving]
    worst = int(ratios.argmax())
    return float(ratios[worst]), robot.skeleton.names[moving[worst]]


def _peak_velocities(log: Log) -> Floats:
    """Return the largest velocity of each hinge, (n,) [rad/s].

    Raises:
        ConfigError: the motion is too short.
    """
    times = np.arange(log.times[0], log.times[-1], 1.0 / SAMPLE_RATE)
    if len(times) < SLOPE_WINDOW:
        raise ConfigError("the performance is too short for a comparison of velocities")
    offsets = np.arange(SLOPE_WINDOW) - (SLOPE_WINDOW - 1) / 2
    weights = offsets / (offsets @ offsets) * SAMPLE_RATE
    rows = [np.correlate(np.interp(times, log.times, column), weights, "valid") for column in log.angles.T]
    peaks: Floats = np.abs(np.array(rows)).max(axis=1)
    return peaks


def find_fast_postures(robot: Robot, log: Log) -> list[FastPosture]:
    """Find the postures with the fastest hands, sorted by time."""
    candidates: list[tuple[float, int, Side, Floats]] = []
    for side in robot.sides:
        path = body_frames(robot, log.angles).origins[robot.arm(side).wrist].T
        velocities = np.gradient(path, log.times, axis=0)
        speeds = np.linalg.norm(velocities, axis=1)
        peaks = np.flatnonzero((speeds[1:-1] >= speeds[:-2]) & (speeds[1:-1] > speeds[2:])) + 1
        candidates += [(float(speeds[row]), int(row), side, velocities[row] / speeds[row]) for row in peaks]
    chosen: list[FastPosture] = []
    for speed, row, side, direction in sorted(candidates, key=lambda candidate: -candidate[0]):
        time = float(log.times[row])
        if len(chosen) < PUSH_COUNT and all(abs(time - other.time) >= PUSH_SEPARATION for other in chosen):
            force = pushing_force(robot, side, log.angles[row], direction)
            chosen.append(FastPosture(side, time, speed, force))
    return sorted(chosen, key=lambda posture: posture.time)


def pushing_force(robot: Robot, side: Side, angles: Floats, direction: Floats) -> float:
    """Return the hand force [N] that stalls the weakest hinge.

    Args:
        robot: the robot.
        side: side of the hand.
        angles: (n,) [rad] posture.
        direction: (3,) unit vector of the force, in the world.
    """
    moved = np.vstack([angles, angles + ANGLE_STEP * np.eye(len(angles))])
    places = body_frames(robot, moved).origins[robot.arm(side).wrist].T
    levers = np.abs((places[1:] - places[0]) @ direction) / ANGLE_STEP
    return float(np.min(robot.drives.stall / np.maximum(levers, MIN_LEVER)))


def arm_mass(robot: Robot) -> float:
    """Return the mass [kg] of the heaviest arm, upper arm included."""
    model = build_model(robot)
    names = [robot.skeleton.segments[robot.arm(side).shoulder].name for side in robot.sides]
    bodies = [mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) for name in names]
    return max(float(model.body_subtreemass[body]) for body in bodies)


def fingerprint_limbs(robot: Robot) -> str:
    """Return a hash of the masses, inertias and positions of all limbs."""
    model = build_model(robot)
    numbers = np.concatenate([model.body_mass, model.body_inertia.ravel(), model.body_pos.ravel()])
    return sha256(" ".join(f"{number:.5g}" for number in numbers).encode()).hexdigest()


def fingerprint_gains(manifest: Manifest) -> str:
    """Return a hash of the position gains of all servos."""
    words = [f"{member.bus} {member.id} {member.gains}" for member in manifest.members]
    return sha256("\n".join(words).encode()).hexdigest()
