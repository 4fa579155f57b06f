"""Stand-in for rosbridge with a robot, written from the protocol's text; it imports nothing of kinesic."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import isfinite

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

FIELDS = {  # message type -> field -> kind
    "time": {"sec": int, "nanosec": int},
    "header": {"stamp": "time", "frame_id": str},
    "point": {
        **{name: [float] for name in ("positions", "velocities", "accelerations", "effort")},
        "time_from_start": "time",
    },
    "sensor_msgs/msg/JointState": {
        "header": "header",
        "name": [str],
        **{name: [float] for name in ("position", "velocity", "effort")},
    },
    "trajectory_msgs/msg/JointTrajectory": {"header": "header", "joint_names": [str], "points": ["point"]},
    "goal": {"trajectory": "trajectory_msgs/msg/JointTrajectory", "goal_time_tolerance": "time"},
}
CANCELLED, SUCCEEDED, ABORTED = 5, 4, 6  # action_msgs/msg/GoalStatus


def find_mismatch(value: object, kind: object) -> str | None:
    """Return why a value is no message of a kind, or None."""
    if isinstance(kind, list):
        if not isinstance(value, list):
            return f"{value} is no list"
        return next((fault for item in value if (fault := find_mismatch(item, kind[0]))), None)
    if isinstance(kind, str):
        if not isinstance(value, dict):
            return f"{value} is no message"
        if unknown := value.keys() - FIELDS[kind].keys():
            return f"{kind} has no field {sorted(unknown)[0]}"
        return next((fault for name in value if (fault := find_mismatch(value[name], FIELDS[kind][name]))), None)
    if kind is float:
        return None if isinstance(value, float) and isfinite(value) else f"{value} is no float64"
    return None if type(value) is kind else f"{value} is no {kind}"


class Robot:
    """Robot behind the bridge: a controller of joints that are reported on /joint_states."""

    def __init__(self, joints: dict[str, float]) -> None:
        self.joints = joints  # reported positions by name
        self.reports_states = True
        self.performs_goals = True  # whether a goal has a result
        self.fault: dict | None = None  # result of each goal, instead of success
        self.sessions = 0  # number of connected clients
        self._operations: list[dict] = []
        self._changed = threading.Condition()

    @property
    def operations(self) -> list[dict]:
        """Operations of all clients, once these have disconnected."""
        with self._changed:
            assert self._changed.wait_for(lambda: self.sessions == 0, 10.0)
            return self._operations

    @property
    def published(self) -> list[dict]:
        """Published messages."""
        return [operation["msg"] for operation in self.operations_of("publish")]

    def operations_of(self, kind: str) -> list[dict]:
        return [operation for operation in self.operations if operation["op"] == kind]

    def add(self, operation: dict) -> None:
        self._operations.append(operation)

    def connect(self, *_: object) -> None:
        """Count a client before it is connected."""
        with self._changed:
            self.sessions += 1

    def disconnect(self) -> None:
        """Count a client no longer, after its last operation."""
        with self._changed:
            self.sessions -= 1
            self._changed.notify_all()

    def judge_goal(self, goal: dict) -> dict:
        """Return the values of the result of a goal, as a trajectory controller does."""
        trajectory = goal["trajectory"]
        times = [p["time_from_start"]["sec"] + 1e-9 * p["time_from_start"]["nanosec"] for p in trajectory["points"]]
        if set(trajectory["joint_names"]) != set(self.joints):
            return {"error_code": -2, "error_string": "joints differ from those of the controller"}
        sizes = {len(p[key]) for p in trajectory["points"] for key in ("positions", "velocities", "accelerations")}
        if sizes != {len(self.joints)} or times != sorted(set(times)) or times[0] <= 0:
            return {"error_code": -1, "error_string": "points do not fit together"}
        return self.fault or {"error_code": 0, "error_string": ""}


class _Session:
    """Operations of one client."""

    def __init__(self, connection: ServerConnection, robot: Robot) -> None:
        self._connection, self._robot = connection, robot
        self._types: dict[str, str] = {}  # advertised topic -> type

    def run(self) -> None:
        with suppress(ConnectionClosed):
            for text in self._connection:
                self._perform(json.loads(text))
        self._robot.disconnect()

    def _perform(self, operation: dict) -> None:
        self._robot.add(operation)
        match operation["op"]:
            case "advertise" if operation["type"] in FIELDS:
                self._types[operation["topic"]] = operation["type"]
            case "publish" if operation["topic"] in self._types:
                if fault := find_mismatch(operation["msg"], self._types[operation["topic"]]):
                    self._refuse(fault)
            case "subscribe" if self._robot.reports_states:
                for name, position in self._robot.joints.items():  # one message for each joint
                    message = {"header": {}, "name": [name], "position": [position], "velocity": [], "effort": []}
                    self._send({"op": "publish", "topic": operation["topic"], "msg": message})
            case "send_action_goal":
                self._judge(operation)
            case "unsubscribe" | "subscribe" | "cancel_action_goal":
                pass
            case other:
                self._refuse(f"{other}: unknown, or its topic is not advertised")

    def _judge(self, operation: dict) -> None:
        if fault := find_mismatch(operation["args"], "goal"):
            self._refuse(fault)
        elif self._robot.performs_goals:
            values = self._robot.judge_goal(operation["args"])
            works = values["error_code"] == 0
            result = {"values": values, "status": SUCCEEDED if works else ABORTED, "result": works}
            self._send({"op": "action_feedback", "id": operation["id"], "action": operation["action"], "values": {}})
            self._send({"op": "action_result", "id": operation["id"], "action": operation["action"], **result})

    def _refuse(self, reason: str) -> None:
        self._send({"op": "status", "level": "error", "msg": reason})

    def _send(self, operation: dict) -> None:
        self._connection.send(json.dumps(operation))


@contextmanager
def running_bridge(robot: Robot) -> Iterator[str]:
    """Run a server until the end of the context, and yield its address."""
    with serve(
        lambda connection: _Session(connection, robot).run(), "127.0.0.1", 0, process_request=robot.connect
    ) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        finally:
            server.shutdown()
            thread.join()
