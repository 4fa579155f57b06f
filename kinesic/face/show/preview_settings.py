"""How a preview of the face begins."""

from dataclasses import dataclass
from pathlib import Path

from kinesic.body.choices import Variant
from kinesic.face.render.effects import Effects

UNCHANGED = Effects()


@dataclass(frozen=True)
class PreviewSettings:
    """How a preview begins."""

    variant: Variant = "female"
    preset: str = "normal"
    side: int = 512  # [pixels]
    windowed: bool = True
    gain: float = 1.0  # of the wrinkles
    light: float = 1.0  # of the scene, by the usual one
    yaw_deg: float = 0.0
    beside: Path | None = None  # a film of the body on the clock of the performance
    effects: Effects = UNCHANGED  # over the preset, whichever it is
