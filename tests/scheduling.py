"""Which process runs which file of tests: what waits for a clock runs beside what calculates.

`make test` starts one process more than there are processors. Two thirds of what tests in real time take is waiting, so
they get a process of their own while there are any; the others calculate, and step back where both want a processor.
"""

import os
from functools import cache
from pathlib import Path

import pytest
from xdist.scheduler import LoadFileScheduling
from xdist.workermanage import WorkerController

CLOCK_WORKER = "gw0"
STEP_BACK = 10  # of niceness


@cache
def waits(file: Path) -> bool:
    """Whether a file has tests in real time."""
    return "mark.realtime" in file.read_text(encoding="utf-8")


class ClockBesideCalculation(LoadFileScheduling):
    """Files in order, each process those of its kind first."""

    def _assign_work_unit(self, node: WorkerController) -> None:
        clock, root = node.gateway.id == CLOCK_WORKER, Path(self.config.rootpath)
        mine = next((file for file in self.workqueue if waits(root / file) == clock), None)
        if mine is not None:
            self.workqueue.move_to_end(mine, last=False)
        super()._assign_work_unit(node)


def step_back(config: pytest.Config) -> None:
    """Lets a process that calculates give way to those that keep time."""
    worker = getattr(config, "workerinput", {}).get("workerid", CLOCK_WORKER)
    if worker != CLOCK_WORKER:
        os.nice(STEP_BACK)
