"""Who says how a behaviour is moved: the style, the block, the behaviour itself, and settings over them all."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Literal

from kinesic.bml.block import RANGES, Behaviour, Block, Manner, Modality
from kinesic.bml.reading.manner import modality_of
from kinesic.expressivity.style.activation import activated
from kinesic.expressivity.style.style import Expressivity, Style, preset

Source = Literal["style", "block", "behaviour", "setting"]  # a later one wins, number by number


@dataclass(frozen=True)
class Told:
    """The numbers of one modality as they were told, and by whom."""

    expressivity: Expressivity
    sources: Mapping[str, Source]  # parameter -> who said it


def told(style: Style, modality: Modality, block: Block, behaviour: Behaviour) -> Told:
    """The numbers of a behaviour, each from the last source that says it.

    A preset that a document names is complete: it takes the place of everything before it.

    Args:
        style: of the performance.
        modality: that moves.
        block: of the behaviour.
        behaviour: whose own manner goes over that of its block.

    Raises:
        ConfigError: a manner names a preset that does not exist.
    """
    numbers = asdict(style.of(modality))
    sources: dict[str, Source] = dict.fromkeys(numbers, "style")
    layers: tuple[tuple[Source, Manner], ...] = (
        ("block", block.manners.get(modality, Manner())),
        ("behaviour", behaviour.manner),
    )
    for source, manner in layers:
        said = {} if manner.style is None else asdict(preset(manner.style).of(modality))
        said |= {name: value for name in RANGES if (value := getattr(manner, name)) is not None}
        numbers |= said
        sources |= dict.fromkeys(said, source)
    for setting in style.settings:
        if setting.concerns(modality):
            numbers[setting.parameter] = setting.value
            sources[setting.parameter] = "setting"
    return Told(Expressivity(**numbers), sources)


def manner_of(style: Style, block: Block, behaviour: Behaviour, modality: Modality | None = None) -> Expressivity:
    """The manner of a behaviour, with activation folded into the other numbers.

    Args:
        style: of the performance.
        block: of the behaviour.
        behaviour: that is moved.
        modality: that moves; None is that of the behaviour.
    """
    return activated(told(style, modality or modality_of(behaviour.action) or "gesture", block, behaviour).expressivity)
