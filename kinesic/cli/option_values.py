"""Values of command-line options that belong together, one type for each purpose."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class SpokenInput:
    """Text or recording to be spoken, and the kind of output."""

    text: str | None
    audio: Path | None  # WAV recording of the text
    words: Path | None  # file with the times of the recording's words
    to: str  # "performance" or "bml"


@dataclass(frozen=True)
class MetricsOutput:
    """Output options of benchmark metrics: JSON, plots, folder and overwriting."""

    as_json: bool
    plots: Path | None  # folder of the plots
    out: Path | None  # folder of the metrics
    force: bool


@dataclass(frozen=True)
class GesturePicture:
    """Options for pictures of gestures: turntable, line drawing, output file and overwriting."""

    turntable: bool
    drawn: bool  # whether the picture shows lines instead of surfaces
    out: Path
    force: bool


@dataclass(frozen=True)
class ShaftPhysics:
    """Physics that moves the shafts of simulated servos."""

    physics: str  # "servo": each motor alone; "twin": the robot's body
    twin: str  # servos of the twin, by name or TOML file
    by_hand: bool  # whether Enter turns the hinges
