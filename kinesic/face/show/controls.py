"""Keyboard controls of the face window."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from kinesic.body.action_units import ACTION_UNITS, unit_channels
from kinesic.body.choices import Variant
from kinesic.face.assets.mesh import FACE_VARIANTS
from kinesic.face.render.presets import QUALITY_PRESETS

INTENSITY_STEP = 0.1  # change of an action unit's intensity per key press
CAMERA_TURN = 15.0  # [deg] rotation of the camera per key press
UNIT_NUMBERS = tuple(ACTION_UNITS)  # action units that the keyboard can select
KEY_HELP = (
    "1 2 3: preset; left, right: action unit; up, down: its intensity; 0: none by hand; w: wrinkles; v: variant; "
    "comma, period: from the side; escape: close"
)


@dataclass(frozen=True)
class Controls:
    """Settings of the face window that keys change."""

    preset: str = "normal"
    variant: Variant = "female"
    unit: int = 12  # action unit changed by up and down
    units: Mapping[int, float] = field(default_factory=dict)  # manual intensities, 0..1
    gain: float = 1.0  # gain of the wrinkles
    yaw_deg: float = 0.0
    is_closing: bool = False  # whether to close the window

    def press(self, key: str) -> "Controls":
        """Return the window's settings after a key press.

        Unknown keys change nothing.

        Args:
            key: name of the key: `1`, `left`, `escape`.
        """
        if key.isdigit() and 1 <= int(key) <= len(QUALITY_PRESETS):
            return replace(self, preset=list(QUALITY_PRESETS)[int(key) - 1])
        match key:
            case "left" | "right":
                place = UNIT_NUMBERS.index(self.unit) + (1 if key == "right" else -1)
                return replace(self, unit=UNIT_NUMBERS[place % len(UNIT_NUMBERS)])
            case "up" | "down":
                value = self.units.get(self.unit, 0.0) + (INTENSITY_STEP if key == "up" else -INTENSITY_STEP)
                return replace(self, units={**self.units, self.unit: min(max(round(value, 3), 0.0), 1.0)})
            case "0":
                return replace(self, units={})
            case "w":
                return replace(self, gain=0.0 if self.gain else 1.0)
            case "v":
                return replace(self, variant=FACE_VARIANTS[1 - FACE_VARIANTS.index(self.variant)])
            case "comma" | "period":
                return replace(self, yaw_deg=self.yaw_deg + (CAMERA_TURN if key == "comma" else -CAMERA_TURN))
            case "escape" | "q":
                return replace(self, is_closing=True)
        return self

    def merge_units(self, units: Mapping[str, float]) -> Mapping[str, float]:
        """Combine a command's action units with manual action units by maximum."""
        channels = dict(units)
        for number, value in self.units.items():
            for channel in unit_channels(number):
                channels[channel] = max(channels.get(channel, 0.0), value)
        return channels

    @property
    def title(self) -> str:
        """Title of the face window."""
        return (
            f"kinesic: {self.preset}, {self.unit} {ACTION_UNITS[self.unit].name} {self.units.get(self.unit, 0.0):.1f}"
        )
