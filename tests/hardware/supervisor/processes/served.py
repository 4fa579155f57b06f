"""Program that serves virtual servos on pseudo-terminals and records them.

`python served.py ROBOT FOLDER [SECONDS]`: ports appear in FOLDER under the names of the buses. Lines on standard input
strike: `unplug BUS SECONDS`, `reboot BUS ID SECONDS`, `alert BUS ID BITS`; its end ends the program. Each line of
FOLDER/record is the plant's time on the machine's monotonic clock, whether each port is plugged in, then torque, goal,
watchdog and position of each servo; the next comes so many seconds later. After the line `show` the record is complete
until now, which a line on standard output tells.
"""

import os
import select
import sys
import time
from contextlib import suppress
from pathlib import Path

from kinesic.body.robot import Robot
from kinesic.hardware.protocol.registers import Register
from kinesic.hardware.virtual.faults import FaultPlan, PlannedFault
from kinesic.hardware.virtual.pty import PtyPort, serve_wires
from kinesic.hardware.virtual.wiring import build_bus, describe_cables

RECORDED_REGISTERS = (Register.TORQUE_ENABLE, Register.GOAL_POSITION, Register.BUS_WATCHDOG)
RECORD_INTERVAL = 0.004  # [s] default time between two recorded lines


def fault(kind: str, *figures: float) -> PlannedFault:
    if kind == "unplug":
        return PlannedFault("unplug", seconds=figures[0])
    return PlannedFault("reboot" if kind == "reboot" else "alert", (int(figures[0]),), value=figures[1])


def main(robot: str, folder: Path, every: float) -> None:
    with suppress(OSError):  # servos are never late, whatever else the machine does, where it allows that
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(30))
    plant, buses = build_bus(describe_cables(Robot.load(Path(robot))))
    ports = [PtyPort(bus, folder / name) for name, bus in buses.items()]
    began, written = time.monotonic(), 0.0
    with (folder / "record").open("w") as record:

        def show() -> None:
            rows = [
                [*(s.memory[r] for r in RECORDED_REGISTERS), s.electronics.present_position()] for s in plant.servos
            ]
            figures = [int(port.descriptor is not None) for port in ports] + [v for row in rows for v in row]
            record.write(f"{began + plant.time:.6f} " + " ".join(map(str, figures)) + "\n")

        def running() -> bool:
            nonlocal written
            if plant.time - written >= every:
                written = plant.time
                show()
            if not select.select([0], [], [], 0)[0]:
                return True
            line = os.read(0, 4096).decode()
            for words in map(str.split, line.splitlines()):
                if words == ["show"]:
                    show()
                    record.flush()
                    os.write(1, b"shown\n")
                    continue
                buses[words[1]].expose(FaultPlan((fault(words[0], *map(float, words[2:])),)))
            return bool(line)

        serve_wires(ports, running)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), float(sys.argv[3]) if sys.argv[3:] else RECORD_INTERVAL)
