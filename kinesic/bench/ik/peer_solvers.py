"""Other libraries, each asked for angles that bring the hand to a position, as its own documentation asks it.

They read the arm as a URDF of the hinges that carry the hand. They start at rest and may stop half a millimetre from
the target. Differential libraries (mink, pink, placo) are driven to convergence by a loop here. None was tuned for this
arm. What they need is imported when a solver is built.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from kinesic.body.arrays import Floats
from kinesic.body.chain import Chain
from kinesic.body.skeleton import Hinge

BASE, HAND = "base", "hand"  # links of the URDF
FAST = 1e6  # [rad/s, Nm] no limit that a search could feel
if TYPE_CHECKING:
    import roboticstoolbox as rtb

Solver = Callable[[Floats], Floats]  # (3,) [m] in the chain's base -> (k,) [rad] of its hinges

NEAR = 5e-4  # [m] where a search may stop
STEPS = 100  # of a differential library
PATIENCE = 0.1  # [s] of a library that begins again until it is there
DAMPING = 1e-6  # of their quadratic programs


@dataclass(frozen=True, eq=False)
class WristHinge:
    """A hinge that moves the hand's centre, and where it sits."""

    hinge: Hinge
    offset: Floats  # (3,) [m] from the hinge before it, in that one's segment


def carriers(chain: Chain) -> tuple[WristHinge, ...]:
    """Lists the hinges up to the hand's centre.

    The last joint sits in this centre and turns around it: peers are spared its hinges.
    """
    offsets = [chain.origin_in_base, *(joint.bone for joint in chain.joints)]
    return tuple(
        WristHinge(hinge, offset if k == 0 else np.zeros(3))
        for joint, offset in zip(chain.joints[:-1], offsets, strict=False)
        for k, hinge in enumerate(joint.hinges)
    )


def forearm(chain: Chain) -> Floats:
    """(3,) [m] from the last carrier to the hand's centre."""
    return chain.joints[-2].bone


def urdf(chain: Chain) -> str:
    """Writes the arm as URDF: links `base`, one behind each hinge with its name, and `hand` in the hand's centre.

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


def _joint(carrier: WristHinge, *, parent: str, child: str) -> str:
    hinge = carrier.hinge
    limit = f'lower="{hinge.lower!r}" upper="{hinge.upper!r}" velocity="{FAST}" effort="{FAST}"'
    return f"""<joint name="{hinge.name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="{_numbers(carrier.offset)}"/><axis xyz="{_numbers(hinge.axis)}"/><limit {limit}/></joint>
"""


def _numbers(values: Floats) -> str:
    return " ".join(repr(float(value)) for value in values)


@dataclass(frozen=True)
class Peer:
    """A library and how it solves."""

    name: str  # of its module
    package: str  # as it is installed
    needs: tuple[str, ...]  # modules
    build: Callable[[Chain], Solver]


def roboticstoolbox(chain: Chain) -> Solver:
    """Levenberg-Marquardt with random restarts, in C, on a row of elementary transforms.

    Raises:
        ValueError: an axis is none of x, y, z and their opposites.
    """
    import roboticstoolbox as rtb  # noqa: PLC0415 - optional

    row = [transform for carrier in carriers(chain) for transform in (*_moves(carrier.offset), _turn(carrier))]
    arm = rtb.ETS([*row, *_moves(forearm(chain))])
    start = chain.rest[: arm.n].copy()
    pose = np.eye(4)
    position_only = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    cost = 0.5 * NEAR**2  # half the square of the error

    def solve(target: Floats) -> Floats:
        pose[:3, 3] = target
        found = arm.ik_LM(pose, q0=start, tol=cost, mask=position_only)
        return _whole(chain, found.q)

    return solve


def ikpy(chain: Chain) -> Solver:
    """Bounded least squares of SciPy over a chain of links."""
    from ikpy.chain import Chain as Links  # noqa: PLC0415 - optional
    from ikpy.link import OriginLink, URDFLink  # noqa: PLC0415 - optional

    level = [0.0, 0.0, 0.0]
    turning = [
        URDFLink(carrier.hinge.name, carrier.offset, level, carrier.hinge.axis, bounds=_bounds(carrier))
        for carrier in carriers(chain)
    ]
    hand = URDFLink(HAND, forearm(chain), level, joint_type="fixed")
    arm = Links([OriginLink(), *turning, hand], active_links_mask=[False, *(True for _ in turning), False])
    start = np.array([0.0, *chain.rest[: len(turning)], 0.0])

    def solve(target: Floats) -> Floats:
        return _whole(chain, arm.inverse_kinematics(target, initial_position=start)[1:-1])

    return solve


def mink(chain: Chain) -> Solver:
    """Differential inverse kinematics on MuJoCo."""
    import mink as library  # noqa: PLC0415 - optional
    import mujoco  # noqa: PLC0415 - only this bench needs it here

    configuration = library.Configuration(mujoco.MjModel.from_xml_string(urdf(chain)))
    limits = [library.ConfigurationLimit(configuration.model)]
    task = library.FrameTask(HAND, "body", position_cost=1.0, orientation_cost=0.0)
    start = chain.rest[: configuration.model.nq].copy()

    def solve(target: Floats) -> Floats:
        configuration.update(start)
        task.set_target(library.SE3.from_translation(target))
        for _ in range(STEPS):
            if np.linalg.norm(task.compute_error(configuration)[:3]) < NEAR:
                break
            try:
                step = library.solve_ik(configuration, [task], 1.0, "daqp", damping=DAMPING, limits=limits)
            except library.NoSolutionFound:
                break
            configuration.integrate_inplace(step, 1.0)
        return _whole(chain, configuration.q)

    return solve


def pink(chain: Chain) -> Solver:
    """Differential inverse kinematics on Pinocchio."""
    import pink as library  # noqa: PLC0415 - optional
    import pinocchio  # noqa: PLC0415 - comes with it

    model = pinocchio.buildModelFromXML(urdf(chain))
    data, start = model.createData(), chain.rest[: model.nq].copy()
    task = library.FrameTask(HAND, position_cost=1.0, orientation_cost=0.0)

    def solve(target: Floats) -> Floats:
        configuration = library.Configuration(model, data, start)
        task.set_target(pinocchio.SE3(np.eye(3), target))
        for _ in range(STEPS):
            if np.linalg.norm(task.compute_error(configuration)[:3]) < NEAR:
                break
            try:
                step = library.solve_ik(configuration, [task], 1.0, "daqp", damping=DAMPING, safety_break=False)
            except library.exceptions.NoSolutionFound:
                break
            # rounding would otherwise leave the limits, and be warned of at every step
            moved = configuration.integrate(step, 1.0)
            configuration.update(np.clip(moved, model.lowerPositionLimit, model.upperPositionLimit))
        return _whole(chain, configuration.q)

    return solve


def placo(chain: Chain) -> Solver:
    """Task-space inverse kinematics by quadratic programs in C++, on Pinocchio."""
    import placo as library  # noqa: PLC0415 - optional

    robot = library.RobotWrapper("", library.Flags.ignore_collisions, urdf(chain))
    solver = library.KinematicsSolver(robot)
    solver.mask_fbase(True)
    solver.enable_joint_limits(True)
    task = solver.add_position_task(HAND, np.zeros(3))
    task.configure(HAND, "soft", 1.0)
    solver.add_regularization_task(DAMPING)
    free = len(robot.state.q) - len(carriers(chain))  # the pose of its floating base
    start = np.array([*robot.state.q[:free], *chain.rest[: len(carriers(chain))]])

    def solve(target: Floats) -> Floats:
        robot.state.q = start
        robot.update_kinematics()
        task.target_world = target
        for _ in range(STEPS):
            solver.solve(True)
            robot.update_kinematics()
            if np.linalg.norm(robot.get_T_world_frame(HAND)[:3, 3] - target) < NEAR:
                break
        return _whole(chain, robot.state.q[free:])

    return solve


def optik(chain: Chain) -> Solver:
    """Nonlinear least squares with random restarts, in Rust; it knows poses alone: turning weighs nothing."""
    from optik import Robot, SolverConfig  # noqa: PLC0415 - optional

    with TemporaryDirectory() as folder:
        path = Path(folder, "arm.urdf")
        path.write_text(urdf(chain), encoding="utf-8")
        robot = Robot.from_urdf_file(str(path), BASE, HAND)
    robot.set_parallelism(1)
    count = len(carriers(chain))
    config = SolverConfig(
        solution_mode="speed", max_time=PATIENCE, tol_f=NEAR**2, linear_weight=[1.0] * 3, angular_weight=[0.0] * 3
    )
    start, pose = chain.rest[:count].tolist(), np.eye(4)

    def solve(target: Floats) -> Floats:
        pose[:3, 3] = target
        found = robot.ik(config, pose, start)
        return chain.rest if found is None else _whole(chain, np.array(found[0]))

    return solve


def _moves(offset: Floats) -> list["rtb.ET"]:
    """Translations along x, y and z."""
    import roboticstoolbox as rtb  # noqa: PLC0415 - optional

    along = (rtb.ET.tx, rtb.ET.ty, rtb.ET.tz)
    return [move(float(length)) for move, length in zip(along, offset, strict=True) if length != 0.0]


def _turn(carrier: WristHinge) -> "rtb.ET":
    """A rotation by the hinge's angle, flipped where its axis is an opposite one.

    Raises:
        ValueError: its axis is none of x, y, z and their opposites.
    """
    import roboticstoolbox as rtb  # noqa: PLC0415 - optional

    hinge = carrier.hinge
    main = int(np.argmax(np.abs(hinge.axis)))
    if np.count_nonzero(hinge.axis) != 1:
        raise ValueError(f"{hinge.name}: axis {hinge.axis.tolist()} has no elementary transform; x, y or z would have")
    turn = (rtb.ET.Rx, rtb.ET.Ry, rtb.ET.Rz)[main]
    return turn(flip=bool(hinge.axis[main] < 0.0), qlim=np.array(_bounds(carrier)))


def _bounds(carrier: WristHinge) -> tuple[float, float]:
    return carrier.hinge.lower, carrier.hinge.upper


def _whole(chain: Chain, angles: Floats) -> Floats:
    """The hinges that a peer was spared stay at rest."""
    whole = chain.rest.copy()
    whole[: len(angles)] = angles
    return whole


PEERS = (
    Peer("roboticstoolbox", "roboticstoolbox-python", ("roboticstoolbox",), roboticstoolbox),
    Peer("optik", "optik-py", ("optik",), optik),
    Peer("placo", "placo", ("placo",), placo),
    Peer("mink", "mink", ("mink", "mujoco", "daqp"), mink),
    Peer("pink", "pin-pink", ("pink", "pinocchio", "daqp"), pink),
    Peer("ikpy", "ikpy", ("ikpy",), ikpy),
)
