"""Face screen in the MuJoCo model, and upload of face pictures."""

import mujoco
import numpy as np

from kinesic.body.arrays import Picture
from kinesic.body.robot import Robot
from kinesic.files.late_pillow import Image
from kinesic.sim.filming.drawn_face import SCREEN_SIZE
from kinesic.sim.filming.face_screen import Sheet, build_face_screen

SCREEN_TEXTURE = "face"  # name of the texture and material of the screen
FRAME_COLOUR = (0.09, 0.10, 0.12, 1.0)  # RGBA colour of the screen's frame
SCREEN_EMISSION = 0.75  # emitted fraction of the picture's brightness


def add_screen(spec: mujoco.MjSpec, robot: Robot) -> bool:
    """Add the face screen to the model if the robot has one.

    The screen is black at first. Return whether it was added.
    """
    screen = build_face_screen(robot)
    if screen is None:
        return False
    width, height = SCREEN_SIZE
    spec.add_texture(
        name=SCREEN_TEXTURE,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=width,
        height=height,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=[0, 0, 0],
    )
    lit = spec.add_material(
        name=SCREEN_TEXTURE, emission=SCREEN_EMISSION, specular=0.15, shininess=0.6, rgba=[1, 1, 1, 1]
    )
    lit.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = SCREEN_TEXTURE
    spec.add_material(name="face_frame", specular=0.4, shininess=0.5, rgba=FRAME_COLOUR)
    body = spec.body(screen.segment)
    for name, sheet, material in (("face", screen.picture, SCREEN_TEXTURE), ("face_frame", screen.frame, "face_frame")):
        _add_mesh(spec, name, sheet)
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=material, mass=0, contype=0, conaffinity=0
        )
    return True


def has_screen(model: mujoco.MjModel) -> bool:
    """Return whether a model has a face screen."""
    return SCREEN_TEXTURE in {model.tex(k).name for k in range(model.ntex)}


def put_face(model: mujoco.MjModel, picture: Picture) -> int:
    """Copy a picture of size `SCREEN_SIZE` into a model's screen texture.

    Returns:
        Id of the changed texture.
    """
    texture = model.tex(SCREEN_TEXTURE)
    begin = int(texture.adr[0])
    model.tex_data[begin : begin + picture.size] = picture.ravel()
    return int(texture.id)


def upload_face(model: mujoco.MjModel, context: mujoco.MjrContext, picture: Picture) -> None:
    """Show a face picture of any size on a model's screen.

    A model without a screen stays as it is.
    """
    if not has_screen(model):
        return
    if picture.shape[:2] != SCREEN_SIZE[::-1]:
        picture = np.asarray(Image.fromarray(picture).resize(SCREEN_SIZE, Image.Resampling.BILINEAR))
    mujoco.mjr_uploadTexture(model, context, put_face(model, picture))


def _add_mesh(spec: mujoco.MjSpec, name: str, sheet: Sheet) -> None:
    corners = np.arange(len(sheet.places))
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert = sheet.places.ravel()
    mesh.usernormal = sheet.normals.ravel()
    mesh.usertexcoord = sheet.texture_coordinates.ravel()
    mesh.userface = sheet.triangles.ravel()
    mesh.userfacenormal = corners[sheet.triangles].ravel()
    mesh.userfacetexcoord = corners[sheet.triangles].ravel()
