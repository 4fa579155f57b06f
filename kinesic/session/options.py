"""Planning options of `kinesic.Performer` and of the command line."""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TypedDict, get_args

from kinesic.bml.block import EXPRESSIVITY_RANGES, Dialect
from kinesic.body.choices import (
    Audience,
    GesturePreference,
    GrammarName,
    KeyFrameFilling,
    MappingTrust,
    VoiceName,
)
from kinesic.body.config import ConfigError, suggestion
from kinesic.intent.reading.language import ENGLISH_TAG, check_tag

if TYPE_CHECKING:
    from kinesic.body.arrays import Floats
    from kinesic.speech.engines.phrase import SpeechEngine

SET_HELP = (
    "Style parameter, -1 to 1, which also overrides documents: power=0.8 for all modalities, head.power=0.8 for one. "
    f"Parameters: {', '.join(EXPRESSIVITY_RANGES)} (openness 0 to 1). Repeat the option to set several."
)
LIBRARY_HELP = "Folder of imported or installed gestures, in addition to --lexicon."
PREFER_HELP = "Source of the beats, offers and deictics for a text: the lexicon or captured gestures."
VOICE_HELP = "Voice: hibari and espeak are audible, durations is silent; auto: hibari for English, else espeak."
ENGINE_HELP = "Program that speaks instead of the voice, on standard input and output: 'python my_voice.py'."
RECORDINGS_HELP = "Folder with the recordings of documents that are not files, such as those sent to `serve`."
CHARACTER_HELP = "Character that the robot plays in a block for several; default: the block's own, or the first."
IDLE_HELP = "Amount of breath, sway, drift of held hands, glances and blinks: 0 none, 1 a little, 2 twice as much."
PROSODY_HELP = (
    "Amount of brows, nods, blinks and lip opening that follow the voice: 0 none, 1 like a person's. "
    "Default is that of --idle."
)
VARIATION_HELP = "Variation between gestures: 0 none, 1 like a person's, 2 twice as large."
GRAMMAR_HELP = "Parser of English phrases and clauses: spacy needs kinesic[text]."
PAUSE_HELP = "Longest pause added before a word so that a gesture arrives in time, unless documents set another."
MAPPING_HELP = "Imported robots that perform: checked needs a confidence of 0.6 in the joint mapping, any does not."
NEAR_HELP = "People near the robot, whose limits of contacts planned motion keeps; default: [audience] of the robot."


@dataclass(frozen=True)
class CliOption:
    """Command-line form of a planning option: flag, type, range and help."""

    help: str
    default: str | int | float | None = None
    kind: type = str  # Python type of the value
    flag: str = ""  # command-line flag such as --set; empty: derived from the name of the option
    metavar: str | None = None
    many: bool = False  # whether the option may be repeated
    show_default: bool = False
    most: float = inf  # upper limit of a number; the lower limit is 0


class PlanningOptions(TypedDict, total=False):
    """Planning options besides robot and style, in the order of `--help`."""

    # style parameters that override documents: {"head.power": 0.8}, or texts of the command line
    settings: Annotated[
        Mapping[str, float] | Sequence[str], CliOption(SET_HELP, flag="--set", metavar="NAME=VALUE", many=True)
    ]
    lexicon: Annotated[str | Path | None, CliOption("Gestures: TOML, a folder of TOML, or Greta's XML.", kind=Path)]
    library: Annotated[str | Path | None, CliOption(LIBRARY_HELP, kind=Path, metavar="FOLDER")]
    prefer: Annotated[GesturePreference, CliOption(PREFER_HELP, "lexicon")]
    dialect: Annotated[Dialect | Literal["auto"], CliOption("Dialect of the documents.", "auto")]
    gather: Annotated[
        KeyFrameFilling, CliOption("Interpolation of body parts that have no key at a key frame.", "complex")
    ]
    idle: Annotated[float, CliOption(IDLE_HELP, 1.0, float, show_default=True, most=2.0)]
    # None: as idle
    prosody: Annotated[float | None, CliOption(PROSODY_HELP, None, float, most=2.0)]
    variation: Annotated[float, CliOption(VARIATION_HELP, 1.0, float, show_default=True, most=2.0)]
    seed: Annotated[int, CliOption("Seed of all random numbers.", 0, int, show_default=True)]
    voice: Annotated[VoiceName, CliOption(VOICE_HELP, "auto", show_default=True)]  # `set_up` uses "durations"
    # own engine that speaks in place of the voice, or the command that runs it
    engine: Annotated["SpeechEngine | str | None", CliOption(ENGINE_HELP, metavar="COMMAND")]
    pause: Annotated[float, CliOption(PAUSE_HELP, 0.0, float, metavar="SECONDS", most=60.0)]  # [s]
    # positions by name, or a file of them
    targets: Annotated[
        "str | Path | Mapping[str, Sequence[float] | Floats] | None",
        CliOption("TOML of named points in the world [m].", kind=Path),
    ]
    character: Annotated[str | None, CliOption(CHARACTER_HELP, metavar="NAME")]
    language: Annotated[str, CliOption("Language of plain text, such as en-GB, pt-BR or zh.", "en", show_default=True)]
    grammar: Annotated[GrammarName, CliOption(GRAMMAR_HELP, "rules")]
    intentions: Annotated[
        str | Path | None, CliOption("Greta's lexicon of intentions (XML), for FML and text.", kind=Path)
    ]
    baseline: Annotated[
        str | Path | None, CliOption("Greta's baseline (XML): movement style of the agent in FML.", kind=Path)
    ]
    qualifiers: Annotated[
        str | Path | None, CliOption("Greta's qualifiers (XML): changes of the baseline by intentions.", kind=Path)
    ]
    recordings: Annotated[str | Path | None, CliOption(RECORDINGS_HELP, kind=Path, metavar="FOLDER")]
    near: Annotated[Audience | None, CliOption(NEAR_HELP)]  # None: as in the robot's file
    mapping: Annotated[MappingTrust, CliOption(MAPPING_HELP, "checked", show_default=True)]


# Defaults of `Performer` and of the command line; `set_up` has no variation, no idle motion and a silent voice.
INTERACTIVE_DEFAULTS: PlanningOptions = {"idle": 1.0, "variation": 1.0, "voice": "auto"}

OPTION_CHOICES: Mapping[str, tuple[str, ...]] = {
    "dialect": ("auto", *get_args(Dialect)),
    "gather": get_args(KeyFrameFilling),
    "prefer": get_args(GesturePreference),
    "voice": get_args(VoiceName),
    "grammar": get_args(GrammarName),
    "near": get_args(Audience),
    "mapping": get_args(MappingTrust),
}


def list_cli_options() -> dict[str, CliOption]:
    """Return the command-line form of every planning option."""
    return {name: get_args(hint)[-1] for name, hint in PlanningOptions.__annotations__.items()}


def check_options(options: PlanningOptions) -> None:
    """Check the names and values of planning options.

    Raises:
        ConfigError: a value is not among the choices or out of range; the message names valid values.
        TypeError: the option is unknown.
    """
    option_names = PlanningOptions.__annotations__
    for name, value in options.items():
        if name not in option_names:
            near = difflib.get_close_matches(name, option_names, n=1)
            hint = f"did you mean {near[0]}?" if near else f"known: {', '.join(option_names)}"
            raise TypeError(f"a performer has no option {name}; {hint}")
        if value is None and name == "near":
            continue
        if name in OPTION_CHOICES and value not in OPTION_CHOICES[name]:
            raise ConfigError(f"{name} is {value!r}{suggestion(str(value), OPTION_CHOICES[name])}")
        if value is None and name == "prosody":
            continue
        if (most := list_cli_options()[name].most) < inf and not (
            isinstance(value, int | float) and 0.0 <= value <= most
        ):
            unit = " seconds" if name == "pause" else ""
            raise ConfigError(f"{name} is {value!r}; use 0 to {most:g}{unit}")
    check_tag(options.get("language", ENGLISH_TAG))
    seed = options.get("seed", 0)
    if not (isinstance(seed, int) and seed >= 0):
        raise ConfigError(f"seed is {seed!r}; use a whole number, 0 or more")
