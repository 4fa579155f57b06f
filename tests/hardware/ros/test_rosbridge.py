"""Connection to a stand-in for rosbridge."""

import pytest

from kinesic.body.config import ConfigError
from kinesic.hardware.ros.rosbridge import Rosbridge

from .rosbridge import Robot


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("http://localhost", "must be a WebSocket address"),
        ("robot.local:9090", "must be a WebSocket address"),
        ("ws://127.0.0.1:9", r"no rosbridge answers: .*; start it \(ros2 launch rosbridge_server"),
    ],
)
def test_address_without_rosbridge_is_refused_with_the_remedy(address: str, reason: str):
    with pytest.raises(ConfigError, match=reason):
        Rosbridge(address)


def test_only_the_last_twenty_error_messages_are_kept(robot: Robot, address: str):
    bridge = Rosbridge(address)
    for k in range(25):
        bridge.send(f"operation {k}")
        bridge.receive(5.0)
    bridge.close()
    assert len(bridge.errors) == 20
    assert bridge.errors[0].startswith("operation 5: unknown")


def test_receive_returns_none_after_a_timeout(address: str):
    bridge = Rosbridge(address)
    assert bridge.receive(0.0) is None
    assert bridge.receive(-1.0) is None
    bridge.close()


def test_operation_on_a_closed_connection_names_the_address(address: str):
    bridge = Rosbridge(address)
    bridge.close()
    for operate in (lambda: bridge.send("publish"), lambda: bridge.receive(0.0)):
        with pytest.raises(ConfigError, match=f"{address}: the connection to rosbridge has ended"):
            operate()
