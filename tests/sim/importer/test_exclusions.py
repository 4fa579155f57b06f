from dataclasses import replace

import msgspec

from kinesic.sim.distances import CapsuleDistances
from kinesic.sim.importer.draft import robot_of
from kinesic.sim.importer.exclusions import with_exclusions


def test_pairs_that_count_have_room_at_rest(tee_mapped, tee_path):
    robot = robot_of(tee_mapped.file, tee_path)
    rest = CapsuleDistances(robot).clearance(robot.skeleton.rest[None])
    assert rest.distances[0] >= robot.least_clearance


def test_shapes_that_overlap_at_rest_are_listed_with_a_reason(tee_mapped, tee_path):
    fat = [
        msgspec.structs.replace(body, capsules=[msgspec.structs.replace(body.capsules[0], radius=0.3)])
        if body.name == "skullbase"
        else body
        for body in tee_mapped.file.body
    ]
    file = with_exclusions(msgspec.structs.replace(tee_mapped.file, body=fat), tee_path)
    listed = {frozenset(entry.pair): entry.why for entry in file.collision.exclude}
    assert "apart at rest" in listed[frozenset(("skullbase", "l_shoulder"))]
    robot = robot_of(file, tee_path)
    assert CapsuleDistances(replace(robot)).clearance(robot.skeleton.rest[None]).distances[0] >= robot.least_clearance
