"""The options of planning, each once: a keyword of `kinesic.Performer`, and an option of the command line."""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypedDict, get_args

from kinesic.bml.block import RANGES, Dialect
from kinesic.body.choices import Gathering, GrammarName, VoiceName
from kinesic.body.config import ConfigError, suggestion

if TYPE_CHECKING:
    from kinesic.body.arrays import Floats

SET_HELP = (
    "One number of the manner, over documents too, -1 to 1: power=0.8 of all modalities, head.power=0.8 of one; "
    f"of {', '.join(RANGES)} (openness 0 to 1). Repeat for more."
)
VOICE_HELP = "Who speaks: espeak is heard, durations is silent; auto takes espeak where it is installed."
CHARACTER_HELP = "Which of several characters the robot is; without it, the one that a block is for, or the first."
IDLE_HELP = "How much breath, sway, drift of held hands, glances and blinks: 0 none, 1 a little, 2 twice as much."
VARIATION_HELP = "How far gestures differ from one another: 0 not at all, 1 as a person's, 2 twice as far."
GRAMMAR_HELP = "Who finds phrases and clauses of English text: spacy parses it, and needs the extra text."
PAUSE_HELP = "Longest pause before a word for which the body would be late, unless documents say otherwise."


@dataclass(frozen=True)
class Offer:
    """How the command line offers an option of planning."""

    help: str
    default: str | int | float | None = None
    kind: type = str  # of its value
    flag: str = ""  # where it is not the option's name
    metavar: str | None = None
    many: bool = False  # it may be repeated
    show_default: bool = False
    most: float = inf  # of a number, which is 0 at least


class PlanningOptions(TypedDict, total=False):
    """How documents are planned, beside robot and style; in the order in which help lists them."""

    # single numbers of the manner, over documents too: {"head.power": 0.8}, or as the command line has them
    settings: Annotated[
        Mapping[str, float] | Sequence[str], Offer(SET_HELP, flag="--set", metavar="NAME=VALUE", many=True)
    ]
    lexicon: Annotated[str | Path | None, Offer("Gestures: TOML, or Greta's gestuary XML.", kind=Path)]
    dialect: Annotated[Dialect | Literal["auto"], Offer("How documents are read.", "auto")]
    gather: Annotated[Gathering, Offer("How frames fill up.", "complex")]
    idle: Annotated[float, Offer(IDLE_HELP, 1.0, float, show_default=True, most=2.0)]
    variation: Annotated[float, Offer(VARIATION_HELP, 1.0, float, show_default=True, most=2.0)]
    seed: Annotated[int, Offer("Of everything random.", 0, int, show_default=True)]
    voice: Annotated[VoiceName, Offer(VOICE_HELP, "auto")]  # in Python "durations": the same on every machine
    pause: Annotated[float, Offer(PAUSE_HELP, 0.0, float, metavar="SECONDS", most=60.0)]  # [s]
    # by name, or a file of them
    targets: Annotated[
        "str | Path | Mapping[str, Sequence[float] | Floats] | None",
        Offer("TOML of named points in the world [m].", kind=Path),
    ]
    character: Annotated[str | None, Offer(CHARACTER_HELP, metavar="NAME")]
    language: Annotated[str, Offer("Of plain text: en, de, es, fr, ja.", "en", show_default=True)]
    grammar: Annotated[GrammarName, Offer(GRAMMAR_HELP, "rules")]
    intentions: Annotated[str | Path | None, Offer("Greta's lexicon of intentions (XML), for FML and text.", kind=Path)]
    baseline: Annotated[str | Path | None, Offer("Greta's baseline (XML): how the agent moves in FML.", kind=Path)]
    qualifiers: Annotated[str | Path | None, Offer("Greta's qualifiers (XML): how intentions change it.", kind=Path)]


LIVELY: PlanningOptions = {"idle": 1.0, "variation": 1.0}  # as the front door and the command line have it

CHOICES: Mapping[str, tuple[str, ...]] = {
    "dialect": ("auto", *get_args(Dialect)),
    "gather": get_args(Gathering),
    "voice": get_args(VoiceName),
    "grammar": get_args(GrammarName),
}


def offers() -> dict[str, Offer]:
    """Lists every option of planning as the command line offers it."""
    return {name: get_args(hint)[-1] for name, hint in PlanningOptions.__annotations__.items()}


def check_options(options: PlanningOptions) -> None:
    """Checks names and values of options.

    Raises:
        ConfigError: a value is none of the choices, or out of range; says what would have worked.
        TypeError: there is no such option.
    """
    known = PlanningOptions.__annotations__
    for name, value in options.items():
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1)
            hint = f"did you mean {near[0]}?" if near else f"known: {', '.join(known)}"
            raise TypeError(f"a performer has no option {name}; {hint}")
        if name in CHOICES and value not in CHOICES[name]:
            raise ConfigError(f"{name} is {value!r}{suggestion(str(value), CHOICES[name])}")
        if (most := offers()[name].most) < inf and not (isinstance(value, int | float) and 0.0 <= value <= most):
            unit = " seconds" if name == "pause" else ""
            raise ConfigError(f"{name} is {value!r}; it must be from 0 to {most:g}{unit}")
    seed = options.get("seed", 0)
    if not (isinstance(seed, int) and seed >= 0):
        raise ConfigError(f"seed is {seed!r}; it must be a whole number, 0 or more")
