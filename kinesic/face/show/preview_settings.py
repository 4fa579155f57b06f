"""Initial settings of a face preview."""

from dataclasses import dataclass
from pathlib import Path

from kinesic.body.choices import Variant
from kinesic.face.render.effects import Effects

NO_EFFECTS = Effects()


@dataclass(frozen=True)
class PreviewSettings:
    """Initial settings of a face preview."""

    variant: Variant = "female"
    preset: str = "normal"
    side: int = 512  # [pixels] width and height of the picture
    windowed: bool = True
    gain: float = 1.0  # gain of the wrinkles
    light: float = 1.0  # brightness factor of the scene
    yaw_deg: float = 0.0
    beside: Path | None = None  # film of the body on the clock of the performance, shown next to the face
    effects: Effects = NO_EFFECTS  # changes of rendering effects in any preset
