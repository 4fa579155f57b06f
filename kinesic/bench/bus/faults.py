"""The bus under faults: the fault matrix as figures, and as the table that sets other drivers beside.

Everything is in virtual time: the figures are those of wire, servos and driver, whatever the machine does meanwhile.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from kinesic.bench.figure import Figure
from kinesic.hardware.virtual import lerobot
from kinesic.hardware.virtual.drivers import KinesicDriver, SdkDriver
from kinesic.hardware.virtual.lerobot import LerobotDriver
from kinesic.hardware.virtual.matrix import PERIOD, FaultCase, Opens, TrialResult, cases, matrix, trial
from kinesic.hardware.virtual.matrix_table import record, text

SERVOS, BAUD, SEEDS = 14, 1_000_000, (0, 1, 2)
SIZES, BAUDS = (7, 14, 26), (57_600, 1_000_000, 4_000_000)  # of the whole matrix
FRESH, P99, TOLD, WRONG = 99.9, 1.0, 1.0, 0.0  # [%] at 1 % faults, [periods], [periods], [count]
DRIVERS: Mapping[str, Opens] = {
    KinesicDriver.name: KinesicDriver,
    SdkDriver.name: SdkDriver,
    LerobotDriver.name: LerobotDriver,
    f"{LerobotDriver.name}, 3 retries": partial(LerobotDriver, retries=3),
}
MISSING: Mapping[str, Callable[[], str]] = {name: lerobot.missing for name in DRIVERS if LerobotDriver.name in name}


def bench() -> list[Figure]:
    """Every fault for 14 servos at 1 Mbaud, the seeds together."""
    figures: list[Figure] = []
    for case in cases():
        found = [trial(case, KinesicDriver, servos=SERVOS, baud=BAUD, seed=seed) for seed in SEEDS]
        figures += _figures(case, found)
    return figures


def _figures(case: FaultCase, found: Sequence[TrialResult]) -> Iterator[Figure]:
    """What a fault must not do; a servo that must be refused has no other figures."""
    name = f"bus.fault.{_word(case.name)}"
    wrong = sum(result.exceptions + result.wrong for result in found)
    refused = next((result.refused for result in found if result.refused), "")
    yield Figure(
        f"{name}.wrong", wrong, "exceptions and wrong values", WRONG, "lower", why=refused and f"refused: {refused}"
    )
    if refused:
        return
    if "1%" in case.name:
        fresh = 100 * float(np.mean([result.fresh for result in found]))
        yield Figure(f"{name}.fresh", fresh, "%", FRESH, "higher")
    durations = np.concatenate([result.durations for result in found])
    yield Figure(f"{name}.p99", float(np.percentile(durations, 99)) / PERIOD, "periods", P99, "lower")
    told = [result.told for result in found if result.told is not None]
    if told:
        yield Figure(f"{name}.told", max(told) / PERIOD, "periods", TOLD, "lower")


def _word(name: str) -> str:
    return name.replace(" x ", "_").replace(" ", "_").replace("%", "")


@dataclass(frozen=True, eq=False)
class Fared:
    """How one driver fared in the whole matrix."""

    driver: str
    why: str  # it was not tried; empty where it was
    results: Sequence[TrialResult]

    def __str__(self) -> str:
        return f"{self.driver}\n\n{f'null: {self.why}' if self.why else text(self.results)}\n"

    def record(self) -> dict[str, object]:
        """For a machine to read."""
        return {"driver": self.driver, "why": self.why, "trials": [record(result) for result in self.results]}


def compare_drivers(
    *, sizes: Sequence[int] = SIZES, bauds: Sequence[int] = BAUDS, seeds: Sequence[int] = SEEDS
) -> Iterator[Fared]:
    """The whole matrix for every driver that is installed; it takes many minutes."""
    for name, opens in DRIVERS.items():
        why = MISSING.get(name, str)()
        yield Fared(name, why, [] if why else list(matrix(opens, sizes=sizes, bauds=bauds, seeds=seeds)))
