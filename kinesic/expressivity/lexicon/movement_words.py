"""Words for head and trunk movements in behaviour names."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from kinesic.expressivity.lexicon.names import NAME_CACHE_SIZE, split_words, word_set

HeadKind = Literal["nod", "shake", "direction"]
MAX_NAME_LENGTH = 120  # [characters] longer names are not interpreted

_WORD_VARIANTS: Mapping[str, str] = {  # standard word -> its inflections and synonyms
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
_STANDARD_WORDS = {other: word for word, others in _WORD_VARIANTS.items() for other in others.split()}
_AMPLITUDE_FACTORS = {"big": 1.5, "small": 0.5}  # factor on the amplitude by size word

_NOD_WORDS = word_set(
    "yes yep yeah agree agrees agreeing agreed agreement affirm affirms affirmation affirmative approve approval "
    "assent acknowledge acknowledges acknowledgement confirm confirms confirmation accept acceptance backchannel"
)
_SHAKE_WORDS = word_set(
    "no nope deny denies denial disagree disagrees disagreement disapprove disapproval negate negation negative "
    "negatory refuse refusal reject rejection"
)
_SHAKE_LIKE_WORDS = word_set("spin swing wiggle waggle sway lateral")
_DIRECTION_WORDS = word_set(
    "up down left right forward back aside tilt toss roll lean incline bow neutral turn"
)  # direction words of head movements
_MAIN_MOVEMENTS = frozenset({"nod", "shake", "tilt"})  # movements performed even if the name has unknown words
NEGATION_WORDS = word_set("no not dont don never none without cannot cant isnt doesnt lost less")
_OTHER_PART_WORDS = word_set(
    "hand hands arm arms fist fists finger fingers thumb shoulder shoulders body hip hips leg legs foot feet eye eyes "
    "brow brows eyebrow eyebrows mouth"
)
_FILLER_WORDS = word_set(
    "head neck chin gesture movement move motion rotation direction and to the a an of with in at very really "
    "big small middle mid medium slow slowly fast quick quickly short long hard once twice double single multiple "
    "repeated repeat again simple loop anim animation motex l r b h lh rh"
)


_TRUNK_WORDS = word_set(
    "forward front down up back left right recline lean incline bow tilt turn neutral nothing upright body trunk torso "
    "spine waist whole position posture pose aside side"
)


@dataclass(frozen=True)
class HeadName:
    """Head movement described by a behaviour name."""

    kind: HeadKind
    words: tuple[str, ...]  # standard words of the name, from `movement_words`
    stands_for: str = ""  # reason why the movement only approximates the name


@lru_cache(maxsize=NAME_CACHE_SIZE)
def movement_words(name: str) -> tuple[str, ...]:
    """Split a name into words, with synonyms replaced by one standard word.

    `LEANING_Backwards` gives lean, back.
    """
    if len(name) > MAX_NAME_LENGTH:
        return ()
    return tuple(_STANDARD_WORDS.get(word, word) for word in split_words(name) if not word.isdigit())


def amplitude_factor(words: tuple[str, ...]) -> float:
    """Return the amplitude factor of words such as big and small."""
    return next((_AMPLITUDE_FACTORS[word] for word in words if word in _AMPLITUDE_FACTORS), 1.0)


def read_trunk_name(name: str) -> tuple[str, ...]:
    """Return a name's words if all describe a trunk movement.

    Returns:
        Empty if the name has other words.
    """
    words = movement_words(name)
    return words if all(word in _TRUNK_WORDS or word in _FILLER_WORDS for word in words) else ()


def read_head_name(name: str) -> HeadName | None:
    """Return the head movement described by a behaviour name.

    It is a nod, a shake, a direction, a synonym of one, or a member of one of these classes. A name without a movement
    word is most likely a nod. If the name has unknown words, a nod, a shake or a tilt stands for the whole name; a
    direction or a synonym would mean something different.

    Returns:
        None when no word, or more than one, names a movement, or when the movement is negated.
    """
    words = movement_words(name)
    meaningful = [word for word in words if word not in _FILLER_WORDS]
    if not meaningful and len(name) <= MAX_NAME_LENGTH:
        return HeadName("nod", (), f"a nod stands for {name or 'a head movement without lexeme'}")
    kind, movement_names = (
        _kind(meaningful),
        _NOD_WORDS | _SHAKE_WORDS | _SHAKE_LIKE_WORDS | _DIRECTION_WORDS | {"nod", "shake", "side"},
    )
    others = [word for word in meaningful if word not in movement_names]
    if (
        kind is None
        or (NEGATION_WORDS - {"no"}) & {*meaningful}
        or _OTHER_PART_WORDS & {*meaningful}
        or (others and not _MAIN_MOVEMENTS & {*meaningful})
    ):
        return None
    like = next((word for word in meaningful if word in _SHAKE_LIKE_WORDS), None) if "shake" not in meaningful else None
    stands = f"a {kind if kind != 'direction' else 'tilt'} stands for {name}"
    left_out = "".join(f': "{" ".join(others)}" is left out' if others else "")
    return HeadName(kind, words, stands + left_out if others or like else "")


def _kind(words: Sequence[str]) -> HeadKind | None:
    """Return the kind of head movement described by some words.

    Up and down is a nod; left and right, or side to side, is a shake. None if no word, or both a nod and a shake, is
    described.
    """
    meaningful = frozenset(words)
    nods = bool(meaningful & (_NOD_WORDS | {"nod"}) or {"up", "down"} <= meaningful)
    shakes = bool(
        meaningful & (_SHAKE_WORDS | _SHAKE_LIKE_WORDS | {"shake"})
        or meaningful == {"left", "right"}
        or [*words] == ["side"] * 2
    )
    if nods or shakes:
        return None if nods and shakes else "nod" if nods else "shake"
    return "direction" if meaningful & (_DIRECTION_WORDS - {"turn"}) else None
