import pytest

from kinesic.hardware.supervisor.settings import SupervisorSettings
from kinesic.hardware.supervisor.torque import watchdog_counts


@pytest.mark.parametrize(
    "changes", [{"period": 0.0}, {"watchdog": 0.01}, {"watchdog": 3.0}, {"pace": -1.0}, {"wary": 0.0}]
)
def test_figures_that_make_no_sense_are_refused(changes: dict[str, float]):
    with pytest.raises(ValueError, match="must be"):
        SupervisorSettings(**changes)


def test_a_watchdog_is_never_shorter_than_asked():
    assert [watchdog_counts(seconds) for seconds in (0.1, 0.2, 0.101, 0.02)] == [5, 10, 6, 1]
