"""A sink of one's own: anything with `write` and `close` follows the commands of the loop."""

from kinesic import Performer
from kinesic.body.command import Command
from kinesic.body.config import CONFIGS


class Ticker:
    """Prints where the right elbow is sent, four times a second."""

    def __init__(self, joint: int) -> None:
        self.joint = joint

    def write(self, command: Command, /) -> None:
        if round(100 * command.time) % 25 == 0:
            angle, goal = command.angles[self.joint], command.goals[self.joint]
            print(f"{command.time:5.2f} s  elbow {angle:5.2f} rad, goal {goal:5.2f}")

    def close(self) -> None:
        print("done")


performer = Performer()
elbow = performer.robot.skeleton.joint("r_elbow_flexion")
print(performer.perform(CONFIGS / "bml" / "welcome.bml", sinks=[Ticker(elbow)]))
