"""Faces and sounds of running blocks: tracks of action units, and sounds on the clock."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import RATE
from kinesic.body.utterance import Sound
from kinesic.planning.face_track import asks_face, shown_units
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene
from kinesic.speech.loudspeaker import SpeakerError
from kinesic.speech.speaker import Speaker


@dataclass(frozen=True)
class SoundAndFace:
    """Whether faces and sounds of a scene have sinks."""

    face: bool = False  # a sink shows it
    sound: bool = False  # speech is heard


SILENT = SoundAndFace()


@dataclass(frozen=True, eq=False)
class Track:
    """Face and sounds of one running block."""

    begin: float  # [s] of the clock, of the first row
    face: Mapping[str, Floats]  # action unit -> (m,) 0..1, 100 a second
    sounds: tuple[tuple[float, Sound], ...]  # [s] of the clock at which each begins

    def at(self, time: float) -> dict[str, float]:
        """Looks up action units at a time [s] of the clock; none before and after."""
        row = int((time - self.begin) * RATE)
        return {unit: float(values[row]) for unit, values in self.face.items() if 0 <= row < len(values)}


Sounds = Mapping[tuple[str, float], Sound]  # by block and the time [s] of the clock at which each begins
Version = tuple[int, float, float, int]  # of a block: it has another one when its track has to be made anew


def track_version(running: RunningBlock) -> Version:
    """Identifies what a block's track was made of; another version needs another track."""
    return id(running.prepared.plan), running.zero, running.end, len(running.times)


def make_track(running: RunningBlock, accompaniment: SoundAndFace) -> Track:
    """Makes the track of a block that plays."""
    plan, zero = running.prepared.plan, running.zero
    begin = zero - plan.trajectory.zero
    sounds = tuple(
        (spoken.begin, found) for spoken in running.speeches if (found := spoken.utterance.sound) is not None
    )
    is_seen = accompaniment.face and (asks_face(plan) or plan.setup.idling.amount > 0.0)
    times = np.arange(int(plan.duration * RATE) + 1) / RATE
    return Track(begin, shown_units(plan, times) if is_seen else {}, sounds if accompaniment.sound else ())


def changed_tracks(
    scene: Scene, known: Mapping[str, Version], accompaniment: SoundAndFace
) -> tuple[dict[str, Version], dict[str, Track | None]]:
    """Makes the tracks of a scene that have changed; returns the versions of all, too.

    Args:
        scene: whose blocks play.
        known: versions of the tracks that the loop has.
        accompaniment: whether faces and sounds have sinks.
    """
    if not (accompaniment.face or accompaniment.sound):
        return {}, {}
    resting = () if scene.idle is None else (scene.idle,)
    playing = {running.id: running for running in (*resting, *scene.playing)}
    versions = {id: track_version(running) for id, running in playing.items()}
    over: dict[str, Track | None] = dict.fromkeys(known.keys() - versions.keys())
    fresh = [id for id, own in versions.items() if known.get(id) != own]
    return versions, over | {id: make_track(playing[id], accompaniment) for id in fresh}


class Effects:
    """The tracks of all running blocks, as the loop has them."""

    def __init__(self, speaker: Speaker | None = None, *, face: bool = False) -> None:
        """Begins without tracks.

        Args:
            speaker: of sounds; None: nothing is heard.
            face: whether a sink shows it.
        """
        self._speaker, self._tracks = speaker, dict[str, Track]()
        self.accompaniment = SoundAndFace(face, speaker is not None)

    def take(self, changes: Mapping[str, Track | None]) -> None:
        """Takes new tracks by block, and drops those that are None. A loudspeaker that fails is not asked again."""
        before = self._sounds()
        for block, one in changes.items():
            self._tracks.pop(block, None)
            if one is not None:
                self._tracks[block] = one
        try:
            self._play(before, self._sounds())
        except SpeakerError:
            self._speaker = None

    def _play(self, before: Sounds, after: Sounds) -> None:
        """Plays new sounds; one that is gone can only be ended together with all others."""
        if self._speaker is None:
            return
        if before.keys() - after.keys():
            self._speaker.stop()
            before = {}
        for block, begin in after.keys() - before.keys():
            self._speaker.play(after[block, begin], begin)

    def clear(self) -> None:
        """Ends everything at once."""
        self.take(dict.fromkeys(self._tracks))

    def face(self, time: float) -> dict[str, float]:
        """Finds the greatest intensity of each action unit at a time [s] of the clock."""
        found: dict[str, float] = {}
        for one in self._tracks.values():
            for unit, value in one.at(time).items():
                found[unit] = max(value, found.get(unit, 0.0))
        return found

    def _sounds(self) -> Sounds:
        return {(block, begin): sound for block, one in self._tracks.items() for begin, sound in one.sounds}
