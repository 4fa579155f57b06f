"""Corrections of the joint mapping that a person requests (`--map JOINT=HINGE`)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from kinesic.body.config import ConfigError, suggestion
from kinesic.sim.importer.arm import Split
from kinesic.sim.importer.hinge_names import list_hinge_names
from kinesic.sim.importer.mirror import Sides
from kinesic.sim.importer.model_tree import Tree

NO_HINGE = "none"  # value of a joint that is held
ARM_PREFIXES = ("l_", "r_")  # prefixes of the hinge names of both arms


@dataclass(frozen=True)
class Wishes:
    """Hinges that a person requests for some joints of a robot."""

    hinges: Mapping[int, str]  # index of a joint -> name of its hinge

    @property
    def arm_joints(self) -> frozenset[int]:
        """Indices of the joints that belong to arms."""
        return frozenset(k for k, hinge in self.hinges.items() if hinge.startswith(ARM_PREFIXES))

    def orient(self, sides: Sides) -> Sides:
        """Exchange left and right if most requested hinges contradict the sides."""
        partners = {right: left for left, right in sides.pairs.items()}
        votes = 0
        for k in self.arm_joints:
            is_left = self.hinges[k].startswith("l_")
            votes += (1 if is_left else -1) * ((k in sides.pairs) - (k in partners))
        if votes >= 0:
            return sides
        return replace(sides, pairs=partners, left=(-sides.left[0], -sides.left[1]), certain=True)

    def on_both_sides(self, sides: Sides) -> "Wishes":
        """Return these wishes, with mirror images for joints without a wish."""
        partners = dict(sides.pairs) | {right: left for left, right in sides.pairs.items()}
        images = {
            partners[k]: ("r_" if self.hinges[k].startswith("l_") else "l_") + self.hinges[k][2:]
            for k in self.arm_joints
            if k in partners
        }
        return Wishes(images | dict(self.hinges))

    def allows(self, split: Split, arm: Sequence[int]) -> bool:
        """Return whether requested hinge names agree with an arm's division into joints."""
        ends = {
            "sternoclavicular": (0, split.girdle),
            "shoulder": (split.girdle, split.elbow),
            "elbow": (split.elbow, split.elbow + 2),
            "wrist": (split.elbow + 1, split.hinges),
        }
        for place, k in enumerate(arm):
            part = self.hinges.get(k, "")[2:].split("_")[0]
            if part in ends and not ends[part][0] <= place < ends[part][1]:
                return False
            if self.hinges.get(k, "").endswith("elbow_flexion") and place != split.elbow:
                return False
        return True


NO_WISHES = Wishes({})  # default: no requested hinges


def read_wishes(tree: Tree, texts: Sequence[str]) -> tuple[Tree, Wishes]:
    """Parse requested hinges, and immobilise joints that are mapped to `none`.

    Args:
        tree: Robot as in the file.
        texts: JOINT=HINGE, or JOINT=none for a joint that is held.

    Raises:
        ConfigError: a text has another form, or a joint or hinge is unknown.
    """
    wished: dict[str, str] = {}
    names = [joint.name for joint in tree.joints]
    for text in texts:
        joint, _, hinge = text.rpartition("=")
        if not joint:
            raise ConfigError(f"--map {text}: write JOINT=HINGE, or JOINT=none for a joint that is held")
        if joint not in names:
            raise ConfigError(f"--map {text}: {tree.name} has no joint {joint}{suggestion(joint, names)}")
        if hinge != NO_HINGE and hinge not in list_hinge_names():
            raise ConfigError(f"--map {text}: no hinge {hinge}{suggestion(hinge, list_hinge_names())}")
        wished[joint] = hinge
    kept = tree.without({names.index(joint) for joint, hinge in wished.items() if hinge == NO_HINGE})
    return kept, Wishes({k: wished[joint.name] for k, joint in enumerate(kept.joints) if joint.name in wished})
