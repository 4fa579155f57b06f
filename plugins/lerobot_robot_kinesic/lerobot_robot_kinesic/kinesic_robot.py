"""Robot of kinesic that LeRobot drives by joint positions."""

import time
from threading import Event, Lock, Thread

import numpy as np
from lerobot.robots import Robot

from kinesic.body.robot import Robot as Model
from kinesic.hardware.servos import Servos
from kinesic.sim.twin import Twin
from lerobot_robot_kinesic.config_kinesic_robot import KinesicRobotConfig
from lerobot_robot_kinesic.follower import Follower

AHEAD = 0.1  # [s] by which commands are sent to the servos in advance
LOOP_PERIOD = 0.02  # [s] between two groups of commands
MAX_TWIN_LOG = 1000  # commands after which the twin forgets its measurements
SUFFIX = ".pos"  # suffix of joint positions in LeRobot


class KinesicRobot(Robot):
    """Robot whose servos or twin follow joint positions in degrees."""

    config_class = KinesicRobotConfig
    name = "kinesic"

    def __init__(self, config: KinesicRobotConfig) -> None:
        """Read the robot's description; nothing moves."""
        super().__init__(config)
        self.config = config
        self._model = Model.load(config.robot)
        self._joints = self._model.source_joints
        self._count = len(self._joints.hinges)
        self._follower = Follower(self._model, config.velocity)
        self._sink: Servos | Twin | None = None
        self._lock, self._ended, self._failure = Lock(), Event(), ""

    @property
    def observation_features(self) -> dict[str, type]:
        """Name and type of each measured position."""
        return {f"{name}{SUFFIX}": float for name in self._joints.names[: self._count]}

    @property
    def action_features(self) -> dict[str, type]:
        """Name and type of each position of an action."""
        return self.observation_features

    @property
    def is_connected(self) -> bool:
        """Whether the robot follows actions."""
        return self._sink is not None

    @property
    def is_calibrated(self) -> bool:
        """True: kinesic keeps the calibration next to the robot's file."""
        return True

    def calibrate(self) -> None:
        """Do nothing; `kinesic servos calibrate` calibrates."""

    def configure(self) -> None:
        """Do nothing; the supervisor of the servos configures them."""

    def connect(self, calibrate: bool = True) -> None:
        """Open the servos or the twin and move to the rest posture.

        Raises:
            ConnectionError: the robot is connected already.
        """
        if self._sink is not None:
            raise ConnectionError(f"{self} is already connected")
        self._follower = Follower(self._model, self.config.velocity)
        self._ended, self._failure = Event(), ""
        self._sink = Servos(self._model, self.config.ports) if self.config.ports else Twin(self._model)
        self._thread = Thread(target=self._follow, daemon=True)
        self._thread.start()

    def get_observation(self) -> dict[str, float]:
        """Return the measured position of each joint [degrees].

        Raises:
            ConnectionError: the robot is not connected, or its servos have ended.
        """
        sink = self._connected()
        with self._lock:
            angles = sink.positions()
        return self._named(angles)

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        """Set target positions [degrees] and return them clipped to the ranges.

        Joints that the action does not name keep their targets.

        Raises:
            ConnectionError: the robot is not connected, or its servos have ended.
            ValueError: the robot has no joint of a name, or a value is not finite.
        """
        self._connected()
        values = {key.removesuffix(SUFFIX): float(value) for key, value in action.items()}
        names = self._joints.names[: self._count]
        if unknown := [name for name in values if name not in names]:
            raise ValueError(f"{self._model.name} has no joint {unknown[0]!r}; its joints: {', '.join(names)}")
        with self._lock:
            target = np.array(self._follower.target)
            for hinge, name in enumerate(names):
                if name in values:
                    degrees = np.radians(np.array([values[name]]))
                    target[hinge] = self._joints.hinge_angles(hinge, name, degrees)[0]
            return self._named(self._follower.aim(target))

    def disconnect(self) -> None:
        """Fold the robot to rest and switch torque off."""
        self._ended.set()
        sink, self._sink = self._sink, None
        if sink is not None:
            self._thread.join()
            sink.close()

    def _connected(self) -> Servos | Twin:
        if self._sink is None or self._failure:
            raise ConnectionError(f"{self} is not connected; {self._failure or 'call connect first'}")
        return self._sink

    def _named(self, angles: np.ndarray) -> dict[str, float]:
        """Return hinge angles [rad] as joint positions [degrees] by feature."""
        degrees = np.degrees(self._joints.joint_angles(angles)[: self._count])
        return dict(zip(self.observation_features, degrees.tolist(), strict=True))

    def _follow(self) -> None:
        """Send commands until the end or a failure of the servos."""
        start, count = time.monotonic(), 0
        ahead = AHEAD if self.config.ports else 0.0
        while not self._ended.wait(LOOP_PERIOD):
            with self._lock:
                sink = self._sink
                if sink is None:
                    return
                for command in self._follower.commands(time.monotonic() - start + ahead):
                    try:
                        sink.write(command)
                    except OSError as error:  # BusError: the supervisor has ended
                        self._failure = str(error)
                        return
                    count += 1
                    if isinstance(sink, Twin) and count % MAX_TWIN_LOG == 0:
                        sink.forget()
