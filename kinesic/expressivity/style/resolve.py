"""Resolves how a behaviour is moved: by the style, the block, the behaviour itself, and settings over them all.

Overall activation, how much movement there is, changes the parameters that make movement.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from kinesic.bml.block import Behaviour, Block, Manner, Modality
from kinesic.expressivity.style.style import MODALITIES, RANGES, WEIGHTS, Expressivity, Style, style_preset

# How far full activation goes from a parameter's value to the end of its range. An animated speaker moves wider,
# faster, with more force and away from the body; how a movement flows and how often it is repeated stay his own.
SHARES: Mapping[str, float] = {"spatial": 0.7, "temporal": 0.9, "power": 0.9, "openness": 0.3}
StyleSource = Literal["style", "block", "behaviour", "setting"]  # a later one wins, number by number


def fold_activation(manner: Expressivity) -> Expressivity:
    """Folds activation into the parameters that it raises or lowers, and leaves it 0.

    Each goes its share of the way to its upper end for an activation of 1, to its lower end for -1, in proportion
    between. It is monotone, stays inside the ranges, and is the identity at 0.

    Args:
        manner: as resolved.
    """
    changes = {
        name: _go_towards(getattr(manner, name), name, manner.activation * share) for name, share in SHARES.items()
    }
    return replace(manner, activation=0.0, **changes)


def _go_towards(value: float, name: str, share: float) -> float:
    """A share of the way to the upper end of a parameter's range; below 0 to the lower end."""
    least, most = RANGES[name]
    return value + share * (most - value) if share > 0 else value - share * (least - value)


@dataclass(frozen=True)
class ResolvedNumbers:
    """The numbers of one modality, and who said each."""

    expressivity: Expressivity
    sources: Mapping[str, StyleSource]  # parameter -> who said it


def resolve_numbers(style: Style, modality: Modality, block: Block, behaviour: Behaviour) -> ResolvedNumbers:
    """Resolves the numbers of a behaviour, each from the last source that says it.

    A preset that a document names is complete: it takes the place of everything before it.

    Args:
        style: of the performance.
        modality: that moves.
        block: of the behaviour.
        behaviour: whose own manner goes over that of its block.

    Raises:
        ConfigError: a manner names a preset that does not exist.
    """
    numbers = dict(vars(style.of(modality)))
    sources: dict[str, StyleSource] = dict.fromkeys(numbers, "style")
    layers: tuple[tuple[StyleSource, Manner], ...] = (
        ("block", block.manners.get(modality, Manner())),
        ("behaviour", behaviour.manner),
    )
    for source, manner in layers:
        said = {} if manner.style is None else dict(vars(style_preset(manner.style).of(modality)))
        said |= {name: value for name in RANGES if (value := getattr(manner, name)) is not None}
        numbers |= said
        sources |= dict.fromkeys(said, source)
    for setting in style.settings:
        if setting.concerns(modality):
            numbers[setting.parameter] = setting.value
            sources[setting.parameter] = "setting"
    return ResolvedNumbers(Expressivity(**numbers), sources)


def resolve_styles(style: Style, block: Block) -> Mapping[str, Style]:
    """Resolves the style of each behaviour of a block, with activation folded into the other numbers.

    Args:
        style: of the performance; the documents go over it, and its settings over them.
        block: whose behaviours are moved.

    Returns:
        Behaviour id -> style, whose settings are in force already.

    Raises:
        ConfigError: a manner names a preset that does not exist.
    """
    found: dict[Manner, Style] = {}  # behaviours that say nothing of their manner share one
    for behaviour in block.behaviours:
        if behaviour.manner not in found:
            found[behaviour.manner] = _resolve_style(style, block, behaviour)
    return {behaviour.id: found[behaviour.manner] for behaviour in block.behaviours}


def _resolve_style(style: Style, block: Block, behaviour: Behaviour) -> Style:
    manners = {
        modality: fold_activation(resolve_numbers(style, modality, block, behaviour).expressivity)
        for modality in MODALITIES
    }
    whole_body, effort = (_weight(name, style, block, behaviour) for name in WEIGHTS)
    return Style(style.name, settings=(), whole_body=whole_body, effort=effort, **manners)


def _weight(name: str, style: Style, block: Block, behaviour: Behaviour) -> float:
    """A weight of the style as a whole: a setting's, else that of the preset which a document names last."""
    named = (behaviour.manner.style, block.manners.get("gesture", Manner()).style)
    presets = [] if any(setting.parameter == name for setting in style.settings) else [*filter(None, named)]
    weight: float = getattr(style_preset(presets[0]) if presets else style, name)
    return weight
