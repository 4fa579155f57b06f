"""Distances of a robot with one hinge from a wall."""

from kinesic.body.dynamics import Clearance


class Wall:
    """Wall at angle 0, with one metre of distance per radian."""

    def clearance(self, angles):
        return Clearance(angles[:, 0], [("arm", "wall")] * len(angles))

    def gaps(self, angles):
        return angles

    def bounds(self, angles, turns):
        return (angles - turns)[:, 0]
