"""Resolve expressivity parameters from style, block, behaviour and settings.

Overall activation scales the parameters that produce movement.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from kinesic.bml.block import Behaviour, Block, Manner, Modality
from kinesic.expressivity.style.style import (
    EXPRESSIVITY_RANGES,
    MODALITIES,
    WEIGHT_RANGES,
    Expressivity,
    Style,
    style_preset,
)

# Fraction of the distance to the end of a parameter's range that full activation covers. An animated speaker moves
# wider, faster, with more force and away from the body; fluidity and repetition do not change.
ACTIVATION_FRACTIONS: Mapping[str, float] = {"spatial": 0.7, "temporal": 0.9, "power": 0.9, "openness": 0.3}
StyleSource = Literal["style", "block", "behaviour", "setting"]  # later sources override earlier ones per parameter


def fold_activation(manner: Expressivity) -> Expressivity:
    """Apply the activation to other parameters, then set activation to zero.

    At activation 1 each parameter moves its fraction of the distance to its upper limit, at -1 to its lower limit, in
    proportion between. The map is monotone, stays inside the ranges, and is the identity at 0.

    Args:
        manner: resolved parameters.
    """
    changes = {
        name: _move_towards(getattr(manner, name), name, manner.activation * fraction)
        for name, fraction in ACTIVATION_FRACTIONS.items()
    }
    return replace(manner, activation=0.0, **changes)


def _move_towards(value: float, name: str, fraction: float) -> float:
    """Move a value a fraction of the distance to its range limit.

    A positive fraction moves it to the upper limit, a negative one to the lower.
    """
    least, most = EXPRESSIVITY_RANGES[name]
    return value + fraction * (most - value) if fraction > 0 else value - fraction * (least - value)


@dataclass(frozen=True)
class ResolvedNumbers:
    """Resolved parameters of one modality, with the origin of each value."""

    expressivity: Expressivity
    sources: Mapping[str, StyleSource]  # parameter -> source of its value


def resolve_numbers(style: Style, modality: Modality, block: Block, behaviour: Behaviour) -> ResolvedNumbers:
    """Resolve each parameter to the last source that sets it.

    A preset that a document names is complete: it replaces all earlier sources.

    Args:
        style: of the performance.
        modality: that moves.
        block: of the behaviour.
        behaviour: its own parameters override those of its block.

    Raises:
        ConfigError: a behaviour or block names a preset that does not exist.
    """
    numbers = dict(vars(style.of(modality)))
    sources: dict[str, StyleSource] = dict.fromkeys(numbers, "style")
    layers: tuple[tuple[StyleSource, Manner], ...] = (
        ("block", block.manners.get(modality, Manner())),
        ("behaviour", behaviour.manner),
    )
    for source, manner in layers:
        values = {} if manner.style is None else dict(vars(style_preset(manner.style).of(modality)))
        values |= {name: value for name in EXPRESSIVITY_RANGES if (value := getattr(manner, name)) is not None}
        numbers |= values
        sources |= dict.fromkeys(values, source)
    for setting in style.settings:
        if setting.concerns(modality):
            numbers[setting.parameter] = setting.value
            sources[setting.parameter] = "setting"
    return ResolvedNumbers(Expressivity(**numbers), sources)


def resolve_styles(style: Style, block: Block) -> Mapping[str, Style]:
    """Resolve the style of each behaviour of a block, with activation applied.

    Args:
        style: of the performance; documents override it, and its settings override documents.
        block: with the behaviours.

    Returns:
        Behaviour id -> style, with the settings already applied.

    Raises:
        ConfigError: a behaviour or block names a preset that does not exist.
    """
    styles: dict[Manner, Style] = {}  # behaviours with equal parameters use the same style
    for behaviour in block.behaviours:
        if behaviour.manner not in styles:
            styles[behaviour.manner] = _resolve_style(style, block, behaviour)
    return {behaviour.id: styles[behaviour.manner] for behaviour in block.behaviours}


def _resolve_style(style: Style, block: Block, behaviour: Behaviour) -> Style:
    manners = {
        modality: fold_activation(resolve_numbers(style, modality, block, behaviour).expressivity)
        for modality in MODALITIES
    }
    whole_body, posture, effort = (_weight(name, style, block, behaviour) for name in WEIGHT_RANGES)
    return Style(
        style.name,
        **manners,
        settings=(),
        whole_body=whole_body,
        effort=effort,
        posture=posture,
        standing=style.standing,
        prefers=style.prefers,
    )


def _weight(name: str, style: Style, block: Block, behaviour: Behaviour) -> float:
    """Resolve one of a behaviour's style weights, such as `whole_body`.

    A setting has precedence over the innermost preset of the document, and that over the performance's style.
    """
    named = (behaviour.manner.style, block.manners.get("gesture", Manner()).style)
    presets = [] if any(setting.parameter == name for setting in style.settings) else [*filter(None, named)]
    weight: float = getattr(style_preset(presets[0]) if presets else style, name)
    return weight
