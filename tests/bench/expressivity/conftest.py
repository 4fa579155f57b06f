"""The robot and the lexicon, as tests of expressivity have them."""

from ...expressivity.conftest import lexicon, limits, pace, robot  # noqa: F401  # fixtures
