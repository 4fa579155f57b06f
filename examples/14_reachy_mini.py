"""Perform on a Reachy Mini: head, body and antennas follow a humanoid."""

from kinesic import Performer
from kinesic.body.config import CONFIGS, ConfigError
from kinesic.hardware.reachy_mini.sink import ReachyMini

performer = Performer()
try:
    sink = ReachyMini(performer.robot, "http://localhost:8000")
except ConfigError as error:
    print(f"skipped: {error}")
else:
    performer.perform(CONFIGS / "bml" / "welcome.bml", sinks=[sink])
    print(f"{sink.sent_count} targets sent, {len(sink.refusals)} refused")
