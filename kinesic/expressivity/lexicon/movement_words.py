"""The words in which names speak of movements of head and trunk, and what a head does by them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from kinesic.expressivity.lexicon.names import NAMES_KEPT, split_words, word_set

HeadKind = Literal["nod", "shake", "direction"]
LONGEST_NAME = 120  # characters of a name that are read; a longer one is none

_FORMS: Mapping[str, str] = {  # a word -> others that say the same
    "nod": "nods nodding nodded headnod nodhead",
    "shake": "shakes shaking shook headshake shakehead",
    "tilt": "tilts tilting tilted headtilt tilthead cock cocks cocked",
    "toss": "tosses tossing tossed",
    "roll": "rolls rolling rolled",
    "lean": "leans leaning leaned",
    "incline": "inclines inclining inclined inclination",
    "bow": "bows bowing bowed",
    "recline": "reclines reclining reclined",
    "turn": "turns turning turned rotate rotates rotating rotated twist twists twisting twisted look looks looking",
    "up": "upward upwards raise raises raised raising lift lifts lifted lifting",
    "down": "downward downwards lower lowers lowered lowering",
    "left": "leftward leftwards",
    "right": "rightward rightwards",
    "forward": "forwards",
    "back": "backward backwards",
    "aside": "sideways sideward sidewards",
    "neutral": "straight centre center centred centered",
    "stand": "stands standing",
    "rest": "rests resting rested",
    "hang": "hangs hanging",
    "side": "sides",
    "idle": "idling",
    "big": "large strong strongly deep deeply",
    "small": "subtle tiny slight slightly little soft softly gentle gently",
}
_CANON = {other: word for word, others in _FORMS.items() for other in others.split()}
_SCALES = {"big": 1.5, "small": 0.5}

_NODS = word_set(
    "yes yep yeah agree agrees agreeing agreed agreement affirm affirms affirmation affirmative approve approval "
    "assent acknowledge acknowledges acknowledgement confirm confirms confirmation accept acceptance backchannel"
)
_SHAKES = word_set(
    "no nope deny denies denial disagree disagrees disagreement disapprove disapproval negate negation negative "
    "negatory refuse refusal reject rejection"
)
_LIKE_SHAKES = word_set("spin swing wiggle waggle sway lateral")
_DIRECTIONS = word_set(
    "up down left right forward back aside tilt toss roll lean incline bow neutral turn"
)  # of a head
_CORE = frozenset({"nod", "shake", "tilt"})  # a word more changes nothing of what is done
NEGATIONS = word_set("no not dont don never none without cannot cant isnt doesnt lost less")  # of what is named
_OTHER_PARTS = word_set(
    "hand hands arm arms fist fists finger fingers thumb shoulder shoulders body hip hips leg legs foot feet eye eyes "
    "brow brows eyebrow eyebrows mouth"
)
_FILLERS = word_set(
    "head neck chin gesture movement move motion rotation direction and to the a an of with in at very really "
    "big small middle mid medium slow slowly fast quick quickly short long hard once twice double single multiple "
    "repeated repeat again simple loop anim animation motex l r b h lh rh"
)


_TRUNK = word_set(
    "forward front down up back left right recline lean incline bow tilt turn neutral nothing upright body trunk torso "
    "spine waist whole position posture pose aside side"
)


@dataclass(frozen=True)
class HeadName:
    """What a head does by a name."""

    kind: HeadKind
    words: tuple[str, ...]  # as `movement_words` has them
    stands_for: str = ""  # why it is not the name itself


@lru_cache(maxsize=NAMES_KEPT)
def movement_words(name: str) -> tuple[str, ...]:
    """Splits a name into its words, one for all that say the same: `LEANING_Backwards` is lean, back."""
    if len(name) > LONGEST_NAME:
        return ()
    return tuple(_CANON.get(word, word) for word in split_words(name) if not word.isdigit())


def amplitude_factor(words: tuple[str, ...]) -> float:
    """Reads the factor on amplitude of words such as big and small."""
    return next((_SCALES[word] for word in words if word in _SCALES), 1.0)


def read_trunk_name(name: str) -> tuple[str, ...]:
    """Finds the words of a name that speak of the trunk; none when a word of it speaks of anything else."""
    words = movement_words(name)
    return words if all(word in _TRUNK or word in _FILLERS for word in words) else ()


def read_head_name(name: str) -> HeadName | None:
    """Finds what a head does by a name: a nod, a shake, a direction, a synonym of one, or one of its class.

    A name that says nothing is a nod, most likely. With a word that is not understood, a nod, a shake or a tilt stands
    for the whole; a direction or a synonym would say something else.

    Returns:
        None when no word, or more than one, names a movement, or when it is negated.
    """
    words = movement_words(name)
    said = [word for word in words if word not in _FILLERS]
    if not said and len(name) <= LONGEST_NAME:
        return HeadName("nod", (), f"a nod stands for {name or 'a head movement without lexeme'}")
    kind, known = _kind(said), _NODS | _SHAKES | _LIKE_SHAKES | _DIRECTIONS | {"nod", "shake", "side"}
    others = [word for word in said if word not in known]
    if kind is None or (NEGATIONS - {"no"}) & {*said} or _OTHER_PARTS & {*said} or (others and not _CORE & {*said}):
        return None
    like = next((word for word in said if word in _LIKE_SHAKES), None) if "shake" not in said else None
    stands = f"a {kind if kind != 'direction' else 'tilt'} stands for {name}"
    left_out = "".join(f': "{" ".join(others)}" is left out' if others else "")
    return HeadName(kind, words, stands + left_out if others or like else "")


def _kind(words: Sequence[str]) -> HeadKind | None:
    """What some words name; up and down is a nod, left and right, or side to side, a shake."""
    said = frozenset(words)
    nods = bool(said & (_NODS | {"nod"}) or {"up", "down"} <= said)
    shakes = bool(said & (_SHAKES | _LIKE_SHAKES | {"shake"}) or said == {"left", "right"} or [*words] == ["side"] * 2)
    if nods or shakes:
        return None if nods and shakes else "nod" if nods else "shake"
    return "direction" if said & (_DIRECTIONS - {"turn"}) else None
