"""Collisions of the twin with a free ball.

The measured force is compared with the computed bound.

The ball has the mass and the stiffness of a part of a person's body, with a linear spring and neither damping nor
friction. The twin has its servos, friction and gravity, and follows a planned motion until it meets the ball.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.impact_policy import RegionTable, force_rows
from kinesic.body.servo import tracking_lags
from kinesic.motion.trajectory import Trajectory
from kinesic.planning.setup import Setup
from kinesic.session.plan import plan
from kinesic.sim.model import build_model, find_actuator_indices, find_joint_indices

SIMULATION_STEP = 2e-5  # [s] simulation step; a contact lasts 4 to 20 ms
SETPOINT_STEPS = 50  # number of simulation steps per setpoint
MAX_STEPS = 4000  # largest number of simulation steps of a contact
FREE_STEPS = 50  # number of simulation steps without force after which a collision has ended
BALL_RADIUS = 0.05  # [m] radius of the ball
MIN_VELOCITY = 0.25  # [m/s] lowest velocity of a point that meets a ball
MIN_APPROACH = 0.5  # smallest cosine of the angle between velocity and contact normal
MAX_BIAS = 3.0  # largest weight of the velocity's direction in a random contact normal
ARM_PARTS = ("wrist", "elbow", "shoulder")  # parts of the names of segments that meet a ball
GESTURE_BLOCK = (
    '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b"><gesture id="g" lexeme="{}" start="1.0"/></bml>'
)


@dataclass(frozen=True, eq=False)
class Collision:
    """One collision of the twin with a ball."""

    lexeme: str
    region: str  # part of a person's body that the ball stands for
    segment: str  # segment of the robot that meets the ball
    velocity: float  # [m/s] velocity of the point at the beginning
    peak: float  # [N] largest force of the spring between point and ball
    bound: float  # [N] largest force that the report predicts for this time and region

    @property
    def ratio(self) -> float:
        """Measured force / force that the report predicts."""
        return self.peak / self.bound


@dataclass(frozen=True, eq=False)
class _Strike:
    """Time, place, normal and velocity at the beginning of a collision."""

    time: float  # [s] performance time
    geom: int  # index of the capsule in the MuJoCo model
    place: float  # position along the capsule's axis, 0..1
    normal: Floats  # (3,) unit, from the robot to the ball
    velocity: Floats  # (3,) [m/s] velocity of the point


def collide(
    setup: Setup, lexemes: Sequence[str], regions: Mapping[str, RegionTable], count: int, *, seed: int = 0
) -> Iterator[Collision]:
    """Yield collisions at random times, capsules and normals of random gestures.

    Args:
        setup: robot; its policy shapes the motions.
        lexemes: gestures to choose from.
        regions: parts of a person's body, in turn.
        count: number of collisions.
        seed: seed of all random choices.
    """
    chance, twin = np.random.default_rng(seed), CollidingTwin(setup)
    done = 0
    while done < count:
        lexeme = lexemes[int(chance.integers(len(lexemes)))]
        trajectory = plan(GESTURE_BLOCK.format(lexeme), setup).trajectory
        strike = twin.choose(trajectory, chance)
        if strike is None:
            continue
        name = list(regions)[done % len(regions)]
        done += 1
        yield Collision(
            lexeme=lexeme,
            region=name,
            segment=twin.model.body(twin.model.geom_bodyid[strike.geom]).name,
            velocity=float(np.linalg.norm(strike.velocity)),
            peak=twin.hit(trajectory, strike, regions[name]),
            bound=compute_bound(setup, trajectory, strike.time, {name: regions[name]}),
        )


def compute_bound(setup: Setup, trajectory: Trajectory, time: float, region: Mapping[str, RegionTable]) -> float:
    """Return the report's force bound [N] for one time and region."""
    assert setup.impacts is not None
    angles, velocities, _ = trajectory.sample(np.array([time]))
    return float(setup.impacts.survey(angles, velocities, force_rows(region)).values[0, 0])


class CollidingTwin:
    """MuJoCo twin that meets a ball while it follows a motion."""

    def __init__(self, setup: Setup) -> None:
        """Build the twin without contacts between its own segments.

        Args:
            setup: robot.
        """
        self._robot = setup.robot
        self.model = build_model(setup.robot)
        self.model.opt.timestep = SIMULATION_STEP
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        self._data = mujoco.MjData(self.model)
        self._order = find_joint_indices(setup.robot, self.model)
        self._motors = find_actuator_indices(setup.robot, self.model)
        self._lags = tracking_lags(setup.robot.drives)

    @cached_property
    def _capsules(self) -> list[int]:
        """Indices of the capsules of both arms."""
        model = self.model
        names = [model.body(body).name for body in model.geom_bodyid]
        is_capsule = model.geom_type == int(mujoco.mjtGeom.mjGEOM_CAPSULE)
        return [k for k, name in enumerate(names) if is_capsule[k] and any(part in name for part in ARM_PARTS)]

    def choose(self, trajectory: Trajectory, chance: np.random.Generator) -> _Strike | None:
        """Choose a collision at random, or None for a slow point."""
        time = float(chance.uniform(trajectory.start, trajectory.end))
        geom = self._capsules[int(chance.integers(len(self._capsules)))]
        place = float(chance.choice([0.0, 1.0, chance.random()]))
        self._set(trajectory, time)
        start, end = self._axis(geom)
        jacobian = np.zeros((3, self.model.nv))
        point, body = start + place * (end - start), int(self.model.geom_bodyid[geom])
        mujoco.mj_jac(self.model, self._data, jacobian, None, point, body)
        velocity = jacobian @ self._data.qvel
        speed = float(np.linalg.norm(velocity))
        if speed < MIN_VELOCITY:
            return None
        axis = (end - start) / np.linalg.norm(end - start)
        normal = _unit(chance.normal(size=3)) + chance.uniform(0.0, MAX_BIAS) * velocity / speed
        inward = normal @ axis * (1.0 if place == 1.0 else -1.0) < 0.0
        if 0.0 < place < 1.0 or inward:  # the ball lies beside the cylinder
            normal -= (normal @ axis) * axis
        normal = _unit(normal)
        return _Strike(time, geom, place, normal, velocity) if velocity @ normal >= MIN_APPROACH * speed else None

    def hit(self, trajectory: Trajectory, strike: _Strike, region: RegionTable) -> float:
        """Simulate a collision, and return its largest force [N].

        The ball has the mass and the stiffness of `region`.
        """
        model, data, body = self.model, self._data, int(self.model.geom_bodyid[strike.geom])
        mujoco.mj_resetData(model, data)
        self._set(trajectory, strike.time)
        radius = float(model.geom_size[strike.geom][0])
        start, end = self._axis(strike.geom)
        ball = start + strike.place * (end - start) + (radius + BALL_RADIUS) * strike.normal
        ball_velocity, peak = np.zeros(3), 0.0
        for step in range(MAX_STEPS):
            if step % SETPOINT_STEPS == 0:
                angles, velocities, _ = trajectory.sample(np.array([strike.time + step * SIMULATION_STEP]))
                data.ctrl[self._motors] = angles[0] + self._lags * velocities[0]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            start, end = self._axis(strike.geom)
            nearest = _nearest_point(ball, start, end)
            gap = float(np.linalg.norm(ball - nearest))
            normal = (ball - nearest) / gap
            force = region.stiffness * max(0.0, radius + BALL_RADIUS - gap)
            peak = max(peak, force)
            data.qfrc_applied[:] = 0.0
            if force > 0.0:
                touched = nearest + radius * normal
                mujoco.mj_applyFT(model, data, -force * normal, np.zeros(3), touched, body, data.qfrc_applied)
            elif step > FREE_STEPS and peak > 0.0:
                break
            ball_velocity += force * normal / region.mass * SIMULATION_STEP
            ball = ball + ball_velocity * SIMULATION_STEP
            mujoco.mj_step(model, data)
        return peak

    def _set(self, trajectory: Trajectory, time: float) -> None:
        angles, velocities, _ = trajectory.sample(np.array([time]))
        self._data.qpos[self._order], self._data.qvel[self._order] = angles[0], velocities[0]
        mujoco.mj_forward(self.model, self._data)

    def _axis(self, geom: int) -> tuple[Floats, Floats]:
        """Return both ends (3,) [m] of a capsule's axis."""
        centre, half = self._data.geom_xpos[geom].copy(), float(self.model.geom_size[geom][1])
        along = half * self._data.geom_xmat[geom].reshape(3, 3)[:, 2]
        return centre - along, centre + along


def _unit(vector: Floats) -> Floats:
    return np.asarray(vector / np.linalg.norm(vector))


def _nearest_point(point: Floats, start: Floats, end: Floats) -> Floats:
    along = end - start
    place = np.clip((point - start) @ along / (along @ along), 0.0, 1.0)
    return np.asarray(start + place * along)
