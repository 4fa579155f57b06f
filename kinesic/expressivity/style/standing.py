"""Standing posture, resting hands, facial affect and gaze habit of a style."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians

import msgspec
import numpy as np

from kinesic.expressivity.keyframes import Turn

HANGING_REST = "hanging"  # name of the rest pose in which the arms hang, without a gesture
OTHER_HAND_PROBABILITY = 0.4  # probability that a rest gesture is mirrored to the other hand
# (rest gesture, weight of its random choice) of a style without own rests; the hands take them in long pauses.
USUAL_PAUSES = ((HANGING_REST, 2.0), ("hands_folded_low", 3.0), ("hand_on_hip", 1.5), ("arms_crossed", 0.7))
UPRIGHT_TURN = Turn()  # zero rotation of head and trunk


class StandingTurnTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a rotation of head or trunk."""

    torsion: float = 0.0  # [deg] positive to the left
    tilt: float = 0.0  # [deg] positive downward or forward
    roll: float = 0.0  # [deg] positive to the right side

    @property
    def turn(self) -> Turn:
        """Rotation with angles in radians."""
        return Turn(radians(self.torsion), radians(self.tilt), radians(self.roll))


class StandingTable(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """TOML table of a style's posture, resting hands, face and gaze habit."""

    head: StandingTurnTable = StandingTurnTable()  # rotation in the world
    trunk: StandingTurnTable = StandingTurnTable()  # rotation from upright
    arms: dict[str, float] = {}  # [deg] added to the hinges of both resting arms, by the hinge name without side
    fist: float = 0.0  # 0 relaxed .. 1 closed fingers of the resting hands
    rest: str = ""  # rest gesture of the hands, if the body can take it; empty: arms hang
    mirrored: bool = False  # whether the rest gesture is mirrored to the other hand
    pauses: dict[str, float] = {}  # weights of rest gestures (and "hanging") that the hands take in long pauses
    face: dict[str, float] = {}  # lexeme of an expression -> amount, shown all the time
    gaze_down: float = 0.0  # [deg] angle of an averted gaze below straight ahead
    gaze_aside: float = 0.0  # [deg] angle of an averted gaze to the side, alternately left and right
    averted: float = 0.0  # fraction of the time in which the gaze is averted, 0 .. 1


@dataclass(frozen=True)
class GazeHabit:
    """Direction and time fraction of averted gazes outside gaze behaviours."""

    down: float = 0.0  # [rad] angle of an averted gaze below straight ahead
    aside: float = 0.0  # [rad] angle of an averted gaze to the side
    averted: float = 0.0  # fraction of the time in which the gaze is averted


FRONTAL_GAZE = GazeHabit()  # gaze at the listener all the time


@dataclass(frozen=True)
class Standing:
    """Posture, resting hands, facial affect and gaze habit of a style."""

    head: Turn = UPRIGHT_TURN  # rotation in the world
    trunk: Turn = UPRIGHT_TURN  # rotation from upright
    arms: tuple[tuple[str, float], ...] = ()  # (hinge name without side, offset from the robot's rest [rad])
    fist: float = 0.0  # 0 relaxed .. 1 closed fingers
    rest: str = ""  # rest gesture of the lexicon; empty: arms hang
    mirrored: bool = False  # whether the rest gesture is mirrored to the other hand
    pauses: tuple[tuple[str, float], ...] = ()  # (rest gesture or `HANGING_REST`, weight) in long pauses
    face: tuple[tuple[str, float], ...] = ()  # (lexeme of an expression, amount)
    gaze: GazeHabit = FRONTAL_GAZE

    @classmethod
    def of(cls, table: StandingTable) -> "Standing":
        """Convert the table of a style file to a standing posture.

        A style that poses its arms has only the rest gestures that it names.
        """
        is_posed = bool(table.rest or table.arms)
        return cls(
            head=table.head.turn,
            trunk=table.trunk.turn,
            arms=tuple((hinge, radians(angle)) for hinge, angle in table.arms.items()),
            fist=table.fist,
            rest=table.rest,
            mirrored=table.mirrored,
            pauses=tuple(table.pauses.items()) or (() if is_posed else USUAL_PAUSES),
            face=tuple(table.face.items()),
            gaze=GazeHabit(radians(table.gaze_down), radians(table.gaze_aside), table.averted),
        )

    @property
    def moves_body(self) -> bool:
        """Whether head, trunk, arms or fingers leave the robot's own rest posture."""
        return (self.head, self.trunk) != (UPRIGHT_TURN, UPRIGHT_TURN) or bool(self.arms or self.fist or self.rest)

    def affect(self, weight: float) -> Mapping[str, float]:
        """Return the intensity of each permanent expression, scaled by a style weight."""
        return {lexeme: min(weight * amount, 1.0) for lexeme, amount in self.face if weight > 0.0}


def choose_rest(weights: tuple[tuple[str, float], ...], chance: np.random.Generator) -> str | None:
    """Return a random rest gesture, empty for hanging arms.

    Returns:
        None without weights.
    """
    if not weights:
        return None
    names, amounts = zip(*weights, strict=True)
    chosen: str = names[int(chance.choice(len(names), p=np.array(amounts) / sum(amounts)))]
    return "" if chosen == HANGING_REST else chosen


NEUTRAL_STANDING = Standing.of(StandingTable())  # robot's rest posture, usual pauses, neutral face and frontal gaze
UNPOSED_STANDING = Standing()  # neutral standing without rest gestures: arms return to the rest posture
