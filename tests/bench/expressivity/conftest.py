"""Fixtures of the robot and the lexicon for tests of expressivity benchmarks."""

from ...expressivity.conftest import lexicon, limits, pace, robot  # noqa: F401  # fixtures
