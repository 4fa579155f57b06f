"""Write your own sink: a class with `write` and `close` receives all commands."""

from kinesic import Performer
from kinesic.body.command import Command
from kinesic.body.config import CONFIGS


class Ticker:
    """Sink that prints angle and setpoint of the right elbow at 4 Hz."""

    def __init__(self, joint: int) -> None:
        self.joint = joint

    def write(self, command: Command, /) -> None:
        if round(100 * command.time) % 25 == 0:
            angle, setpoint = command.angles[self.joint], command.setpoints[self.joint]
            print(f"{command.time:5.2f} s  elbow {angle:5.2f} rad, setpoint {setpoint:5.2f}")

    def close(self) -> None:
        print("done")


performer = Performer()
elbow = performer.robot.skeleton.joint("r_elbow_flexion")
print(performer.perform(CONFIGS / "bml" / "welcome.bml", sinks=[Ticker(elbow)]))
