"""Performance of a client's speech sound by mouth, nods and beats."""

from dataclasses import replace
from math import inf, radians

from kinesic.conversation.events import SoundEvent, SoundPiece
from kinesic.realizer.following import nod
from kinesic.realizer.realizer import advance
from kinesic.serve.changeable_scene import ChangeableScene
from kinesic.serve.foreign_voice import NOD_RANGE, ForeignVoice, Stress
from kinesic.serve.wire.protocol import json_answer

PLANNING_TIME = 0.1  # [s] expected time from a request to the start of the block of a beat


class SoundPerformance:
    """Current speech sound of a client, and its effects on the scene."""

    def __init__(self, shared: ChangeableScene) -> None:
        """Create a performance without a sound."""
        self._shared = shared
        self._voice: ForeignVoice | None = None
        self._silenced = ""  # id of a sound that was interrupted, whose later parts are ignored
        self._beat_count = 0

    def next_time(self) -> float:
        """Return the next time [s] at which `advance` must be called."""
        return inf if self._voice is None else self._voice.next_time()

    def take(self, event: SoundEvent, sender: int, now: float) -> None:
        """Take a part or a position of a sound, and perform it.

        A sound with another id replaces the current one.
        """
        self._forget_interrupted()
        if event.id == self._silenced:
            return
        if isinstance(event, SoundPiece):
            if self._voice is None or self._voice.id != event.id:
                self._voice = ForeignVoice(event.id, event.rate, now)
            try:
                self._voice.take(event, now)
            except ValueError as error:
                self._shared.tell(json_answer("refused", do="sound", why=str(error)), sender)
        elif self._voice is not None and self._voice.id == event.id:
            self._voice.move(event, now)
        self._show(now)

    def advance(self, now: float, amplitude: float) -> list[str]:
        """Nod at stressed syllables, and return the BML of planned beats.

        Args:
            now: current time [s].
            amplitude: factor on the angles of nods.
        """
        self._forget_interrupted()
        voice = self._voice
        if voice is None:
            return []
        for stress in voice.pop_nods(now):
            self._nod(amplitude * radians(NOD_RANGE[0] + (NOD_RANGE[1] - NOD_RANGE[0]) * stress.strength))
        if voice.sound(now) is None:
            self._voice = None
            self._show(now)
        return [self._beat_block(stress, now) for stress in voice.pop_beats(now)]

    def end(self) -> None:
        """Forget the current sound."""
        self._voice = None

    def _nod(self, angle: float) -> None:
        self._shared.propose(lambda scene, time: nod(advance(scene, time), angle, time))

    def _show(self, now: float) -> None:
        """Propose the current sound and its mouth."""
        sound = None if self._voice is None else self._voice.sound(now)
        self._shared.propose(lambda scene, time: replace(advance(scene, time), foreign_sound=sound))

    def _forget_interrupted(self) -> None:
        """Forget a sound that an interruption has removed from the scene."""
        if self._voice is not None and self._shared.scene.foreign_sound is None:
            self._silenced, self._voice = self._voice.id, None

    def _beat_block(self, stress: Stress, now: float) -> str:
        """Return the BML block of a beat of one hand."""
        self._beat_count += 1
        side = "RIGHT_HAND" if self._beat_count % 2 else "LEFT_HAND"
        stroke = stress.time - now - PLANNING_TIME
        gesture = f'<gesture id="g" lexeme="BEAT" mode="{side}" stroke="{stroke:.2f}"/>'
        return f'<bml id="beat{self._beat_count}">{gesture}</bml>'
