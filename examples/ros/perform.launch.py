"""Start rosbridge, then perform a document on the robot's trajectory controller.

ros2 launch perform.launch.py document:=welcome robot:=my.toml controller:=/arms
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, TimerAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

PROGRAM = Path(__file__).parent.parent / "15_ros2_controller.py"
DEFAULTS = {
    "document": "welcome",
    "robot": "op3",
    "address": "ws://localhost:9090",
    "controller": "/joint_trajectory_controller",
}
START_DELAY = 3.0  # [s] until rosbridge accepts connections


def generate_launch_description():
    """Return the description of the launch."""
    bridge = Node(package="rosbridge_server", executable="rosbridge_websocket")
    command = ["python3", str(PROGRAM), *map(LaunchConfiguration, DEFAULTS)]
    perform = TimerAction(period=START_DELAY, actions=[ExecuteProcess(cmd=command, output="screen")])
    arguments = [DeclareLaunchArgument(name, default_value=value) for name, value in DEFAULTS.items()]
    return LaunchDescription([*arguments, bridge, perform])
