"""A sink of one's own: anything with `write` and `close` follows the commands of the loop."""

from kinesic.body.command import RATE, Command
from kinesic.body.config import CONFIGS
from kinesic.controller.feedforward import lead
from kinesic.controller.perform import facts, plan
from kinesic.controller.play import command_times, commands, play


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


known = facts()
planned = plan((CONFIGS / "bml" / "welcome.bml").read_bytes(), known)
times = command_times(planned.duration)
setpoints = lead(planned.trajectory, times, known.robot, known.dynamics, period=1 / RATE)
elbow = known.robot.skeleton.joint("r_elbow_flexion")
play(commands(planned.trajectory, times, setpoints), Ticker(elbow))
