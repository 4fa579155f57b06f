"""Puts the screen of the face into MuJoCo's model, and pictures on it."""

import mujoco
import numpy as np

from kinesic.body.arrays import Picture
from kinesic.body.robot import Robot
from kinesic.sim.filming.drawn_face import SCREEN
from kinesic.sim.filming.face_screen import Sheet, screen_of

PICTURE = "face"  # the name of the texture
FRAME = (0.09, 0.10, 0.12, 1.0)
GLOW = 0.75  # of the picture's own light; the rest is that of the room


def add_screen(spec: mujoco.MjSpec, robot: Robot) -> bool:
    """Adds the screen of a robot, which is dark at first; tells whether it has one."""
    screen = screen_of(robot)
    if screen is None:
        return False
    width, height = SCREEN
    spec.add_texture(
        name=PICTURE,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=width,
        height=height,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=[0, 0, 0],
    )
    lit = spec.add_material(name=PICTURE, emission=GLOW, specular=0.15, shininess=0.6, rgba=[1, 1, 1, 1])
    lit.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = PICTURE
    spec.add_material(name="face_frame", specular=0.4, shininess=0.5, rgba=FRAME)
    body = spec.body(screen.segment)
    for name, sheet, material in (("face", screen.picture, PICTURE), ("face_frame", screen.frame, "face_frame")):
        _add_mesh(spec, name, sheet)
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=material, mass=0, contype=0, conaffinity=0
        )
    return True


def has_screen(model: mujoco.MjModel) -> bool:
    """Tells whether a model shows a face."""
    return PICTURE in {model.tex(k).name for k in range(model.ntex)}


def put_face(model: mujoco.MjModel, picture: Picture) -> int:
    """Puts a picture of `SCREEN` on the screen of a model; returns the texture that has changed."""
    texture = model.tex(PICTURE)
    begin = int(texture.adr[0])
    model.tex_data[begin : begin + picture.size] = picture.ravel()
    return int(texture.id)


def _add_mesh(spec: mujoco.MjSpec, name: str, sheet: Sheet) -> None:
    corners = np.arange(len(sheet.places))
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert = sheet.places.ravel()
    mesh.usernormal = sheet.normals.ravel()
    mesh.usertexcoord = sheet.shares.ravel()
    mesh.userface = sheet.triangles.ravel()
    mesh.userfacenormal = corners[sheet.triangles].ravel()
    mesh.userfacetexcoord = corners[sheet.triangles].ravel()
