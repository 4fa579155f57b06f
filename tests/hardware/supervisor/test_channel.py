import mmap
import os

import numpy as np
import pytest

from kinesic.hardware.supervisor.caps import ServoCaps
from kinesic.hardware.supervisor.channel import (
    EVENT_CAPACITY,
    STATUS_CAPACITY,
    Channel,
    Status,
    map_memory,
    memory_file,
    memory_size,
)
from kinesic.hardware.supervisor.notes import Note
from kinesic.hardware.supervisor.state_machine import Stage

JOINTS = 3  # number of joints of the robot
CAPACITY = 8  # [commands] size of the command buffer


@pytest.fixture
def ends() -> tuple[Channel, Channel]:
    """Return the planner's and the supervisor's end of a channel."""
    memory = mmap.mmap(-1, memory_size(JOINTS, CAPACITY))
    return Channel(memory, JOINTS, CAPACITY), Channel(memory, JOINTS, CAPACITY)


def test_channel_returns_commands_once_and_in_order(ends):
    planner, supervisor = ends
    for k in range(5):
        assert planner.write(k / 10, np.full(JOINTS, float(k)))
    result = supervisor.commands(3) + supervisor.commands(9)
    assert [time for time, _, _ in result] == [0.0, 0.1, 0.2, 0.3, 0.4]
    assert all((leads == 0.0).all() for _, _, leads in result)
    assert [goals.tolist() for _, goals, _ in result] == [[float(k)] * JOINTS for k in range(5)]
    assert supervisor.commands(9) == []


def test_full_command_buffer_refuses_commands_until_some_are_read(ends):
    planner, supervisor = ends
    written = [planner.write(float(k), np.zeros(JOINTS)) for k in range(CAPACITY + 2)]
    assert written == [True] * CAPACITY + [False, False]
    assert len(supervisor.commands(4)) == 4
    assert planner.room == 4
    for k in range(100):
        assert planner.write(10.0 + k, np.zeros(JOINTS))
        assert supervisor.commands(1)


def test_command_row_written_incompletely_is_not_read(ends):
    planner, supervisor = ends
    planner.write(1.0, np.ones(JOINTS))
    planner._ring[0]["goals"][1] = 7.0
    assert supervisor.commands(9) == []
    planner._ring[0]["goals"][1] = 1.0
    assert len(supervisor.commands(9)) == 1


def test_supervisor_channel_returns_the_latest_status(ends):
    planner, supervisor = ends
    assert planner.status().stage is Stage.CLOSED
    assert np.isnan(planner.status().time)
    for k in range(3):
        supervisor.write_status(
            Status(
                Stage.ACTIVE,
                clock=5.0 + k,
                time=1.0 + k,
                scale=0.5,
                energised=4,
                angles=np.ones(3),
                setpoints=np.zeros(3),
                taken=np.zeros(3),
            )
        )
    status = planner.status()
    assert (status.stage, status.time, status.energised) == (Stage.ACTIVE, 3.0, 4)
    assert status.angles.tolist() == [1.0] * 3
    assert status.time_at(7.2) == pytest.approx(3.1)


def test_status_history_returns_each_status_once_and_drops_the_oldest_if_its_buffer_is_full(ends):
    planner, supervisor = ends
    vectors = {name: np.zeros(3) for name in ("angles", "setpoints", "taken")}
    for k in range(STATUS_CAPACITY + 10):
        supervisor.write_status(Status(Stage.HOLD, clock=float(k), **vectors))
    clocks = [item.clock for item in planner.history()]
    assert clocks == [float(k) for k in range(10, STATUS_CAPACITY + 10)]
    assert planner.history() == ()


def test_supervisor_channel_returns_each_event_once(ends):
    planner, supervisor = ends
    supervisor.note(Note(1.0, 3, "error", "hardware error 0x00 -> 0x20"))
    assert planner.notes() == (Note(1.0, 3, "error", "hardware error 0x00 -> 0x20"),)
    assert planner.notes() == ()
    for k in range(EVENT_CAPACITY + 5):
        supervisor.note(Note(float(k), -1, "stage", "x" * 100))
    assert [note.clock for note in planner.notes()] == [float(k) for k in range(5, EVENT_CAPACITY + 5)]


def test_planner_request_can_be_read_by_the_supervisor(ends):
    planner, supervisor = ends
    planner.set("estop", 2)
    assert supervisor.word("estop") == 2


def test_supervisor_channel_memory_is_shared_by_descriptor_without_a_file_name():
    octets = memory_size(JOINTS, CAPACITY)
    descriptor = memory_file(octets)
    one, other = (Channel(map_memory(descriptor, octets), JOINTS, CAPACITY) for _ in range(2))
    os.close(descriptor)
    one.write(1.0, np.zeros(JOINTS))
    assert len(other.commands(9)) == 1


def test_long_event_text_in_the_supervisor_channel_is_not_truncated(ends):
    planner, supervisor = ends
    long_note = Note(1.0, -1, "refused", "\N{DEGREE SIGN} too slow; " * 100)
    for note in (Note(0.5, 3, "error", ""), long_note, Note(2.0, 4, "silent", "short")):
        supervisor.note(note)
    assert planner.notes() == (Note(0.5, 3, "error", ""), long_note, Note(2.0, 4, "silent", "short"))


def test_continuation_row_of_an_event_text_without_its_first_row_is_skipped(ends):
    planner, supervisor = ends
    supervisor.note(Note(1.0, -1, "refused", "x" * 900))
    for k in range(EVENT_CAPACITY - 2):
        supervisor.note(Note(2.0, k, "silent", "short"))
    notes = planner.notes()
    assert [note.servo for note in notes] == list(range(EVENT_CAPACITY - 2))


def test_channel_returns_the_newest_caps_once(ends):
    planner, supervisor = ends
    assert supervisor.caps() is None
    for k in range(6):
        planner.write_caps(ServoCaps(*(np.full(JOINTS, 10.0 * k + part) for part in range(3))))
    caps = supervisor.caps()
    assert [values[0] for values in (caps.velocities, caps.duties, caps.holding)] == [50.0, 51.0, 52.0]
    assert supervisor.caps() is None
