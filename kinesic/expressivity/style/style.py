"""Style of a performance: expressivity per modality."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import get_args

import msgspec

from kinesic.bml.block import EXPRESSIVITY_RANGES, Modality
from kinesic.body.config import ConfigError, fit_schema, locate_config, names_of, parse_tables, read_toml, suggestion
from kinesic.body.html_view import NotebookView
from kinesic.expressivity.style.parameters import StyleParameter, list_parameters
from kinesic.expressivity.style.standing import NEUTRAL_STANDING, Standing, StandingTable

__all__ = [
    "EXPRESSIVITY_RANGES",
    "MODALITIES",
    "NEUTRAL_EXPRESSIVITY",
    "Expressivity",
    "Modality",
    "Setting",
    "Style",
    "style_preset",
]

MODALITIES: tuple[Modality, ...] = get_args(Modality)

WEIGHT_RANGES: Mapping[str, tuple[float, float]] = {  # smallest and largest style weights for all modalities
    "whole_body": (0.0, 2.0),  # of body motion that accompanies the hands
    "posture": (0.0, 2.0),  # of the standing posture, face and gaze
    "effort": (0.0, 1.0),  # of the effort profile that sets durations and accents by gesture category
}


@dataclass(frozen=True)
class Expressivity:
    """Expressivity parameters of one modality.

    They follow thesis 8.7 and Hartmann's spatial, temporal, fluidity, power, repetition and activation.

    Raises:
        ValueError: a named parameter is outside its range.
    """

    spatial: float = 0.0  # size of movements: -1 tight .. 1 wide
    temporal: float = 0.0  # duration of strokes and rate of the voice: -1 slow .. 1 fast
    fluidity: float = 0.0  # transitions between movements: -1 jerky .. 1 flowing
    power: float = 0.0  # acceleration of strokes: -1 weak .. 1 forceful
    tension: float = 0.0  # curvature at key poses: -1 loose .. 1 tense
    repetition: float = 0.0  # number of strokes: -1 single .. 1 repeated
    activation: float = 0.0  # size, speed, force and openness together: -1 passive .. 1 animated
    openness: float = 0.0  # elbows: 0 at the body .. 1 away from it

    def __post_init__(self) -> None:
        for name, (least, most) in EXPRESSIVITY_RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")


NEUTRAL_EXPRESSIVITY = Expressivity()  # expressivity that performs gestures exactly as the lexicon defines them


@dataclass(frozen=True)
class Setting:
    """A parameter value that overrides every document, for one modality or all."""

    parameter: str
    value: float
    modality: Modality | None = None  # None: all modalities

    def __str__(self) -> str:
        return (
            f"{self.modality}.{self.parameter}={self.value:g}" if self.modality else f"{self.parameter}={self.value:g}"
        )

    def concerns(self, modality: Modality) -> bool:
        """Return whether the setting changes a parameter of a modality.

        Settings of weights never do.
        """
        return self.parameter not in WEIGHT_RANGES and self.modality in (None, modality)


class PartTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of the parameters that one modality overrides."""

    spatial: float | None = None  # size of movements: -1 tight .. 1 wide
    temporal: float | None = None  # duration of strokes and rate of the voice: -1 slow .. 1 fast
    fluidity: float | None = None  # transitions between movements: -1 jerky .. 1 flowing
    power: float | None = None  # acceleration of strokes: -1 weak .. 1 forceful
    tension: float | None = None  # curvature at key poses: -1 loose .. 1 tense
    repetition: float | None = None  # number of strokes: -1 single .. 1 repeated
    activation: float | None = None  # size, speed, force and openness together: -1 passive .. 1 animated
    openness: float | None = None  # elbows: 0 at the body .. 1 away from it


class StyleTable(msgspec.Struct, forbid_unknown_fields=True):
    """TOML file of a style: common parameters, and exceptions for each modality."""

    spatial: float  # size of movements: -1 tight .. 1 wide
    temporal: float  # duration of strokes and rate of the voice: -1 slow .. 1 fast
    fluidity: float  # transitions between movements: -1 jerky .. 1 flowing
    power: float  # acceleration of strokes: -1 weak .. 1 forceful
    tension: float  # curvature at key poses: -1 loose .. 1 tense
    repetition: float  # number of strokes: -1 single .. 1 repeated
    activation: float  # size, speed, force and openness together: -1 passive .. 1 animated
    openness: float  # elbows: 0 at the body .. 1 away from it
    gesture: PartTable = PartTable()  # parameters that have other values for gestures
    head: PartTable = PartTable()  # parameters that have other values for the head
    torso: PartTable = PartTable()  # parameters that have other values for the torso
    face: PartTable = PartTable()  # parameters that have other values for the face
    whole_body: float = 1.0  # factor on accompanying motion of head, trunk, shoulders and face, 0 .. 2
    posture: float = 1.0  # factor on standing posture, face and gaze, 0 .. 2
    effort: float = 1.0  # weight of the profile that gives each phase its duration and force, 0 .. 1
    standing: StandingTable = StandingTable()  # posture, resting hands, facial affect and gaze habit
    prefers: dict[str, float] = {}  # factor on the probability of each named gesture when several gestures fit

    def expressivity(self, modality: Modality) -> Expressivity:
        """Return the expressivity of one modality."""
        changes = msgspec.structs.asdict(getattr(self, modality))
        values = {name: getattr(self, name) if changes[name] is None else changes[name] for name in EXPRESSIVITY_RANGES}
        return Expressivity(**values)


@dataclass(frozen=True)
class Style(NotebookView):
    """Expressivity of each modality, and settings that override documents."""

    name: str = "neutral"
    gesture: Expressivity = NEUTRAL_EXPRESSIVITY
    head: Expressivity = NEUTRAL_EXPRESSIVITY
    torso: Expressivity = NEUTRAL_EXPRESSIVITY
    face: Expressivity = NEUTRAL_EXPRESSIVITY
    settings: tuple[Setting, ...] = ()  # settings, applied already, and again after the values of a document
    whole_body: float = 1.0  # factor on accompanying body motion: 0 hands only .. 2 twice the usual amount
    effort: float = 1.0  # weight of the effort profile: 0 durations by Fitts' law .. 1 durations of people
    posture: float = 1.0  # factor on standing posture, face and gaze: 0 as neutral .. 2 twice as much
    standing: Standing = NEUTRAL_STANDING  # posture, resting hands, facial affect and gaze habit
    prefers: tuple[tuple[str, float], ...] = ()  # (gesture, factor on its probability among alternatives)

    @classmethod
    def load(cls, name: str | Path = "neutral") -> "Style":
        """Read a style by its name, or from a TOML file.

        Names are those of `configs/styles/`.

        Raises:
            ConfigError: no such style exists, or its file is invalid.
        """
        path = locate_config("style", name)
        return cls._of(read_toml(path, StyleTable), path)

    @classmethod
    def parse(cls, text: str, path: Path) -> "Style":
        """Read a style from the text of its file.

        Args:
            text: contents of the file.
            path: path of the file, for messages and for the name of the style.

        Raises:
            ConfigError: the text is invalid.
        """
        return cls._of(fit_schema(parse_tables(text, path), StyleTable, path), path)

    @classmethod
    def _of(cls, table: StyleTable, path: Path) -> "Style":
        """Return the style of a file's table.

        Raises:
            ConfigError: a value is out of range.
        """
        parameters: dict[Modality, Expressivity] = {}
        for modality in MODALITIES:
            try:
                parameters[modality] = table.expressivity(modality)
            except ValueError as error:
                raise ConfigError(f"{path}: {error}") from None
        for name, (least, most) in WEIGHT_RANGES.items():
            if not least <= (weight := getattr(table, name)) <= most:
                raise ConfigError(f"{path}: {name} is {weight:g}, outside [{least:g}, {most:g}]")
        return cls(
            path.stem,
            **parameters,
            settings=(),
            whole_body=table.whole_body,
            effort=table.effort,
            posture=table.posture,
            standing=Standing.of(table.standing),
            prefers=tuple(table.prefers.items()),
        )

    @classmethod
    def uniform(cls, manner: Expressivity, name: str = "own") -> "Style":
        """Return a style with the same expressivity for all modalities."""
        return cls(name, manner, manner, manner, manner)

    def __str__(self) -> str:
        """Return a one-line summary: name, parameters of gestures, settings."""
        values = [f"{name} {value:+g}" for name, value in asdict(self.gesture).items() if value]
        values += [f"set {setting}" for setting in self.settings]
        return f"style {self.name}: {', '.join(values) or 'all parameters of gestures 0'}"

    def __repr__(self) -> str:
        return f"<{self}>"

    def of(self, modality: Modality) -> Expressivity:
        """Return the expressivity of one modality."""
        expressivity: Expressivity = getattr(self, modality)
        return expressivity

    def changed(self, settings: Iterable[str]) -> "Style":
        """Apply settings such as `power=0.8` or `head.power=0.8` in order.

        Raises:
            ConfigError: a text is not of this form, names no parameter, or its value is out of range.
        """
        style = self
        for setting in map(_parse_setting, settings):
            concerned = [part for part in MODALITIES if setting.concerns(part)]
            parts = {part: replace(style.of(part), **{setting.parameter: setting.value}) for part in concerned}
            whole_body, posture, effort = (
                setting.value if setting.parameter == name else getattr(style, name) for name in WEIGHT_RANGES
            )
            all_settings = (*style.settings, setting)
            style = Style(
                style.name,
                **(style._parts | parts),
                settings=all_settings,
                whole_body=whole_body,
                effort=effort,
                posture=posture,
                standing=style.standing,
                prefers=style.prefers,
            )
        return style

    @property
    def _parts(self) -> dict[Modality, Expressivity]:
        return {part: self.of(part) for part in MODALITIES}

    @property
    def parameters(self) -> tuple[StyleParameter, ...]:
        """Each value of the style with its key, unit and effect.

        Modalities are listed only where they differ from gestures, postures where they differ from the rest posture.
        """
        weights = {name: getattr(self, name) for name in WEIGHT_RANGES}
        return list_parameters(self.numbers(), weights, self.standing, self.prefers)

    def numbers(self) -> Mapping[Modality, Mapping[str, float]]:
        """Return all parameter values by modality and name."""
        return {modality: asdict(self.of(modality)) for modality in MODALITIES}


@cache
def style_preset(name: str) -> Style:
    """Read a built-in style by name, cached.

    No other file can be read by this name.

    Raises:
        ConfigError: no such style exists.
    """
    if name not in (names := names_of("style")):
        raise ConfigError(f"no style {name}{suggestion(name, names)}")
    return Style.load(name)


def _parse_setting(text: str) -> Setting:
    place, equals, written = (part.strip() for part in text.partition("="))
    if not equals:
        raise ConfigError(f"{text!r} is not a style setting; write it as NAME=VALUE, such as power=0.8")
    part, point, name = place.rpartition(".")
    modality = next((modality for modality in MODALITIES if modality == part), None)
    if point and modality is None:
        raise ConfigError(f"a style has no modality {part!r}{suggestion(part, MODALITIES)}")
    ranges = EXPRESSIVITY_RANGES if point else {**EXPRESSIVITY_RANGES, **WEIGHT_RANGES}
    if name not in ranges:
        raise ConfigError(f"a style has no {name}{suggestion(name, list(ranges))}")
    try:
        value = float(written)
    except ValueError:
        raise ConfigError(f"{place} is {written!r}, not a number; such as {place}=0.8") from None
    least, most = ranges[name]
    if not least <= value <= most:
        raise ConfigError(f"{place} is {value:g}, outside [{least:g}, {most:g}]")
    return Setting(name, value, modality)
