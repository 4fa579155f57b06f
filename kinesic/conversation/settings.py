"""Times and angles of the conversational states.

They are from the literature on human conversation.
"""

from dataclasses import dataclass

from kinesic.conversation.wants import ActionUnits, Mode


@dataclass(frozen=True)
class Rhythm:
    """Alternation of looks at a person and looks away in one state."""

    look: tuple[float, float]  # [s] mean and half range of the duration of looks at the person
    away: tuple[float, float]  # [s] mean and half range of the duration of looks away
    directions: tuple[float, float, float]  # probabilities of looks to a side, down and up; they sum to 1
    head_probability: float  # probability that the head takes part in a look away
    angle: float = 14.0  # [deg] angle of looks away


@dataclass(frozen=True)
class Bearing:
    """Posture and facial expression held in one state, at amount 1."""

    lean: float = 0.0  # [deg] forward lean of the trunk
    tilt: float = 0.0  # [deg] tilt of the head to a random side
    face: ActionUnits = ()


@dataclass(frozen=True)
class TurnTimes:
    """Times of changes between states."""

    voice_to_listening: float = 0.15  # [s] duration of a person's voice after which the robot listens
    voice_to_yield: float = (
        0.75  # [s] voice without words that stops the robot's speech; includes 0.3 s of detector delay
    )
    words_to_yield: int = 2  # recognised words after which the robot stops its own speech
    silence: float = 0.7  # [s] silence that ends a turn
    silence_if_predicted: float = 0.2  # [s] silence that ends a turn which a model expects to end
    silence_if_unfinished: float = 1.2  # [s] silence that ends a turn after a conjunction or a hesitation
    prediction_threshold: float = 0.6  # probability of the turn's end above which `silence_if_predicted` applies
    doubt_threshold: float = 0.4  # probability of the turn's end below which `silence_if_unfinished` applies
    end_to_thinking: float = 0.3  # [s] time from the end of a turn to the thinking state
    longest_unasked_thinking: float = 8.0  # [s] longest thinking state without a `think` message of a client
    interrupted: float = 0.8  # [s] duration of the interrupted state
    absence_to_idle: float = 10.0  # [s] time without a person after which the robot idles


@dataclass(frozen=True)
class MovementSettings:
    """Angles and times of the robot's conversational movements, at amount 1."""

    dead_zone: float = 3.0  # [deg] movement of a person below which the gaze stays
    shortest_look_interval: float = 0.25  # [s] shortest time between two corrections of the gaze
    first_aversion: float = 1.2  # [s] duration of the look away at the start of speech
    last_look: float = 2.3  # [s] longest look at the person that ends a speech
    last_look_fraction: float = 0.25  # duration of the last look / duration of the speech; 0.6 s are added
    longest_look: float = 5.5  # [s] longest look at a person without a look away
    nod: tuple[float, float] = (6.0, 9.0)  # [deg] smallest and largest nod
    nod_interval: float = 5.0  # [s] shortest time between nods
    nods_per_minute: int = 10  # largest number of nods in a minute
    voice_before_nod: float = 0.7  # [s] shortest speech before a nod
    pause_before_nod: float = 0.2  # [s] pause of a speaker after which the listener nods
    nod_probability: float = 0.55  # probability that the listener nods at a pause
    fillers: tuple[float, ...] = (1.2, 4.0)  # [s] times of fillers after the start of thinking


TURN_TIMES = TurnTimes()
MOVEMENT_SETTINGS = MovementSettings()

GAZE_RHYTHMS: dict[Mode, Rhythm] = {
    "idle": Rhythm((0.8, 0.3), (2.6, 0.8), (0.7, 0.25, 0.05), 1.0, angle=24.0),
    "attending": Rhythm((2.4, 0.6), (1.6, 0.4), (0.7, 0.2, 0.1), 0.1),
    "listening": Rhythm((2.8, 0.8), (1.2, 0.2), (0.7, 0.2, 0.1), 0.1),
    "thinking": Rhythm((1.0, 0.2), (3.0, 0.5), (0.1, 0.1, 0.8), 1.0, angle=18.0),
    "speaking": Rhythm((1.2, 0.3), (2.8, 0.5), (0.7, 0.2, 0.1), 0.1),
}  # gaze rhythm by mode; in all other modes, the robot never looks away from the person

RELAXED_BEARING = Bearing()  # upright posture with a neutral face
MODE_BEARINGS: dict[Mode, Bearing] = {
    "attending": Bearing(face=(("6", 0.4), ("12", 0.7))),
    "listening": Bearing(lean=4.0, tilt=7.0, face=(("1", 0.2), ("2", 0.35), ("12", 0.25))),
    "thinking": Bearing(lean=-2.0, face=(("1", 0.2), ("4", 0.5), ("18", 0.35))),
}  # bearing by mode; in all other modes, the bearing is relaxed
