"""Totals of a campaign, whose finished groups are recorded in a journal."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from kinesic.tasks.engine import Engine
from kinesic.tasks.journal import Journal, run_once
from kinesic.tasks.processes import WorkerCrash
from kinesic.tasks.program import program_version
from tests.campaign.groups import GroupResult, prepare
from tests.campaign.judge import CONTACT, QUANTITIES

Task = tuple[int, int]  # seed of the campaign, number of the group


@dataclass
class Totals:
    """Sums of the results of all groups."""

    groups: int = 0
    blocks: int = 0
    refused: int = 0
    merges: int = 0
    seconds: float = 0.0  # [s] CPU time
    motion: float = 0.0  # [s] duration of all judged motions
    violations: int = 0
    penetrations: int = 0
    exceptions: int = 0
    largest: dict[str, float] = field(default_factory=lambda: dict.fromkeys((*QUANTITIES, CONTACT), 0.0))
    robots: dict[str, int] = field(default_factory=dict)  # number of blocks by robot
    failures: list[str] = field(default_factory=list)

    def add(self, task: Task, result: GroupResult | WorkerCrash) -> None:
        """Add the result of a group.

        The crash of a worker counts as an exception.
        """
        name = f"--seed {task[0]} --only {task[1]}"
        self.groups += 1
        if isinstance(result, WorkerCrash):
            self.exceptions += 1
            self.failures.append(f"{name}: {result.reason}")
            return
        for key in ("blocks", "refused", "merges", "seconds", "motion", "violations", "penetrations"):
            setattr(self, key, getattr(self, key) + getattr(result, key))
        self.largest = {key: max(value, result.largest[key]) for key, value in self.largest.items()}
        self.robots[result.robot] = self.robots.get(result.robot, 0) + result.blocks
        self.failures += [f"{name}: {failure}" for failure in result.failures]

    @property
    def failed(self) -> int:
        """Number of violations, penetrations and exceptions."""
        return self.violations + self.penetrations + self.exceptions

    def lines(self) -> Iterator[str]:
        """Yield the rows of a Markdown table."""
        yield "| quantity | value |"
        yield "|---|---|"
        yield f"| groups | {self.groups} |"
        yield f"| planned blocks | {self.blocks} ({', '.join(f'{n} {k}' for k, n in sorted(self.robots.items()))}) |"
        yield f"| blocks refused with a message | {self.refused} |"
        yield f"| blocks merged into a running motion | {self.merges} |"
        yield f"| judged motion | {self.motion / 3600:.1f} h |"
        yield f"| CPU time | {self.seconds:.0f} s |"
        yield f"| motions beyond a limit | {self.violations} |"
        yield f"| motions with self-contact | {self.penetrations} |"
        yield f"| exceptions | {self.exceptions} |"
        yield f"| largest value / limit | {', '.join(f'{key} {value:.4f}' for key, value in self.largest.items())} |"


def run_campaign(tasks: Iterable[Task], engine: Engine, path: Path | None, report: Callable[[Totals], None]) -> Totals:
    """Run groups of blocks that the journal does not contain yet.

    Args:
        tasks: groups.
        engine: workers.
        path: journal of finished groups; None: nothing is recorded.
        report: called with the totals after every group.
    """
    totals, version = Totals(), program_version()
    keys = {task: f"{task[0]} {task[1]} {version}" for task in tasks}
    journal = None if path is None else Journal(path, GroupResult)
    for task, result in run_once(
        keys,
        lambda left: engine.run(left, prepare, preload="tests.campaign.groups"),
        journal,
        keep=lambda _, result: result,
        forgets=False,
    ):
        totals.add(task, result)
        report(totals)
    return totals
