"""An arm as other libraries read it: the hinges that carry the hand, each with its offset, and the same in URDF."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.skeleton import Hinge

BASE, HAND = "base", "hand"  # links of the URDF
FAST = 1e6  # [rad/s, Nm] no limit that a search could feel


@dataclass(frozen=True, eq=False)
class Carrier:
    """A hinge that moves the hand's centre, and where it sits."""

    hinge: Hinge
    offset: Floats  # (3,) [m] from the hinge before it, in that one's segment


def carriers(chain: Chain) -> tuple[Carrier, ...]:
    """The hinges up to the hand's centre.

    The last joint sits in this centre and turns around it: peers are spared its hinges.
    """
    offsets = [chain.origin_in_base, *(joint.bone for joint in chain.joints)]
    return tuple(
        Carrier(hinge, offset if k == 0 else np.zeros(3))
        for joint, offset in zip(chain.joints[:-1], offsets, strict=False)
        for k, hinge in enumerate(joint.hinges)
    )


def forearm(chain: Chain) -> Floats:
    """(3,) [m] from the last carrier to the hand's centre."""
    return chain.joints[-2].bone


def urdf(chain: Chain) -> str:
    """The arm as URDF text: links `base`, one behind each hinge with its name, and `hand` in the hand's centre.

    Every link weighs something, because readers refuse moving links without mass; nothing here depends on it.
    """
    links = [BASE, *(carrier.hinge.name for carrier in carriers(chain)), HAND]
    joints = [
        _joint(carrier, parent=parent, child=child)
        for carrier, (parent, child) in zip(carriers(chain), pairwise(links), strict=False)
    ]
    # MuJoCo would merge the hand into the forearm
    return f"""<robot name="arm"><mujoco><compiler fusestatic="false"/></mujoco>
{"".join(_link(link) for link in links)}{"".join(joints)}
<joint name="{HAND}_fixed" type="fixed"><parent link="{links[-2]}"/><child link="{HAND}"/>
<origin xyz="{_numbers(forearm(chain))}"/></joint></robot>"""


def _link(name: str) -> str:
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="{name}"><inertial><mass value="1"/>{inertia}</inertial></link>\n'


def _joint(carrier: Carrier, *, parent: str, child: str) -> str:
    hinge = carrier.hinge
    limit = f'lower="{hinge.lower!r}" upper="{hinge.upper!r}" velocity="{FAST}" effort="{FAST}"'
    return f"""<joint name="{hinge.name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="{_numbers(carrier.offset)}"/><axis xyz="{_numbers(hinge.axis)}"/><limit {limit}/></joint>
"""


def _numbers(values: Floats) -> str:
    return " ".join(repr(float(value)) for value in values)
