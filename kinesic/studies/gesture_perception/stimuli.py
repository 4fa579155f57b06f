"""What participants see: planned motions of gestures alone and of texts, and pairs that differ by one setting."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import radians

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.config import ConfigError
from kinesic.controller.options import LIVELY, check_options
from kinesic.controller.perform import plan
from kinesic.expressivity.lexicon.lexicon import Lexicon
from kinesic.planning.captions import Caption, captions
from kinesic.planning.plan import Plan
from kinesic.planning.setup import Setup
from kinesic.report.report import Json
from kinesic.report.scene import pack_rows
from kinesic.studies.gesture_perception.design import StimulusVersion
from kinesic.studies.gestures.isolated import write_document

MOTION_RATE = 50.0  # [Hz] of the motions
SEEN = radians(1.0)  # that some hinge must differ by, sometime, before anybody can compare


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A motion at a steady rate."""

    angles: Floats  # (m, n) [rad] at `MOTION_RATE`
    words: tuple[Caption, ...] = ()  # that are said meanwhile

    def differs(self, other: "SampledMotion") -> bool:
        """Whether somebody might see a difference: in when it ends, or in a hinge."""
        shorter = min(len(self.angles), len(other.angles))
        long_after = abs(len(self.angles) - len(other.angles)) > 0.2 * MOTION_RATE
        return long_after or bool(np.abs(self.angles[:shorter] - other.angles[:shorter]).max() > SEEN)


@dataclass(frozen=True, eq=False)
class StimulusPair:
    """One document in the manner of the study, and with one setting changed."""

    stimulus: str  # name of the document; a gesture's is its id
    condition: str  # the setting, such as whole_body=0
    motions: Mapping[StimulusVersion, SampledMotion]


def gesture_documents(gestures: Iterable[str], lexicon: Lexicon) -> dict[str, str]:
    """Writes BML that asks for each gesture alone, by its id."""
    forms = {gesture: lexicon.forms_by_id[gesture] for gesture in gestures}
    return {gesture: write_document(f"{form.category}={form.id}") for gesture, form in forms.items()}


def plan_motions(
    documents: Mapping[str, str | bytes], setup: Setup, left_out: Callable[[str], None] = lambda why: None
) -> dict[str, SampledMotion]:
    """Plans documents; those of which the robot can perform nothing are told and left out.

    Args:
        documents: BML by its name.
        setup: of planning.
        left_out: gets why a document is left out.

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
            motions[name] = _motion(planned)
    return motions


def changed_setup(setup: Setup, condition: str) -> Setup:
    """Changes one setting: a number of the style, idle motion (`idle=0`), or how far gestures vary (`variation=0`).

    Raises:
        ConfigError: there is no such setting, or its value is out of range.
    """
    name, _, value = condition.partition("=")
    if name not in LIVELY:
        return replace(setup, style=setup.style.changed((condition,)))
    try:
        amount = float(value)
    except ValueError:
        raise ConfigError(f"{name} is {value!r}, not a number; such as {name}=0") from None
    if name == "idle":
        check_options({"idle": amount})
        return replace(setup, idling=replace(setup.idling, amount=amount))
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
    """Plans documents with one setting changed, until there are enough that somebody can tell apart.

    Args:
        documents: BML by its name.
        motions: of those that the robot performs, as the setup has them.
        setup: of planning.
        condition: the setting.
        count: of pairs at most.
        first: of the documents that is tried; behind the last one comes the first.

    Raises:
        ConfigError: there is no such setting.
    """
    other, pairs, tried = changed_setup(setup, condition), list[StimulusPair](), [*motions.items()]
    start = first % max(len(tried), 1)
    for name, standard in (*tried[start:], *tried[:start]):
        if len(pairs) == count:
            break
        changed = plan_motions({name: documents[name]}, other).get(name)
        if changed is not None and standard.differs(changed):
            pairs.append(StimulusPair(name, condition, {"standard": standard, "changed": changed}))
    return pairs


def motion_data(motions: Sequence[SampledMotion]) -> list[Json]:
    """Gathers what `rowAt` reads: angles as 16-bit integers in base64, one row of hinges for each frame; and words."""
    return [_packed(motion) for motion in motions]


def _packed(motion: SampledMotion) -> Json:
    step = float(np.abs(motion.angles).max()) / np.iinfo(np.int16).max or 1.0
    return {
        "end": (len(motion.angles) - 1) / MOTION_RATE,
        "frames": len(motion.angles),
        "step": step,
        "angles": pack_rows(motion.angles / step, "<i2"),
        "words": [[round(said.begin, 3), round(said.end, 3), said.text] for said in motion.words],
    }


def _motion(planned: Plan) -> SampledMotion:
    times = np.arange(int(np.ceil(planned.duration * MOTION_RATE)) + 1) / MOTION_RATE
    return SampledMotion(planned.trajectory.sample(times)[0], tuple(captions(planned)))
