"""Style: the manner in which a performance is moved, modality by modality, and how it passes the keys of a motion."""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Literal, get_args

import msgspec

from kinesic.bml.block import RANGES, Modality
from kinesic.body.config import ConfigError, locate, names_of, read_toml, suggestion
from kinesic.motion.easing import Easing
from kinesic.motion.keys import ACCENT, EVEN, LATE_ACCENT, SOFTEST, STEEPEST, KeyPassage

__all__ = [
    "MODALITIES",
    "NEUTRAL",
    "RANGES",
    "Expressivity",
    "Modality",
    "Phase",
    "Setting",
    "Style",
    "passage_of",
    "style_preset",
]

MODALITIES: tuple[Modality, ...] = get_args(Modality)
Phase = Literal["preparation", "stroke", "hold", "retraction"]

WEIGHTS: Mapping[str, tuple[float, float]] = {  # of a style as a whole, whatever moves
    "whole_body": (0.0, 2.0),  # of what the body does beside the hands
    "effort": (0.0, 1.0),  # of what each phase of a gesture gets by what the gesture is
}

FORCE = 1.5  # steepness that a power of 1 adds: what servos can still follow on the short ways of strokes
GATHERED = 3.0  # exponent of power and tension: half of them forces much less than half
BIG = 0.5  # power from which on a hand overshoots its accent, and power and tension from which on it bounces
QUICK = 0.68  # of an accent: so much of its steepness makes OutBack as fast as the accent alone
LEAST_LATE = 2.5  # steepness of an accent at the end of a way that neither weakness nor looseness takes away
BIAS = 0.25  # of a power of 1: the hand goes on a little the way it came


@dataclass(frozen=True)
class Expressivity:
    """The numbers of one modality (thesis 8.7; Hartmann's spatial, temporal, fluidity, power, repetition, activation).

    Raises:
        ValueError: a number outside its range, which is named.
    """

    spatial: float = 0.0  # -1 tight .. 1 wide
    temporal: float = 0.0  # -1 slow .. 1 fast
    fluidity: float = 0.0  # -1 jerky .. 1 flowing
    power: float = 0.0  # -1 weak .. 1 forceful
    tension: float = 0.0  # -1 loose .. 1 tense
    repetition: float = 0.0  # -1 single .. 1 repeated strokes
    activation: float = 0.0  # -1 passive .. 1 animated: how much movement there is
    openness: float = 0.0  # 0 elbows at the body .. 1 elbows away from it

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise ValueError(f"{name} is {value:g}, outside [{least:g}, {most:g}]")


NEUTRAL = Expressivity()  # as the lexicon has it


@dataclass(frozen=True)
class Setting:
    """One number that wins over every document, of one modality or of all."""

    parameter: str
    value: float
    modality: Modality | None = None  # None: all

    def __str__(self) -> str:
        return (
            f"{self.modality}.{self.parameter}={self.value:g}" if self.modality else f"{self.parameter}={self.value:g}"
        )

    def concerns(self, modality: Modality) -> bool:
        """Whether it is about a modality."""
        return self.parameter not in WEIGHTS and self.modality in (None, modality)


class PartTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a modality of a style does differently."""

    spatial: float | None = None
    temporal: float | None = None
    fluidity: float | None = None
    power: float | None = None
    tension: float | None = None
    repetition: float | None = None
    activation: float | None = None
    openness: float | None = None


class StyleTable(msgspec.Struct, forbid_unknown_fields=True):
    """A file in `configs/styles/`: every parameter of all modalities, and what single ones do differently."""

    spatial: float
    temporal: float
    fluidity: float
    power: float
    tension: float
    repetition: float
    activation: float
    openness: float
    gesture: PartTable = PartTable()
    head: PartTable = PartTable()
    torso: PartTable = PartTable()
    face: PartTable = PartTable()
    whole_body: float = 1.0  # what head, trunk, shoulders and face do beside the hands, 0 nothing .. 2 twice as much
    effort: float = 1.0  # of the profile that gives each phase its time and force, 0 nothing .. 1 all of it

    def expressivity(self, modality: Modality) -> Expressivity:
        """Joins the numbers of one modality."""
        own = msgspec.structs.asdict(getattr(self, modality))
        return Expressivity(**{name: getattr(self, name) if own[name] is None else own[name] for name in RANGES})


@dataclass(frozen=True)
class Style:
    """A manner for each modality, and what of it no document may change."""

    name: str = "neutral"
    gesture: Expressivity = NEUTRAL
    head: Expressivity = NEUTRAL
    torso: Expressivity = NEUTRAL
    face: Expressivity = NEUTRAL
    settings: tuple[Setting, ...] = ()  # in force already; told again after the documents
    whole_body: float = 1.0  # 0 gestures are the hands' alone .. 2 the body does twice its part
    effort: float = 1.0  # 0 every phase has what the servos do at ease .. 1 what people give it

    @classmethod
    def load(cls, name: str | Path = "neutral") -> "Style":
        """Reads a style by its name in `configs/styles/`, or from a TOML file.

        Raises:
            ConfigError: there is no such style, or its file is wrong.
        """
        path = locate("style", name)
        table = read_toml(path, StyleTable)
        found: dict[Modality, Expressivity] = {}
        for modality in MODALITIES:
            try:
                found[modality] = table.expressivity(modality)
            except ValueError as error:
                raise ConfigError(f"{path}: {error}") from None
        for name, (least, most) in WEIGHTS.items():
            if not least <= (weight := getattr(table, name)) <= most:
                raise ConfigError(f"{path}: {name} is {weight:g}, outside [{least:g}, {most:g}]")
        return cls(path.stem, settings=(), whole_body=table.whole_body, effort=table.effort, **found)

    @classmethod
    def uniform(cls, manner: Expressivity, name: str = "own") -> "Style":
        """Makes a style of which all modalities have the same numbers."""
        return cls(name, manner, manner, manner, manner)

    def of(self, modality: Modality) -> Expressivity:
        """Looks up the numbers of one modality."""
        found: Expressivity = getattr(self, modality)
        return found

    def changed(self, settings: Iterable[str]) -> "Style":
        """Sets single numbers by texts such as `power=0.8` or `head.power=0.8`, the last one winning.

        Raises:
            ConfigError: a text is not of this form, names no parameter, or its value is out of range.
        """
        style = self
        for setting in map(_setting, settings):
            concerned = [part for part in MODALITIES if setting.concerns(part)]
            parts = {part: replace(style.of(part), **{setting.parameter: setting.value}) for part in concerned}
            whole_body, effort = (
                setting.value if setting.parameter == name else getattr(style, name) for name in WEIGHTS
            )
            said = (*style.settings, setting)
            style = Style(style.name, settings=said, whole_body=whole_body, effort=effort, **(style._parts | parts))
        return style

    @property
    def _parts(self) -> dict[Modality, Expressivity]:
        return {part: self.of(part) for part in MODALITIES}

    def numbers(self) -> Mapping[Modality, Mapping[str, float]]:
        """Lists all numbers by modality and name."""
        return {modality: asdict(self.of(modality)) for modality in MODALITIES}


@cache
def style_preset(name: str) -> Style:
    """Reads a style of `configs/styles/` once, and no other file, whoever names it.

    Raises:
        ConfigError: there is no such style.
    """
    if name not in (known := names_of("style")):
        raise ConfigError(f"no style {name}{suggestion(name, known)}")
    return Style.load(name)


def passage_of(
    manner: Expressivity, phase: Phase, *, accent: float = 0.0, late: bool = False, swing: float = 0.0
) -> KeyPassage:
    """Derives how the keys of a phase are passed (tension, continuity, bias, easing) from an expressivity.

    Tension is the spline's tension, fluidity f its continuity c = (f - 1) / 2. On the way to a stroke and in it power
    and tension force the hand beyond its accent: it begins steeply, overshoots a little and comes back to its key in
    time; where both are big it bounces (thesis 8.7). Weakness takes the accent away, then keeps an even speed. No
    time changes. A late accent keeps what a word needs, whatever takes accents away, and gives way to a bounce alone.

    Args:
        manner: of the behaviour.
        phase: that the way to the key belongs to.
        accent: steepness that a stroke has by itself, beyond the softest.
        late: whether an accent lies at the end of the way, not at its beginning.
        swing: of the key.
    """
    passed = KeyPassage(manner.tension, (manner.fluidity - 1.0) / 2.0, swing=swing)
    if phase not in ("preparation", "stroke"):
        return passed
    power, tension, weakness = (max(0.0, value) for value in (manner.power, manner.tension, -manner.power))
    force, left = FORCE * power**GATHERED + tension**GATHERED, accent * (1.0 - weakness) - weakness
    if late and min(power, tension) < BIG and accent > 0.0:
        left = max(left, LEAST_LATE * min(accent, 1.0)) + force
        return replace(passed, bias=BIAS * power, easing=LATE_ACCENT, steepness=min(SOFTEST + left, STEEPEST))
    if force > 0.0:
        easing, kept = _forced(power, tension, accent)
        steepness = SOFTEST + kept * max(left, 0.0) + force
        return replace(passed, bias=BIAS * power, easing=easing, steepness=min(steepness, STEEPEST))
    if left < 0.0:
        return replace(passed, easing="linear", steepness=EVEN - (STEEPEST - EVEN) * left)
    return replace(passed, easing=ACCENT, steepness=min(SOFTEST + left, STEEPEST)) if left > 0.0 else passed


def _forced(power: float, tension: float, accent: float) -> tuple[Easing, float]:
    """Finds the easing of a forced way, and the share of an accent that it keeps: more power never peaks lower."""
    if min(power, tension) >= BIG:
        return "out_bounce", 1.0
    if accent > 0.0 and tension <= 0.0 and power < BIG:
        return ACCENT, 1.0
    return "out_back", QUICK + (1.0 - QUICK) * min(max(power - BIG, tension) / BIG, 1.0)


def _setting(text: str) -> Setting:
    place, equals, written = (part.strip() for part in text.partition("="))
    if not equals:
        raise ConfigError(f"{text!r} is no setting of a style; write it as NAME=VALUE, such as power=0.8")
    part, point, name = place.rpartition(".")
    modality = next((known for known in MODALITIES if known == part), None)
    if point and modality is None:
        raise ConfigError(f"a style has no modality {part!r}{suggestion(part, MODALITIES)}")
    ranges = RANGES if point else {**RANGES, **WEIGHTS}
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
