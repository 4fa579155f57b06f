import pytest

from kinesic.hardware.supervisor.settings import DEFAULT_SETTINGS, SupervisorSettings
from kinesic.hardware.supervisor.torque import watchdog_counts


@pytest.mark.parametrize(
    "changes", [{"period": 0.0}, {"watchdog": 0.01}, {"watchdog": 3.0}, {"pace": -1.0}, {"wary": 0.0}]
)
def test_invalid_supervisor_settings_are_refused(changes: dict[str, float]):
    with pytest.raises(ValueError, match="must be"):
        SupervisorSettings(**changes)


def test_watchdog_register_value_is_the_requested_duration_rounded_up():
    assert [watchdog_counts(seconds) for seconds in (0.1, 0.2, 0.101, 0.02)] == [5, 10, 6, 1]


def test_default_emergency_stop_is_shorter_than_the_watchdog_time_and_other_stops():
    settings = DEFAULT_SETTINGS
    assert settings.quick < settings.watchdog  # or servos would stop by themselves
    assert settings.quick < settings.wary < settings.slow < settings.lead
