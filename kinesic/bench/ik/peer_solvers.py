"""Other IK libraries that solve hand positions, called as their documentation says.

They read the arm as a URDF of the joints that carry the hand, start at rest and may stop 0.5 mm from the target.
Differential libraries (mink, pink, placo) are iterated to convergence here. None was tuned for this arm. Their modules
are imported when a solver is built.
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

BASE_LINK = "base"  # URDF link at the chain's base
HAND_LINK = "hand"  # URDF link of the hand
URDF_NO_LIMIT = 1e6  # [rad/s, Nm] velocity and effort that never limit a URDF joint
if TYPE_CHECKING:
    import roboticstoolbox as rtb

Solver = Callable[[Floats], Floats]  # (3,) [m] in the chain's base -> (k,) [rad] joint angles

STOP_DISTANCE = 5e-4  # [m] hand error at which a peer's search may stop
MAX_STEPS = 100  # maximum iterations per target of differential IK libraries
TIME_LIMIT = 0.1  # [s] time limit per target of optik, which restarts at random
QP_DAMPING = 1e-6  # damping of the peers' quadratic programs


@dataclass(frozen=True, eq=False)
class WristHinge:
    """Joint that moves the wrist, with the offset from the previous joint."""

    hinge: Hinge
    offset: Floats  # (3,) [m] offset from the previous joint, in that joint's segment


def list_carriers(chain: Chain) -> tuple[WristHinge, ...]:
    """List the arm joints that move the hand's centre.

    The last joint lies in this centre and turns around it, so the peers do not get it.
    """
    offsets = [chain.origin_in_base, *(joint.bone for joint in chain.joints)]
    return tuple(
        WristHinge(hinge, offset if k == 0 else np.zeros(3))
        for joint, offset in zip(chain.joints[:-1], offsets, strict=False)
        for k, hinge in enumerate(joint.hinges)
    )


def forearm_offset(chain: Chain) -> Floats:
    """Return the hand's offset (3,) [m] from the last joint moving it."""
    return chain.joints[-2].bone


def write_urdf(chain: Chain) -> str:
    """Return the arm as URDF.

    Its links are `base`, one named after each joint, and `hand` in the hand's centre.

    Every link has a mass because some readers refuse moving links without one; the results do not depend on it.
    """
    links = [BASE_LINK, *(carrier.hinge.name for carrier in list_carriers(chain)), HAND_LINK]
    joints = [
        _joint(carrier, parent=parent, child=child)
        for carrier, (parent, child) in zip(list_carriers(chain), pairwise(links), strict=False)
    ]
    # MuJoCo would otherwise merge the hand into the forearm
    return f"""<robot name="arm"><mujoco><compiler fusestatic="false"/></mujoco>
{"".join(_link(link) for link in links)}{"".join(joints)}
<joint name="{HAND_LINK}_fixed" type="fixed"><parent link="{links[-2]}"/><child link="{HAND_LINK}"/>
<origin xyz="{_numbers(forearm_offset(chain))}"/></joint></robot>"""


def _link(name: str) -> str:
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="{name}"><inertial><mass value="1"/>{inertia}</inertial></link>\n'


def _joint(carrier: WristHinge, *, parent: str, child: str) -> str:
    hinge = carrier.hinge
    limit = f'lower="{hinge.lower!r}" upper="{hinge.upper!r}" velocity="{URDF_NO_LIMIT}" effort="{URDF_NO_LIMIT}"'
    return f"""<joint name="{hinge.name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="{_numbers(carrier.offset)}"/><axis xyz="{_numbers(hinge.axis)}"/><limit {limit}/></joint>
"""


def _numbers(values: Floats) -> str:
    return " ".join(repr(float(value)) for value in values)


@dataclass(frozen=True)
class Peer:
    """Another IK library, with a function that builds its solver."""

    name: str  # name of its module
    package: str  # name of its package
    needs: tuple[str, ...]  # required modules
    build: Callable[[Chain], Solver]


def roboticstoolbox(chain: Chain) -> Solver:
    """Build roboticstoolbox's Levenberg-Marquardt solver (in C) with random restarts.

    Raises:
        ValueError: an axis is not parallel to x, y or z.
    """
    import roboticstoolbox as rtb  # noqa: PLC0415 - optional

    row = [
        transform
        for carrier in list_carriers(chain)
        for transform in (*_make_translations(carrier.offset), _make_rotation(carrier))
    ]
    arm = rtb.ETS([*row, *_make_translations(forearm_offset(chain))])
    start = chain.rest[: arm.n].copy()
    pose = np.eye(4)
    position_only = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    cost = 0.5 * STOP_DISTANCE**2  # half of the squared error

    def solve(target: Floats) -> Floats:
        pose[:3, 3] = target
        solution = arm.ik_LM(pose, q0=start, tol=cost, mask=position_only)
        return _fill_angles(chain, solution.q)

    return solve


def ikpy(chain: Chain) -> Solver:
    """Build IKPy's solver: bounded least squares over a chain of links."""
    from ikpy.chain import Chain as Links  # noqa: PLC0415 - optional
    from ikpy.link import OriginLink, URDFLink  # noqa: PLC0415 - optional

    level = [0.0, 0.0, 0.0]
    turning = [
        URDFLink(carrier.hinge.name, carrier.offset, level, carrier.hinge.axis, bounds=_bounds(carrier))
        for carrier in list_carriers(chain)
    ]
    hand = URDFLink(HAND_LINK, forearm_offset(chain), level, joint_type="fixed")
    arm = Links([OriginLink(), *turning, hand], active_links_mask=[False, *(True for _ in turning), False])
    start = np.array([0.0, *chain.rest[: len(turning)], 0.0])

    def solve(target: Floats) -> Floats:
        return _fill_angles(chain, arm.inverse_kinematics(target, initial_position=start)[1:-1])

    return solve


def mink(chain: Chain) -> Solver:
    """Build mink's solver: differential inverse kinematics on MuJoCo."""
    import mink as library  # noqa: PLC0415 - optional
    import mujoco  # noqa: PLC0415 - only needed here

    configuration = library.Configuration(mujoco.MjModel.from_xml_string(write_urdf(chain)))
    limits = [library.ConfigurationLimit(configuration.model)]
    task = library.FrameTask(HAND_LINK, "body", position_cost=1.0, orientation_cost=0.0)
    start = chain.rest[: configuration.model.nq].copy()

    def solve(target: Floats) -> Floats:
        configuration.update(start)
        task.set_target(library.SE3.from_translation(target))
        for _ in range(MAX_STEPS):
            if np.linalg.norm(task.compute_error(configuration)[:3]) < STOP_DISTANCE:
                break
            try:
                step = library.solve_ik(configuration, [task], 1.0, "daqp", damping=QP_DAMPING, limits=limits)
            except library.NoSolutionFound:
                break
            configuration.integrate_inplace(step, 1.0)
        return _fill_angles(chain, configuration.q)

    return solve


def pink(chain: Chain) -> Solver:
    """Build Pink's solver: differential inverse kinematics on Pinocchio."""
    import pink as library  # noqa: PLC0415 - optional
    import pinocchio  # noqa: PLC0415 - installed with pink

    model = pinocchio.buildModelFromXML(write_urdf(chain))
    data, start = model.createData(), chain.rest[: model.nq].copy()
    task = library.FrameTask(HAND_LINK, position_cost=1.0, orientation_cost=0.0)

    def solve(target: Floats) -> Floats:
        configuration = library.Configuration(model, data, start)
        task.set_target(pinocchio.SE3(np.eye(3), target))
        for _ in range(MAX_STEPS):
            if np.linalg.norm(task.compute_error(configuration)[:3]) < STOP_DISTANCE:
                break
            try:
                step = library.solve_ik(configuration, [task], 1.0, "daqp", damping=QP_DAMPING, safety_break=False)
            except library.exceptions.NoSolutionFound:
                break
            # rounding would otherwise exceed the limits and cause a warning at every step
            moved = configuration.integrate(step, 1.0)
            configuration.update(np.clip(moved, model.lowerPositionLimit, model.upperPositionLimit))
        return _fill_angles(chain, configuration.q)

    return solve


def placo(chain: Chain) -> Solver:
    """Build PlaCo's solver: task-space inverse kinematics by quadratic programs.

    It is written in C++, on Pinocchio.
    """
    import placo as library  # noqa: PLC0415 - optional

    robot = library.RobotWrapper("", library.Flags.ignore_collisions, write_urdf(chain))
    solver = library.KinematicsSolver(robot)
    solver.mask_fbase(True)
    solver.enable_joint_limits(True)
    task = solver.add_position_task(HAND_LINK, np.zeros(3))
    task.configure(HAND_LINK, "soft", 1.0)
    solver.add_regularization_task(QP_DAMPING)
    free = len(robot.state.q) - len(list_carriers(chain))  # values of the floating base's pose
    start = np.array([*robot.state.q[:free], *chain.rest[: len(list_carriers(chain))]])

    def solve(target: Floats) -> Floats:
        robot.state.q = start
        robot.update_kinematics()
        task.target_world = target
        for _ in range(MAX_STEPS):
            solver.solve(True)
            robot.update_kinematics()
            if np.linalg.norm(robot.get_T_world_frame(HAND_LINK)[:3, 3] - target) < STOP_DISTANCE:
                break
        return _fill_angles(chain, robot.state.q[free:])

    return solve


def optik(chain: Chain) -> Solver:
    """Build optik's solver: nonlinear least squares with random restarts, in Rust.

    It solves for poses only, so orientation gets weight zero.
    """
    from optik import Robot, SolverConfig  # noqa: PLC0415 - optional

    with TemporaryDirectory() as folder:
        path = Path(folder, "arm.urdf")
        path.write_text(write_urdf(chain), encoding="utf-8")
        robot = Robot.from_urdf_file(str(path), BASE_LINK, HAND_LINK)
    robot.set_parallelism(1)
    count = len(list_carriers(chain))
    config = SolverConfig(
        solution_mode="speed",
        max_time=TIME_LIMIT,
        tol_f=STOP_DISTANCE**2,
        linear_weight=[1.0] * 3,
        angular_weight=[0.0] * 3,
    )
    start, pose = chain.rest[:count].tolist(), np.eye(4)

    def solve(target: Floats) -> Floats:
        pose[:3, 3] = target
        solution = robot.ik(config, pose, start)
        return chain.rest if solution is None else _fill_angles(chain, np.array(solution[0]))

    return solve


def _make_translations(offset: Floats) -> list["rtb.ET"]:
    """Return roboticstoolbox translations along x, y and z."""
    import roboticstoolbox as rtb  # noqa: PLC0415 - optional

    translations = (rtb.ET.tx, rtb.ET.ty, rtb.ET.tz)
    return [move(float(length)) for move, length in zip(translations, offset, strict=True) if length != 0.0]


def _make_rotation(carrier: WristHinge) -> "rtb.ET":
    """Return a roboticstoolbox rotation by a joint's angle, flipped for negative axes.

    Raises:
        ValueError: the axis is not parallel to x, y or z.
    """
    import roboticstoolbox as rtb  # noqa: PLC0415 - optional

    hinge = carrier.hinge
    main = int(np.argmax(np.abs(hinge.axis)))
    if np.count_nonzero(hinge.axis) != 1:
        raise ValueError(
            f"{hinge.name}: axis {hinge.axis.tolist()} has no elementary transform; it must be parallel to x, y or z"
        )
    turn = (rtb.ET.Rx, rtb.ET.Ry, rtb.ET.Rz)[main]
    return turn(flip=bool(hinge.axis[main] < 0.0), qlim=np.array(_bounds(carrier)))


def _bounds(carrier: WristHinge) -> tuple[float, float]:
    return carrier.hinge.lower, carrier.hinge.upper


def _fill_angles(chain: Chain, angles: Floats) -> Floats:
    """Extend a solver's angles to all joints, with unsolved joints at rest."""
    all_angles = chain.rest.copy()
    all_angles[: len(angles)] = angles
    return all_angles


PEER_LIBRARIES = (
    Peer("roboticstoolbox", "roboticstoolbox-python", ("roboticstoolbox",), roboticstoolbox),
    Peer("optik", "optik-py", ("optik",), optik),
    Peer("placo", "placo", ("placo",), placo),
    Peer("mink", "mink", ("mink", "mujoco", "daqp"), mink),
    Peer("pink", "pin-pink", ("pink", "pinocchio", "daqp"), pink),
    Peer("ikpy", "ikpy", ("ikpy",), ikpy),
)
