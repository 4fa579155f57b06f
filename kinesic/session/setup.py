"""Planning setups from robot, style, lexicon, voice and options."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Unpack

import numpy as np

from kinesic.body.arrays import Floats, sealed
from kinesic.body.config import ConfigError
from kinesic.body.impact_policy import find_policy
from kinesic.body.robot import Robot
from kinesic.expressivity.context import read_targets
from kinesic.expressivity.idle import Idling
from kinesic.expressivity.lexicon.gesture_collection import find_collections
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.expressivity.style.style import Style
from kinesic.expressivity.variation import Variation
from kinesic.hardware.protocol.servo_map import load_robot
from kinesic.planning.setup import IntentionFiles, Setup
from kinesic.planning.standing import standing_robot, vary_standing
from kinesic.session.mapping_check import check_mapping
from kinesic.session.options import PlanningOptions, check_options
from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.dynamics import MujocoDynamics
from kinesic.sim.impacts import RobotImpacts
from kinesic.speech.engines.phrase import SpeechEngine
from kinesic.speech.engines.program import EngineProgram
from kinesic.speech.voice import voice as make_voice


def set_up(
    robot: Robot | str | Path = "upper22", *, style: Style | str | Path = "neutral", **options: Unpack[PlanningOptions]
) -> Setup:
    """Load robot, style, lexicon and voice for planning, with MuJoCo dynamics.

    The default voice is silent, so that times are equal on every machine. By default nothing idles or varies, so that
    measurements are comparable.

    Args:
        robot: name of the robot, or path of its TOML file.
        style: name of the style, or path of its TOML file.
        options: see `PlanningOptions`.

    Raises:
        ConfigError: a file is missing or a value is invalid; the message names valid values.
        TypeError: an option is unknown.
    """
    check_options(options)
    body = robot if isinstance(robot, Robot) else load_robot(robot)
    check_mapping(body, options.get("mapping", "checked"))
    base_style = style if isinstance(style, Style) else Style.load(style)
    performed_style = base_style.changed(_format_settings(options.get("settings", ())))
    lexicon, seed = _read_lexicon(options), options.get("seed", 0)
    variation = Variation(options.get("variation", 0.0), seed)
    unstyled, distances = body, CapsuleDistances(body)
    body = standing_robot(unstyled, performed_style, lexicon, distances)
    body = vary_standing(body, performed_style, variation, distances)
    return Setup(
        robot=body,
        style=performed_style,
        lexicon=lexicon,
        voice=make_voice(options.get("voice", "durations"), engine=_to_engine(options.get("engine"))),
        dynamics=MujocoDynamics(body),
        distances=distances,
        targets=_read_targets(options.get("targets")),
        dialect=options.get("dialect", "auto"),
        gathering=options.get("gather", "complex"),
        idling=Idling(options.get("idle", 0.0), seed),
        prosody=_read_prosody(options),
        variation=variation,
        pause=options.get("pause", 0.0),
        character=options.get("character"),
        language=options.get("language", "en"),
        grammar=options.get("grammar", "rules"),
        intentions=IntentionFiles(
            _to_path(options.get("intentions")), _to_path(options.get("baseline")), _to_path(options.get("qualifiers"))
        ),
        preference=options.get("prefer", "lexicon"),
        unstyled=unstyled,
        recordings=_to_path(options.get("recordings")),
        impacts=RobotImpacts(body),
        policy=find_policy(options.get("near") or body.audience, body.impact_limits),
    )


def _read_lexicon(options: PlanningOptions) -> Lexicon:
    """Load the gestures of the options `lexicon` and `library`, and kinesic's own."""
    library = _to_path(options.get("library"))
    folders = () if library is None else find_collections(library)
    return Lexicon.load(_to_path(options.get("lexicon")), *folders)


def _read_prosody(options: PlanningOptions) -> float:
    """Return the amount of face and head motion that follows the voice.

    The default is the amount of idle motion.
    """
    amount = options.get("prosody")
    return options.get("idle", 0.0) if amount is None else amount


def _to_engine(engine: SpeechEngine | str | None) -> SpeechEngine | None:
    return EngineProgram.of(engine) if isinstance(engine, str) else engine


def _to_path(path: str | Path | None) -> Path | None:
    return None if path is None else Path(path)


def _format_settings(settings: Mapping[str, float] | Sequence[str]) -> Iterable[str]:
    """Return the style settings as NAME=VALUE texts."""
    if isinstance(settings, Mapping):
        return (f"{name}={float(value)!r}" for name, value in settings.items())
    return settings


def _read_targets(targets: str | Path | Mapping[str, Sequence[float] | Floats] | None) -> Mapping[str, Floats]:
    if isinstance(targets, str | Path):
        return read_targets(Path(targets))
    points = {name: sealed(np.array(point, dtype=np.float64)) for name, point in (targets or {}).items()}
    for name, point in points.items():
        if point.shape != (3,) or not np.isfinite(point).all():
            raise ConfigError(f"target {name} is {point.tolist()}; it needs three finite numbers x, y, z in metres")
    return points
