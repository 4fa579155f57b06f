"""What the supervisor tells: its status into the channel, events into the channel and the journal."""

from math import nan

from kinesic.hardware.registers import Register
from kinesic.hardware.supervisor.channel import Channel, Note, Status
from kinesic.hardware.supervisor.journal import Journal
from kinesic.hardware.supervisor.manifest import Manifest
from kinesic.hardware.supervisor.stages import State
from kinesic.hardware.supervisor.steering import Steering
from kinesic.hardware.supervisor.watch import Watch

VOLT = Register.PRESENT_INPUT_VOLTAGE.field.scale


class Teller:
    """The way to the planner, and to the file."""

    def __init__(self, manifest: Manifest, channel: Channel, journal: Journal) -> None:
        """Of a supervisor of this manifest."""
        self._manifest, self._channel, self._journal = manifest, channel, journal

    def note(self, clock: float, kind: str, text: str, servo: int = -1) -> None:
        """Tells of an event at a time [s]."""
        note = Note(clock, servo, kind, text)
        self._channel.note(note)
        self._journal.write(note)

    def tell(self, clock: float, state: State, watch: Watch, steering: Steering, late: int) -> None:
        """Tells how it is at a time [s]; `late` cycles so far began too late."""
        player, records = steering.player, watch.records
        self._channel.tell(
            Status(
                stage=state.stage,
                clock=clock,
                time=player.tempo.time if player.begun else nan,
                scale=player.tempo.scale,
                energised=int(watch.energised.sum()),
                hottest=float(records["temperature"].max()) if records is not None else nan,
                volts=float(records["volts"].min()) * VOLT if records is not None else nan,
                silent=int((~watch.heard).sum()),
                late=late,
                faulty=state.faulty,
                angles=self._manifest.angles(watch.present),
                goals=steering.angles,
            )
        )
