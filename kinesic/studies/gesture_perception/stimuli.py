"""Sampled motions shown to the participants of a gesture study.

Planned motions, and pairs that differ by one setting.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning.captions import Caption, make_captions
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.report import Json
from kinesic.report.scene import pack_rows
from kinesic.session.options import check_options
from kinesic.session.plan import plan
from kinesic.studies.gesture_perception.design import StimulusVersion
from kinesic.studies.gestures.isolated import write_isolated_gesture

MOTION_RATE = 50.0  # [Hz] sample rate of sampled motions
MIN_VISIBLE_DIFFERENCE = radians(1.0)  # [rad] smallest visible difference of a joint


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A motion sampled at a constant rate."""

    angles: Floats  # (m, n) [rad] at `MOTION_RATE`
    words: tuple[Caption, ...] = ()  # captions of the speech

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return (len(self.angles) - 1) / MOTION_RATE

    def differs(self, other: "SampledMotion") -> bool:
        """Return whether this motion visibly differs from another.

        The motions differ in duration or in a joint angle.
        """
        shorter = min(len(self.angles), len(other.angles))
        long_after = abs(len(self.angles) - len(other.angles)) > 0.2 * MOTION_RATE
        return long_after or bool(np.abs(self.angles[:shorter] - other.angles[:shorter]).max() > MIN_VISIBLE_DIFFERENCE)


@dataclass(frozen=True, eq=False)
class StimulusPair:
    """Two motions of one document, with and without one changed setting."""

    stimulus: str  # name of the document; a gesture's id
    condition: str  # the changed setting, such as whole_body=0
    motions: Mapping[StimulusVersion, SampledMotion]


def gesture_documents(gestures: Iterable[str], lexicon: Lexicon) -> dict[str, str]:
    """Return BML documents with one gesture each, by gesture id."""
    forms = {gesture: lexicon.forms_by_id[gesture] for gesture in gestures}
    return {gesture: write_isolated_gesture(f"{form.category}={form.id}") for gesture, form in forms.items()}


def plan_motions(
    documents: Mapping[str, str | bytes], setup: Setup, left_out: Callable[[str], None] = lambda why: None
) -> dict[str, SampledMotion]:
    """Plan the documents of a study and return their sampled motions.

    Report and skip those that the robot cannot perform.

    Args:
        documents: BML by name.
        setup: robot, style and options.
        left_out: callback with the reason why a document is skipped.

    Raises:
        BmlError: a document is refused.
    """
    motions: dict[str, SampledMotion] = {}
    for name, text in documents.items():
        planned = plan(text, setup, source=name)
        outcomes = planned.keyframes.outcomes.values()
        if all(outcome.kind == "dropped" for outcome in outcomes):
            why = "; ".join(outcome.why for outcome in outcomes)
            left_out(f"{name} is left out, {setup.robot.name} cannot perform it: {why}")
        else:
            motions[name] = sample_motion(planned)
    return motions


def changed_setup(setup: Setup, condition: str) -> Setup:
    """Change one setting of a planning setup, given as NAME=VALUE.

    It is a number of the style, idle motion with prosody (`idle=0`) or the variation of gestures (`variation=0`).

    Raises:
        ConfigError: the setting does not exist, or its value is out of range.
    """
    name, _, value = condition.partition("=")
    if name not in ("idle", "variation"):
        return replace(setup, style=setup.style.changed((condition,)))
    try:
        amount = float(value)
    except ValueError:
        raise ConfigError(f"{name} is {value!r}, not a number; such as {name}=0") from None
    if name == "idle":
        check_options({"idle": amount})
        return replace(setup, idling=replace(setup.idling, amount=amount), prosody=amount)
    check_options({"variation": amount})
    return replace(setup, variation=replace(setup.variation, amount=amount))


def plan_pairs(
    documents: Mapping[str, str | bytes],
    motions: Mapping[str, SampledMotion],
    setup: Setup,
    condition: str,
    count: int,
    *,
    first: int = 0,
) -> list[StimulusPair]:
    """Plan documents with one setting changed until enough pairs differ visibly.

    Args:
        documents: BML by name.
        motions: motions with the unchanged setup.
        setup: robot, style and options.
        condition: the changed setting.
        count: maximum number of pairs.
        first: index of the first document to try; the order is cyclic.

    Raises:
        ConfigError: the setting does not exist.
    """
    other, pairs, candidates = changed_setup(setup, condition), list[StimulusPair](), [*motions.items()]
    start = first % max(len(candidates), 1)
    for name, standard in (*candidates[start:], *candidates[:start]):
        if len(pairs) == count:
            break
        changed = plan_motions({name: documents[name]}, other).get(name)
        if changed is not None and standard.differs(changed):
            pairs.append(StimulusPair(name, condition, {"standard": standard, "changed": changed}))
    return pairs


def motion_data(motions: Sequence[SampledMotion]) -> list[Json]:
    """Return packed motions and captions for the study page's script.

    Angles are 16-bit integers in base64, one row per frame.
    """
    return [_pack(motion) for motion in motions]


def _pack(motion: SampledMotion) -> Json:
    step = float(np.abs(motion.angles).max()) / np.iinfo(np.int16).max or 1.0
    return {
        "end": (len(motion.angles) - 1) / MOTION_RATE,
        "frames": len(motion.angles),
        "step": step,
        "angles": pack_rows(motion.angles / step, "<i2"),
        "words": [[round(caption.begin, 3), round(caption.end, 3), caption.text] for caption in motion.words],
    }


def sample_motion(planned: Plan) -> SampledMotion:
    """Sample the motion of a plan, with its captions."""
    times = np.arange(int(np.ceil(planned.duration * MOTION_RATE)) + 1) / MOTION_RATE
    return SampledMotion(planned.trajectory.sample(times)[0], tuple(make_captions(planned)))
