"""What the keyboard changes in the window of the face."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from kinesic.body.action_units import UNITS, channels
from kinesic.body.choices import Variant
from kinesic.face.assets.mesh import VARIANTS
from kinesic.face.render.presets import PRESETS

INTENSITY_STEP = 0.1  # of an intensity
CAMERA_TURN = 15.0  # [deg] of the camera
NUMBERS = tuple(UNITS)
HELP = (
    "1 2 3: preset; left, right: action unit; up, down: its intensity; 0: none by hand; w: wrinkles; v: variant; "
    "comma, period: from the side; escape: close"
)


@dataclass(frozen=True)
class Controls:
    """Everything that a person can change while looking."""

    preset: str = "normal"
    variant: Variant = "female"
    unit: int = 12  # that up and down change
    units: Mapping[int, float] = field(default_factory=dict)  # set by hand, 0..1
    gain: float = 1.0  # of the wrinkles
    yaw_deg: float = 0.0
    shut: bool = False  # the window is to be closed

    def pressed(self, key: str) -> "Controls":
        """Gives the controls after a key; those after an unknown one are the same.

        Args:
            key: its name: `1`, `left`, `escape`.
        """
        if key.isdigit() and 1 <= int(key) <= len(PRESETS):
            return replace(self, preset=list(PRESETS)[int(key) - 1])
        match key:
            case "left" | "right":
                place = NUMBERS.index(self.unit) + (1 if key == "right" else -1)
                return replace(self, unit=NUMBERS[place % len(NUMBERS)])
            case "up" | "down":
                value = self.units.get(self.unit, 0.0) + (INTENSITY_STEP if key == "up" else -INTENSITY_STEP)
                return replace(self, units={**self.units, self.unit: min(max(round(value, 3), 0.0), 1.0)})
            case "0":
                return replace(self, units={})
            case "w":
                return replace(self, gain=0.0 if self.gain else 1.0)
            case "v":
                return replace(self, variant=VARIANTS[1 - VARIANTS.index(self.variant)])
            case "comma" | "period":
                return replace(self, yaw_deg=self.yaw_deg + (CAMERA_TURN if key == "comma" else -CAMERA_TURN))
            case "escape" | "q":
                return replace(self, shut=True)
        return self

    def over(self, units: Mapping[str, float]) -> Mapping[str, float]:
        """Gives what is shown: the command's units, and what a person set where that is stronger."""
        found = dict(units)
        for number, value in self.units.items():
            for channel in channels(number):
                found[channel] = max(found.get(channel, 0.0), value)
        return found

    @property
    def title(self) -> str:
        """What the title of the window says."""
        return f"kinesic: {self.preset}, {self.unit} {UNITS[self.unit].name} {self.units.get(self.unit, 0.0):.1f}"
