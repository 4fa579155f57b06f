import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

pytestmark = pytest.mark.realtime

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_each_example_program_runs_and_prints(path, capsys, monkeypatch):
    monkeypatch.setattr(sys, "argv", [str(path)])
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_each_example_program_is_short_and_has_a_title(path):
    lines = path.read_text().splitlines()
    assert len(lines) < 40
    assert lines[0].startswith('"""')


def test_ros_example_publishes_the_positions_of_22_joints_on_a_topic(monkeypatch):
    sent = []
    node = SimpleNamespace(create_publisher=lambda kind, topic, depth: SimpleNamespace(publish=sent.append))
    ros = SimpleNamespace(init=lambda: None, shutdown=lambda: sent.append("shutdown"), create_node=lambda name: node)
    monkeypatch.setitem(sys.modules, "rclpy", ros)
    monkeypatch.setitem(sys.modules, "sensor_msgs", ModuleType("sensor_msgs"))
    monkeypatch.setitem(sys.modules, "sensor_msgs.msg", SimpleNamespace(JointState=SimpleNamespace))
    monkeypatch.setattr("time.sleep", lambda seconds: None)
    runpy.run_path(str(EXAMPLES[5]), run_name="__main__")
    assert sent.pop() == "shutdown"
    assert len(sent) > 1000
    assert all(len(message.position) == len(message.name) == 22 for message in sent)


def test_ros_launch_file_starts_rosbridge_and_then_the_controller_example(monkeypatch):
    def record(**attributes):
        return SimpleNamespace(**attributes)

    actions = SimpleNamespace(
        DeclareLaunchArgument=lambda name, default_value: name, ExecuteProcess=record, TimerAction=record
    )
    monkeypatch.setitem(sys.modules, "launch", SimpleNamespace(LaunchDescription=list))
    monkeypatch.setitem(sys.modules, "launch.actions", actions)
    monkeypatch.setitem(sys.modules, "launch.substitutions", SimpleNamespace(LaunchConfiguration=str.upper))
    monkeypatch.setitem(sys.modules, "launch_ros.actions", SimpleNamespace(Node=record))
    file = EXAMPLES[0].parent / "ros" / "perform.launch.py"
    *arguments, bridge, timer = runpy.run_path(str(file))["generate_launch_description"]()
    program, *values = timer.actions[0].cmd[1:]
    assert arguments == ["document", "robot", "address", "controller"]
    assert values == [name.upper() for name in arguments]
    assert bridge.package == "rosbridge_server"
    assert Path(program).name == "15_ros2_controller.py"
    assert Path(program).is_file()
