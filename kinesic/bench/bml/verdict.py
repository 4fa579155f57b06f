"""What became of each expectation of a suite, and the figures of all of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from kinesic.bench.figure import Figure

GOAL = 0.97  # share of a suite that must pass


@dataclass(frozen=True)
class ExpectationVerdict:
    """One expectation."""

    suite: str
    name: str
    why: str = ""  # it failed; empty: passed

    @property
    def passed(self) -> bool:
        """Whether it holds."""
        return not self.why


def verdict_figures(verdicts: Sequence[ExpectationVerdict]) -> Iterator[Figure]:
    """For each suite how many pass and how many fail, and for each that fails why.

    Args:
        verdicts: of any suites.
    """
    for suite in dict.fromkeys(verdict.suite for verdict in verdicts):
        own = [verdict for verdict in verdicts if verdict.suite == suite]
        failed = [verdict for verdict in own if not verdict.passed]
        name = f"bml.{suite}"
        yield Figure(f"{name}.passed", len(own) - len(failed), f"of {len(own)}", GOAL * len(own), "higher")
        yield Figure(f"{name}.failed", len(failed), f"of {len(own)}", (1.0 - GOAL) * len(own), "lower")
        for verdict in failed:
            yield Figure(f"{name}.{verdict.name}", 0.0, "passed", 1.0, "higher", verdict.why)
