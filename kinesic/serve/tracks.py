"""Face and sound tracks of running blocks."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, nan

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.command import COMMAND_RATE
from kinesic.body.utterance import Sound
from kinesic.planning.face_track import compute_action_units, needs_face
from kinesic.realizer.followed_face import followed_action_units
from kinesic.realizer.running_block import RunningBlock
from kinesic.realizer.scene import Scene
from kinesic.speech.loudspeaker import SpeakerError
from kinesic.speech.speaker import Speaker


@dataclass(frozen=True)
class SoundAndFace:
    """Availability of outputs for speech sound and face."""

    face: bool = False  # whether an output (sink) shows the face
    sound: bool = False  # whether speech is audible


FOREIGN_SOUND = "conversation:sound"  # key of the track of a client's speech sound
FOLLOWED_FACE = "conversation:face"  # key of the face track of a robot that follows people
EYE_UNITS = ("61", "62", "63", "64")  # action units of the gaze
NO_ACCOMPANIMENT = SoundAndFace()  # default: neither a face nor sound is output


@dataclass(frozen=True, eq=False)
class Track:
    """Action unit intensities and sounds of one running block over time."""

    begin: float  # [s] clock time of the first row
    face: Mapping[str, Floats]  # action unit -> (m,) intensities 0..1 at 100 Hz
    sounds: tuple[tuple[float, Sound], ...]  # start [s] in clock time, and sound
    is_held: bool = False  # whether the last row is held after the end

    def at(self, time: float) -> dict[str, float]:
        """Return action unit intensities 0..1 at a clock time [s].

        Empty outside the track.
        """
        row = int((time - self.begin) * COMMAND_RATE)
        if self.is_held and self.face:
            row = min(row, min(map(len, self.face.values())) - 1)
        return {unit: float(values[row]) for unit, values in self.face.items() if 0 <= row < len(values)}


Sounds = Mapping[tuple[str, float], Sound]  # by block and start [s] in clock time
Version = tuple[int, float, float, int]  # identity of the inputs of a block's track


def track_version(running: RunningBlock) -> Version:
    """Return a key that changes when a block needs a new track."""
    return id(running.prepared.plan), running.zero, running.end, len(running.times)


def make_track(running: RunningBlock, accompaniment: SoundAndFace) -> Track:
    """Compute the face and sound track of a running block."""
    plan, zero = running.prepared.plan, running.zero
    begin = zero - plan.trajectory.zero
    sounds = tuple(
        (speech.begin, sound) for speech in running.speeches if (sound := speech.utterance.sound) is not None
    )
    shows_face = accompaniment.face and (needs_face(plan) or plan.setup.idling.amount > 0.0)
    times = np.arange(int(plan.duration * COMMAND_RATE) + 1) / COMMAND_RATE
    return Track(begin, compute_action_units(plan, times) if shows_face else {}, sounds if accompaniment.sound else ())


def changed_tracks(
    scene: Scene, old_versions: Mapping[str, Version], accompaniment: SoundAndFace, now: float = 0.0
) -> tuple[dict[str, Version], dict[str, Track | None]]:
    """Return the versions of all tracks, and the changed tracks.

    A track of an ended block is None.

    Args:
        scene: running blocks.
        old_versions: versions of the tracks that the loop has.
        accompaniment: available outputs for face and sound.
        now: clock time [s], from which the face of a robot that follows people is computed.
    """
    if not (accompaniment.face or accompaniment.sound):
        return {}, {}
    idling = () if scene.idle is None else (scene.idle,)
    playing = {running.id: running for running in (*idling, *scene.playing)}
    versions = {id: track_version(running) for id, running in playing.items()}
    face = scene.followed_face if accompaniment.face else None
    if face is not None:
        versions[FOLLOWED_FACE] = (id(scene.motion), face.begin, face.expression.begin, id(face))
    sound = scene.foreign_sound
    if sound is not None:
        versions[FOREIGN_SOUND] = (id(sound), sound.begin, sound.duration, len(sound.pieces))
    ended: dict[str, Track | None] = dict.fromkeys(old_versions.keys() - versions.keys())
    changed = [id for id, version in versions.items() if old_versions.get(id) != version]
    tracks = {id: make_track(playing[id], accompaniment) for id in changed if id in playing}
    if sound is not None and FOREIGN_SOUND in changed:
        units, pieces = sound.face if accompaniment.face else {}, sound.pieces if accompaniment.sound else ()
        tracks[FOREIGN_SOUND] = Track(sound.face_begin, units, pieces)
    if face is not None and FOLLOWED_FACE in changed:
        tracks[FOLLOWED_FACE] = Track(now, followed_action_units(scene, face, now), (), is_held=True)
    return versions, ended | tracks


class TrackEffects:
    """Player of the face and sound tracks of all running blocks."""

    def __init__(self, speaker: Speaker | None = None, *, face: bool = False) -> None:
        """Create an empty set of tracks.

        Args:
            speaker: audio output; None for silence.
            face: whether a sink shows the face.
        """
        self._speaker, self._tracks = speaker, dict[str, Track]()
        self._silenced = set[str]()  # blocks whose sounds have faded out early
        self.accompaniment = SoundAndFace(face, speaker is not None)

    def take(self, changes: Mapping[str, Track | None]) -> None:
        """Replace the tracks of the given blocks, removing tracks given as None.

        A loudspeaker that fails is not used again.
        """
        before = self._sounds()
        for block, track in changes.items():
            self._tracks.pop(block, None)
            if track is not None:
                self._tracks[block] = track
            else:
                self._silenced.discard(block)
        self._play(before, self._sounds())

    def silence(self, block: str | None) -> None:
        """Fade out the sounds of one block, or of all blocks."""
        before = self._sounds()
        self._silenced |= self._tracks.keys() if block is None else {block} & self._tracks.keys()
        self._play(before, self._sounds())

    def duck(self, *, on: bool) -> None:
        """Mute all sounds, or let them be heard again."""
        if self._speaker is not None:
            self._speaker.mute(on=on)

    def _play(self, before: Sounds, after: Sounds) -> None:
        """Play sounds that were added, and fade out sounds that were removed."""
        if self._speaker is None:
            return
        try:
            for block, begin in before.keys() - after.keys():
                self._speaker.fade_out(before[block, begin], begin)
            for block, begin in after.keys() - before.keys():
                self._speaker.play(after[block, begin], begin)
        except SpeakerError:
            self._speaker = None

    def clear(self) -> None:
        """Remove all tracks and stop all sounds at once, without a fade."""
        self._tracks.clear()
        self._silenced.clear()
        if self._speaker is not None:
            self._speaker.stop()
            self._speaker.mute(on=False)

    def face(self, time: float) -> dict[str, float]:
        """Return maximum action unit intensities of all tracks at a time [s].

        The eyes of a robot that follows people replace those of blocks, unless a block determines the gaze.
        """
        followed = self._tracks.get(FOLLOWED_FACE)
        shown = {} if followed is None else followed.at(time)
        looks = any(isfinite(shown.get(unit, nan)) for unit in EYE_UNITS)
        intensities = {unit: value for unit, value in shown.items() if isfinite(value)}
        for name, track in self._tracks.items():
            for unit, value in track.at(time).items() if name != FOLLOWED_FACE else ():
                if not (looks and unit in EYE_UNITS):
                    intensities[unit] = max(value, intensities.get(unit, 0.0))
        return intensities

    def _sounds(self) -> Sounds:
        return {
            (block, begin): sound
            for block, track in self._tracks.items()
            if block not in self._silenced
            for begin, sound in track.sounds
        }
