"""Durations and spline parameters of gesture phases, by category and expressivity.

People take nearly the same time for short and long hand movements, so that velocity grows with distance. They put
their force into the stroke, pass through its keys and retract slowly (Kendon; Laban's effort of time). In 241 captured
gestures, the duration grows with the travelled distance to the power of 0.1 to 0.3. No duration is shorter than the
servos need.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import log2
from typing import Literal

from kinesic.expressivity.style.pace import TEMPORAL_FACTOR, Pace, natural_time, scale_time
from kinesic.expressivity.style.passage import MIN_LATE_ACCENT, Phase, passage_of
from kinesic.expressivity.style.style import NEUTRAL_EXPRESSIVITY, Expressivity
from kinesic.motion.keys import LINEAR_STEEPNESS, MAX_STEEPNESS, KeyPassage

Tempo = Literal["sudden", "neutral", "sustained"]

TEMPO_FACTORS: Mapping[Tempo, float] = {"sudden": 0.48, "neutral": 1.0, "sustained": 2.1}  # duration factor by tempo
POSE_TIME_FACTOR = 1.3  # factor on the durations of a gesture whose stroke holds a pose
RETRACTION_EXPONENT = 0.5  # exponent of the gesture's duration factor in the retraction; factors below 1 count as 1
STROKE_SLOWNESS_EXPONENT = 0.5  # exponent of the gesture's duration factor in the stroke

PREPARATION_TIME = 0.56  # [s] natural preparation over the reference distance
RETRACTION_TIME = 0.96  # [s] natural retraction over the reference distance
STROKE_TIME = 0.47  # [s] natural stroke over the reference stroke distance
REFERENCE_DISTANCE = 0.9  # [arm lengths] usual distance between rest and stroke
REFERENCE_STROKE_DISTANCE = 0.35  # [arm lengths] usual distance of a stroke movement between two reversals
MIN_DISTANCE = 0.02  # [arm lengths] shorter movements take as long as a movement of this distance
PREPARATION_DISTANCE_EXPONENT = 0.10  # exponent of the relative distance in the preparation time
RETRACTION_DISTANCE_EXPONENT = 0.25  # exponent of the relative distance in the retraction time
STROKE_DISTANCE_EXPONENT = 0.4  # exponent of the relative distance in the stroke time
FITTS_INTERCEPT = 0.1  # [s] constant term of Fitts' law
FITTS_SLOPE = 0.15  # [s/bit] time per bit of difficulty in Fitts' law
FITTS_WIDTH = 0.05  # [m] target width in Fitts' law
PLAIN_STROKE_MARGIN = 2.4  # smallest stroke duration without the effort profile / minimum duration of the servos
PLAIN_HOLD_RATIO = 0.5  # hold time / stroke duration without the effort profile
PREPARATION_MARGIN = 1.05  # lower bound of the duration of a preparation from rest / minimum duration of the servos
EASY_MARGIN = 1.3  # lower bound of the duration of retractions and transitions / minimum duration of the servos
STROKE_MARGIN = 1.6  # lower bound of a stroke's natural duration / minimum duration of the servos
ACCENT_MARGIN = 1.5  # duration / minimum duration to which power shortens strokes; servos round off shorter accents
WEAKNESS_FRACTION = 0.6  # fraction of a negative power that slows preparation and retraction (from Greta)

REFERENCE_STROKE_TIME = 0.6  # [s] stroke duration for which hold times of gesture categories are given
POSE_HOLD_FACTOR = 1.8  # factor on the category's hold time after a pose
STROKE_HOLD_FACTOR = 0.4  # factor on the category's hold time after a stroke of the reference duration

STROKE_ACCENT = 2.4  # easing steepness added to the minimum of 1 in dynamic strokes without a word
SPOKEN_ACCENT = 6.4  # easing steepness above the minimum of 1 in strokes with their peak velocity at a word
STROKE_START_SWING = 0.9  # overshoot (0 none .. 1 full) at the key where a stroke begins
STROKE_KEY_SWING = 0.8  # overshoot (0 none .. 1 full) at stroke keys after the first key
SPOKEN_START_SWING = 0.4  # overshoot (0 none .. 1 full) at the key where a stroke timed to a word begins
MIN_SPOKEN_TENSION = -0.15  # smallest spline tension in the preparation of a stroke on a word
PATH_START_SWING = 0.6  # overshoot (0 .. 1) where a path begins; the preparation already ends along the path
PATH_START_VELOCITY = 0.5  # initial velocity of a path without a word / constant velocity along the path
PATH_END_SWING = 0.4  # overshoot (0 .. 1) at the end of a path
MIN_TIME_RATIO = 0.7  # available / natural time below which keys have neither overshoot nor accent
RETRACTION_STEEPNESS = 7.5  # steepness of a retraction without fluidity: peak / mean velocity is 4/3
FLUIDITY_EXPONENT = 1.6  # exponent of (1 - fluidity) in the steepness of the retraction
FULL_FIRMNESS = 0.5  # power, tension or stiffness that removes all overshoot at keys
WEAKNESS_REDUCTION = 0.5  # fraction of the overshoot at keys that power -1 removes
STIFFNESS_GAIN = 0.6  # increase of the accent at fluidity -1 / accent at fluidity 0
LOOSENESS_REDUCTION = 0.3  # fraction of the overshoot at keys removed at tension -1, whose spline overshoots itself


@dataclass(frozen=True)
class CategoryProfile:
    """Duration factor and hold time of one gesture category."""

    time: float  # factor on the durations of all movements
    hold: float  # [s] hold time after a stroke of the reference duration


DEFAULT_PROFILE = CategoryProfile(
    1.0, 0.30
)  # factor on durations, and hold time [s], for gesture categories without a profile
CATEGORY_PROFILES: Mapping[str, CategoryProfile] = {
    "beat": CategoryProfile(0.85, 0.17),
    "deictic": CategoryProfile(0.9, 0.45),
    "emblem": CategoryProfile(0.95, 0.35),
    "iconic": CategoryProfile(1.0, 0.25),
    "emotion": CategoryProfile(1.0, 0.45),
    "metaphoric": CategoryProfile(1.1, 0.30),
    "adaptor": CategoryProfile(1.3, 0.30),
    "rest": CategoryProfile(1.6, 0.30),
}


@dataclass(frozen=True)
class GestureTraits:
    """Properties of a gesture that determine its durations and accents."""

    category: str = ""  # gesture category of the lexicon, or of the user
    tempo: Tempo = "neutral"
    dynamic: bool = True  # whether the hand moves during the stroke; otherwise it takes a pose and holds it
    weight: float = 1.0  # weight of the effort profile: 0 Fitts' law, with a stop at every key .. 1 full profile


PLAIN_TRAITS = GestureTraits()  # traits of a dynamic gesture without category or tempo


@dataclass(frozen=True, eq=False)
class Effort:
    """Calculator of durations and spline parameters of one gesture on one robot.

    Documents that give times keep theirs.
    """

    pace: Pace  # minimum durations of the robot
    traits: GestureTraits = PLAIN_TRAITS
    manner: Expressivity = NEUTRAL_EXPRESSIVITY
    spoken: bool = False  # whether a word sounds at the stroke; the peak velocity then comes near the word

    @cached_property
    def slowness(self) -> float:
        """Duration factor for the gesture's category, tempo and dynamic or static stroke."""
        return (
            self._profile.time * TEMPO_FACTORS[self.traits.tempo] * (1.0 if self.traits.dynamic else POSE_TIME_FACTOR)
        )

    def preparation_time(self, distance: float) -> float:
        """Return the natural duration from rest to a stroke [s].

        Args:
            distance: travelled by the hand [m]; the minimum duration of the servos grows with it.
        """
        return self._approach_time(distance, self.slowness, PREPARATION_MARGIN)

    def joining_time(self, distance: float) -> float:
        """Return the natural duration of the transition from another gesture [s].

        A slow category or tempo does not lengthen it.
        """
        return self._approach_time(distance, min(self.slowness, 1.0), EASY_MARGIN)

    def return_time(self, distance: float) -> float:
        """Return the natural duration of the retraction [s].

        A fast gesture does not shorten it.
        """
        natural = (
            RETRACTION_TIME
            * max(self.slowness, 1.0) ** RETRACTION_EXPONENT
            * self._relative_distance(distance, REFERENCE_DISTANCE) ** RETRACTION_DISTANCE_EXPONENT
        )
        minimum = self.pace.least_hand_time(distance)
        natural = self._blend(max(natural, EASY_MARGIN * minimum), max(_fitts(distance), EASY_MARGIN * minimum))
        return natural_time(natural, minimum, self.manner.temporal, WEAKNESS_FRACTION * min(self.manner.power, 0.0))

    def stroke_time(self, distance: float) -> float:
        """Return the natural duration of a stroke movement between two reversals [s].

        Positive power shortens it.
        """
        natural = (
            STROKE_TIME
            * self.slowness**STROKE_SLOWNESS_EXPONENT
            * self._relative_distance(distance, REFERENCE_STROKE_DISTANCE) ** STROKE_DISTANCE_EXPONENT
        )
        minimum = self.pace.least_hand_time(distance)
        natural = self._blend(
            max(natural, STROKE_MARGIN * minimum), max(_fitts(distance), PLAIN_STROKE_MARGIN * minimum)
        )
        return natural_time(natural, minimum, self.manner.temporal, self.manner.power, margin=ACCENT_MARGIN)

    def hold_time(self, stroke: float) -> float:
        """Return the duration of the hold after a stroke [s].

        Args:
            stroke: duration of the stroke in neutral expressivity [s].
        """
        dwell = STROKE_HOLD_FACTOR * stroke / REFERENCE_STROKE_TIME if self.traits.dynamic else POSE_HOLD_FACTOR
        return scale_time(
            self._blend(self._profile.hold * dwell, PLAIN_HOLD_RATIO * stroke),
            0.0,
            self.manner.temporal,
            TEMPORAL_FACTOR,
        )

    def passage(self, phase: Phase, *, led: bool = False, time_ratio: float = 1.0, stroke: bool = True) -> KeyPassage:
        """Return the spline parameters (easing, tension, overshoot) of a stroke key.

        Args:
            phase: gesture phase of the movement that ends at the key.
            led: whether a path begins or ends at the key, along which the hand accelerates and decelerates by itself.
            time_ratio: available time divided by the natural time of the gesture, its neighbours included.
            stroke: whether the key is a stroke, at which a word may sound.
        """
        manner = self.manner
        if phase == "retraction":
            soft, stiff = max(manner.fluidity, 0.0), max(-manner.fluidity, 0.0)
            even = (
                LINEAR_STEEPNESS
                + (RETRACTION_STEEPNESS - LINEAR_STEEPNESS) * (1.0 - soft) ** FLUIDITY_EXPONENT
                + (MAX_STEEPNESS - RETRACTION_STEEPNESS) * stiff
            )
            home = replace(passage_of(manner, phase), easing="linear", steepness=self._blend(even, LINEAR_STEEPNESS))
            return home if self.traits.weight > 0.0 else passage_of(manner, phase)
        if phase == "hold":
            return passage_of(manner, phase)
        if phase == "preparation":
            manner = replace(manner, power=min(manner.power, 0.0))
            if self.spoken:  # a fast preparation would put the peak velocity before the word
                manner = replace(
                    manner, fluidity=min(manner.fluidity, 0.0), tension=max(manner.tension, MIN_SPOKEN_TENSION)
                )
        free = self.traits.weight * min(max((time_ratio - MIN_TIME_RATIO) / (1.0 - MIN_TIME_RATIO), 0.0), 1.0)
        accent = self._accent(is_spoken_key=self.spoken and stroke) if phase == "stroke" and not led else 0.0
        swing = self._swing_factor * self._largest_swing(phase, led=led) if self.traits.dynamic else 0.0
        passed = passage_of(
            manner,
            phase,
            accent=free * accent,
            has_late_peak=self.spoken,
            swing=free * swing,
            gesture_power=self.manner.power,
        )
        if self.traits.dynamic or phase == "stroke":
            return passed
        return replace(passed, continuity=passed.continuity * (1.0 - free * self._pose_flow))

    def path_start_velocity(self, passage: KeyPassage) -> float:
        """Return the ratio of a path's initial velocity to its constant velocity.

        Args:
            passage: of the key where the path begins after a preparation.
        """
        return 0.0 if self.spoken else PATH_START_VELOCITY * min(passage.swing / PATH_START_SWING, 1.0)

    def _largest_swing(self, phase: Phase, *, led: bool) -> float:
        """Return the largest overshoot at a key, 0 none to 1 full.

        Firmness and lack of time reduce it.
        """
        if phase == "stroke":
            return PATH_END_SWING if led else STROKE_KEY_SWING
        if led:
            return PATH_END_SWING if self.spoken else PATH_START_SWING
        return SPOKEN_START_SWING if self.spoken else STROKE_START_SWING

    @property
    def _pose_flow(self) -> float:
        """Fraction of a pose key's negative spline continuity that low tension removes.

        At 1 the hand runs through the key where its pose begins.
        """
        return self._swing_factor * (SPOKEN_START_SWING / STROKE_START_SWING if self.spoken else 1.0)

    @property
    def plain(self) -> "Effort":
        """Calculator for the same gesture with neutral expressivity."""
        return replace(self, manner=NEUTRAL_EXPRESSIVITY)

    @property
    def _swing_factor(self) -> float:
        """Factor on overshoot at keys, largest (1) at neutral expressivity."""
        firmness = max(self.manner.power, self.manner.tension, -self.manner.fluidity, 0.0)
        looseness, weakness = max(-self.manner.tension, 0.0), max(-self.manner.power, 0.0)
        reduction = (1.0 - LOOSENESS_REDUCTION * looseness) * (1.0 - WEAKNESS_REDUCTION * weakness)
        return max(1.0 - firmness / FULL_FIRMNESS, 0.0) * reduction

    @property
    def _accent_factor(self) -> float:
        """Factor on stroke accents, high for jerky and low for fluid motion."""
        fluidity = self.manner.fluidity
        return (1.0 - fluidity * (1.0 if fluidity > 0.0 else STIFFNESS_GAIN)) * (1.0 + min(self.manner.tension, 0.0))

    def _accent(self, *, is_spoken_key: bool) -> float:
        """Return the easing steepness added to accent the stroke, 0 without accent.

        Args:
            is_spoken_key: whether a word sounds at this key; only that key then has an accent.
        """
        if is_spoken_key:
            return max(self._accent_factor, MIN_LATE_ACCENT / SPOKEN_ACCENT) * SPOKEN_ACCENT
        return self._accent_factor * STROKE_ACCENT if self.traits.dynamic and not self.spoken else 0.0

    @property
    def _profile(self) -> CategoryProfile:
        return CATEGORY_PROFILES.get(self.traits.category.lower(), DEFAULT_PROFILE)

    def _approach_time(self, distance: float, slowness: float, easy: float) -> float:
        """Return the duration of the movement to a stroke [s].

        Weakness lengthens it, power acts on the stroke alone.
        """
        minimum = self.pace.least_hand_time(distance)
        natural = (
            PREPARATION_TIME
            * slowness
            * self._relative_distance(distance, REFERENCE_DISTANCE) ** PREPARATION_DISTANCE_EXPONENT
        )
        weakness = WEAKNESS_FRACTION * min(self.manner.power, 0.0)
        natural = self._blend(max(natural, easy * minimum), max(_fitts(distance), EASY_MARGIN * minimum))
        return natural_time(natural, minimum, self.manner.temporal, weakness)

    def _blend(self, effort_value: float, plain: float) -> float:
        """Interpolate between plain and effort value by the gesture's weight."""
        return plain + self.traits.weight * (effort_value - plain)

    def _relative_distance(self, distance: float, usual: float) -> float:
        """Return distance [m] / reference distance [arm lengths] as a ratio."""
        return max(distance / self.pace.robot.arm_length, MIN_DISTANCE) / usual


def _fitts(distance: float) -> float:
    """Return the duration of a hand movement by Fitts' law [s].

    It depends on neither phase nor gesture.
    """
    return FITTS_INTERCEPT + FITTS_SLOPE * log2(distance / FITTS_WIDTH + 1.0)
