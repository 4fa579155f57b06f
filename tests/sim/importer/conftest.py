"""Small test robots: an MJCF in T-pose, a URDF with hanging arms."""

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from kinesic.sim.importer import hanging_pose
from kinesic.sim.importer.convert import Mapped, import_humanoid
from kinesic.sim.importer.load import load_robot_tree
from kinesic.sim.importer.model_tree import Tree
from kinesic.sim.importer.zero_pose import HumanoidGeometry, analyse_geometry


def arm(name: str, side: int) -> str:
    """Return an arm of seven hinges and two fingers, stretched to the side.

    Equal angles on both sides are mirror postures.
    """
    low, high = (-2.4, 0.1) if side > 0 else (-0.1, 2.4)
    return f"""
    <body name="{name}shoulder" pos="0 {0.2 * side} 0.35">
      <joint name="{name}pitch" axis="0 1 0" range="-3 1"/>
      <joint name="{name}roll" axis="1 0 0" range="{-1.7 if side > 0 else -1.2} {1.2 if side > 0 else 1.7}"/>
      <joint name="{name}twist" axis="0 1 0" range="-1.5 1.5"/>
      <geom type="capsule" fromto="0 0 0 0 {0.28 * side} 0" size="0.035" mass="1.2"/>
      <body name="{name}fore" pos="0.01 {0.28 * side} 0">
        <joint name="{name}bend" axis="0 0 1" range="{low} {high}"/>
        <joint name="{name}turn" axis="0 1 0" pos="-0.01 0 0" range="-1.5 1.5"/>
        <geom type="capsule" fromto="0 0.02 0 0 {0.22 * side} 0" size="0.03" mass="0.8"/>
        <body name="{name}hand" pos="-0.01 {0.24 * side} 0">
          <joint name="{name}nod" axis="1 0 0" range="-1 1"/>
          <joint name="{name}wag" axis="0 0 1" range="-0.5 0.5"/>
          <geom type="capsule" fromto="0 0 0 0 {0.1 * side} 0" size="0.025" mass="0.3"/>
          <body pos="0.02 {0.1 * side} 0"><joint name="{name}thumb" axis="1 0 0"/><geom size="0.01"/></body>
          <body pos="-0.02 {0.1 * side} 0"><joint name="{name}finger" axis="1 0 0"/><geom size="0.01"/></body>
        </body>
      </body>
    </body>"""


def leg(name: str, side: int) -> str:
    return f"""
    <body pos="0 {0.1 * side} -0.1">
      <joint name="{name}hip" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.05" mass="3"/>
      <body pos="0 0 -0.4"><joint name="{name}knee" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.04" mass="2"/>
        <body pos="0 0 -0.42"><joint name="{name}ankle" axis="0 1 0"/>
          <geom type="box" pos="0.07 0 0" size="0.1 0.04 0.02" mass="1"/></body></body>
    </body>"""


def puppet(*, left: str = "l_", right: str = "r_", turned: float = 0.0, neck: bool = True, trunk: bool = True) -> str:
    """Return an MJCF of a whole body with a given heading [deg]."""
    head = """
    <body pos="0 0 0.45"><joint name="pan" axis="0 0 1" range="-1.2 1.2"/>
      <joint name="nod" axis="0 -1 0" range="-0.5 0.7"/><geom size="0.09" pos="0.02 0 0.1" mass="2"/></body>"""
    waist = '<joint name="waist" axis="0 0 1" range="-1 1"/><joint name="bow" axis="0 1 0" range="-0.3 0.8"/>'
    return f"""<mujoco model="puppet"><compiler angle="radian"/>
  <asset><mesh name="none" file="there_is_no_such.stl"/></asset>
  <worldbody>
  <body name="pelvis" pos="0 0 1" euler="0 0 {turned * 3.141592653589793 / 180}"><freejoint/>
    <geom type="capsule" fromto="0 -0.05 0 0 0.05 0" size="0.08" mass="4"/>
    <body name="chest" pos="0 0 0.1">{waist if trunk else ""}
      <geom type="mesh" mesh="none"/>
      <geom type="capsule" fromto="0 0 0.08 0 0 0.3" size="0.09" mass="8"/>
      {head if neck else ""}{arm(left, 1)}{arm(right, -1)}
    </body>{leg(left, 1)}{leg(right, -1)}
  </body></worldbody>
  <actuator><position name="a" joint="{left}pitch" kp="60" forcerange="-20 20"/></actuator></mujoco>"""


def urdf() -> str:
    """Return a URDF upper body: base, head, and two hanging arms with grippers."""

    def joint(name: str, parent: str, child: str, xyz: str, axis: str, rest: str, kind: str = "revolute") -> str:
        return f"""<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
          <origin xyz="{xyz}"/><axis xyz="{axis}"/>{rest}</joint>"""

    def link(name: str, mass: float, z: float) -> str:
        return f"""<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
          <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
          <visual><geometry><mesh filename="package://nowhere/{name}.dae"/></geometry></visual></link>"""

    limit = '<limit lower="{}" upper="{}" effort="30" velocity="3.5"/>'
    parts = [link("trunk", 10, 0.2), link("head", 2, 0.1)]
    parts.append(joint("neck_yaw", "trunk", "head", "0 0 0.5", "0 0 1", limit.format(-1, 1)))
    for side, y in (("left", 0.2), ("right", -0.2)):
        names = [f"{side}_{part}" for part in ("pitch", "roll", "yaw", "elbow", "turn", "grip", "mimic")]
        places = [f"0 {y} 0.4", "0 0 0", "0 0 0", "0 0 -0.28", "0 0 0", "0 0 -0.3", "0 0 -0.3"]
        axes = ["0 1 0", "1 0 0", "0 0 1", "0 1 0", "0 0 1", "1 0 0", "1 0 0"]
        ranges = [(-2.5, 1), (-0.2, 2) if y > 0 else (-2, 0.2), (-1.5, 1.5), (-2.2, 0), None, (0, 0.5), (0, 0.5)]
        parents = ["trunk", *names[:4], names[4], names[4]]
        for name, parent, place, axis, range_ in zip(names, parents, places, axes, ranges, strict=True):
            end = name.endswith(("grip", "mimic"))
            parts.append(link(name, 0.05 if end else 0.6, -0.02 if end else -0.12))
            rest = limit.format(*range_) if range_ else '<limit effort="30" velocity="100"/>'
            rest += f'<mimic joint="{side}_grip"/>' if name.endswith("mimic") else ""
            kind = "revolute" if range_ else "continuous"
            parts.append(joint(f"{name}_joint", parent, name, place, axis, rest, kind))
    return f'<?xml version="1.0"?><robot name="hanging">{"".join(parts)}</robot>'


@pytest.fixture(autouse=True, scope="module")
def random_starts() -> Iterator[None]:
    """Limit the search for each hanging pose to one random start.

    One start suffices for these simple arms, and the other nine take nine tenths of the time of an import.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hanging_pose, "RANDOM_STARTS", 1)
        yield


@pytest.fixture(scope="session")
def puppets() -> SimpleNamespace:
    """Provide the texts of both test robots."""
    return SimpleNamespace(puppet=puppet, urdf=urdf)


@pytest.fixture(scope="session")
def written(tmp_path_factory) -> Callable[[str, str], Path]:
    """Provide a function that writes a model into a separate folder."""

    def write(name: str, text: str) -> Path:
        path = tmp_path_factory.mktemp("puppets") / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="session")
def tee_path(written) -> Path:
    return written("tee.xml", puppet())


@pytest.fixture(scope="session")
def tee(tee_path) -> Tree:
    return load_robot_tree(tee_path)


@pytest.fixture(scope="session")
def tee_figure(tee) -> HumanoidGeometry:
    return analyse_geometry(tee)


@pytest.fixture(scope="session")
def tee_mapped(tee_path) -> Mapped:
    return import_humanoid(tee_path)


@pytest.fixture(scope="session")
def hanging_path(written) -> Path:
    return written("hanging.urdf", urdf())


@pytest.fixture(scope="session")
def hanging(hanging_path) -> Tree:
    return load_robot_tree(hanging_path)


@pytest.fixture(scope="session")
def hanging_mapped(hanging_path) -> Mapped:
    return import_humanoid(hanging_path)
