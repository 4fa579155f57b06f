"""Style: the manner in which a whole performance is moved, and how a document overrides it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import msgspec

from kinesic.bml.block import Manner
from kinesic.body.config import ConfigError, closest, locate, read

RANGES: Mapping[str, tuple[float, float]] = {
    "spatial": (-1.0, 1.0),
    "temporal": (-1.0, 1.0),
    "fluidity": (-1.0, 1.0),
    "power": (-1.0, 1.0),
    "tension": (-1.0, 1.0),
    "repetition": (-1.0, 1.0),
    "openness": (0.0, 1.0),
}


class StyleTable(msgspec.Struct, forbid_unknown_fields=True):
    """A file in `configs/styles/`: every parameter, so that a reader sees the whole manner."""

    spatial: float
    temporal: float
    fluidity: float
    power: float
    tension: float
    repetition: float
    openness: float


@dataclass(frozen=True)
class Style:
    """Expressivity parameters (thesis 8.7; Hartmann's spatial, temporal, fluidity, power, repetition)."""

    name: str = "neutral"
    spatial: float = 0.0  # -1 tight .. 1 wide
    temporal: float = 0.0  # -1 slow .. 1 fast
    fluidity: float = 0.0  # -1 jerky .. 1 flowing
    power: float = 0.0  # -1 weak .. 1 forceful
    tension: float = 0.0  # -1 loose .. 1 tense
    repetition: float = 0.0  # -1 single .. 1 repeated strokes
    openness: float = 0.0  # 0 elbows at the body .. 1 elbows away from it

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")

    @classmethod
    def load(cls, name: str | Path = "neutral") -> "Style":
        """Reads a style by its name in `configs/styles/`, or from a TOML file.

        Raises:
            ConfigError: there is no such style, or its file is wrong.
        """
        path = locate("style", name)
        try:
            return cls(path.stem, **msgspec.structs.asdict(read(path, StyleTable)))
        except ValueError as error:
            raise error if isinstance(error, ConfigError) else ConfigError(f"{path}: {error}") from None

    def changed(self, settings: Iterable[str]) -> "Style":
        """The style with single parameters set by texts such as `power=0.8`.

        Raises:
            ConfigError: a text is not of this form, names no parameter, or its value is out of range.
        """
        changes = dict(_setting(text) for text in settings)
        try:
            return self._with(changes)
        except ValueError as error:
            raise ConfigError(str(error)) from None

    def under(self, manner: Manner) -> "Style":
        """The style of one behaviour: what its document says, and this style where it says nothing.

        Documents use ranges of their own (an openness of 5 occurs), so their values are clipped to ours. The
        manner's intensity is no parameter of style.
        """
        asked = {name: getattr(manner, name) for name in RANGES if getattr(manner, name) is not None}
        return self._with({name: min(max(value, RANGES[name][0]), RANGES[name][1]) for name, value in asked.items()})

    def _with(self, changes: Mapping[str, float]) -> "Style":
        """The style with some parameters changed."""
        return Style(self.name, **{name: changes.get(name, getattr(self, name)) for name in RANGES})


def _setting(text: str) -> tuple[str, float]:
    """`power=0.8` as name and value."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not equals:
        raise ConfigError(f"{text!r} is no setting of a style; write it as NAME=VALUE, such as power=0.8")
    if name not in RANGES:
        raise ConfigError(f"a style has no {name}{closest(name, list(RANGES))}")
    try:
        return name, float(value)
    except ValueError:
        raise ConfigError(f"{name} is {value!r}, not a number; such as {name}=0.8") from None
