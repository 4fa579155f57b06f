"""Finds the stages of a step of the physics whose constraints are the friction of hinges alone.

The rows of friction are the same in any posture, and each is a hinge of its own: a compiled loop has MuJoCo make them
once, and only replaces the matrix A + R that couples them. Where a hinge is beyond its stop, MuJoCo makes all anew.

Source: MuJoCo's documentation, chapter Computation: A = J M^-1 J^T is the inverse inertia of constraints with the
Jacobian J, which is the identity here; R makes them soft; M = L^T D L. Names of fields are those of `mjData`.
"""

from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.sim.stepping.addresses import function_address

# Stages of `mj_step` in its order, without `mj_makeConstraint` and `mj_projectConstraint`.
BEFORE = ("mj_checkPos", "mj_checkVel", "mj_kinematics", "mj_comPos", "mj_makeM", "mj_factorM")
AFTER = (
    "mj_transmission",
    "mj_fwdVelocity",
    "mj_fwdActuation",
    "mj_fwdAcceleration",
    "mj_fwdConstraint",
    "mj_checkAcc",
    "mj_implicit",
)

PENDULUM = """
<mujoco>
  <option solver="PGS" jacobian="dense" integrator="implicitfast"/>
  <worldbody>
    <body>
      <joint name="hinge" axis="0 1 0" damping="0.1" frictionloss="0.1"/>
      <geom pos="0.3 0 0" size="0.1"/>
    </body>
  </worldbody>
  <actuator>
    <position joint="hinge" kp="5"/>
  </actuator>
</mujoco>
"""


@dataclass(frozen=True, eq=False)
class FrictionParts:
    """Stages of a step, stops, and what A + R is made of; from `positions` on, arrays are MuJoCo's own."""

    before: Indices  # (k,) addresses of the stages up to the factors of the inertia
    after: Indices  # (l,) addresses of those from then on
    lower: Floats  # (n,) [rad] between which no stop acts
    upper: Floats  # (n,) [rad] likewise
    begins: Indices  # (n,) where each row of qLD begins, in its entries
    ends: Indices  # (n,) where its diagonal is, which is its last
    columns: Indices  # (c,) in which the entries stand
    positions: Floats  # (n,) [rad] qpos
    factor: Floats  # (c,) qLD, the entries of L, and D where its diagonal is
    inverse_d: Floats  # (n,) qLDiagInv, 1 / D
    softness: Floats  # (n,) efc_R
    matrix: Floats  # (n * n,) efc_AR, A + R


def find_friction_parts(model: mujoco.MjModel, data: mujoco.MjData, longest: float) -> FrictionParts | None:
    """Finds the stages and arrays of a model that touches nothing, before its first step; None: steps stay whole.

    Args:
        model: of which only the timestep changes from now on.
        data: its first posture.
        longest: [s] of a step.
    """
    before, after = ([function_address(name) or 0 for name in stages] for stages in (BEFORE, AFTER))
    if not all((*before, *after)) or not _is_as_expected(model, longest) or not stages_make_a_step():
        return None
    mujoco.mj_fwdPosition(model, data)
    if not data.nefc == data.nf == model.nv or not _is_laid_out_as_expected(model, data):
        return None
    bounded = model.jnt_limited.astype(np.bool_)
    return FrictionParts(
        before=np.array(before, dtype=np.int64),
        after=np.array(after, dtype=np.int64),
        lower=np.where(bounded, model.jnt_range[:, 0] + model.jnt_margin, -np.inf),
        upper=np.where(bounded, model.jnt_range[:, 1] - model.jnt_margin, np.inf),
        begins=model.M_rowadr.astype(np.int64),
        ends=(model.M_rowadr + model.M_rownnz - 1).astype(np.int64),
        columns=model.M_colind.astype(np.int64),
        positions=data.qpos,
        factor=data.qLD,
        inverse_d=data.qLDiagInv,
        softness=data.efc_R,
        matrix=data.efc_AR,
    )


@cache
def stages_make_a_step() -> bool:
    """Tries whether these stages are all that `mj_step` does to a pendulum, whose matrix is the same in any posture."""
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    whole, staged = mujoco.MjData(model), mujoco.MjData(model)
    whole.ctrl[:] = staged.ctrl[:] = 1.0
    mujoco.mj_step(model, whole, 3)
    mujoco.mj_step(model, staged)
    try:
        for name in (*BEFORE, *AFTER) * 2:
            getattr(mujoco, name)(model, staged)
    except (AttributeError, TypeError):  # a version with another stage, or one that wants more than model and data
        return False
    return np.array_equal(whole.qpos, staged.qpos) and np.array_equal(whole.qvel, staged.qvel)


def _is_as_expected(model: mujoco.MjModel, longest: float) -> bool:
    """Whether MuJoCo needs just this matrix of constraints, and makes the same rows with every timestep."""
    return bool(
        mujoco.get_mjcb_control() is None  # somebody's own, which `mj_step` alone calls
        and model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT
        and model.opt.solver == mujoco.mjtSolver.mjSOL_PGS
        and model.opt.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
        and model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        and (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE).all()
        and (model.dof_solref[:, 0] >= 2 * longest).all()  # shorter ones MuJoCo lengthens to two timesteps
    )


def _is_laid_out_as_expected(model: mujoco.MjModel, data: mujoco.MjData) -> bool:
    """Whether MuJoCo keeps L row by row as it keeps M, beside 1 / D, and all of the matrix of constraints."""
    of_hinges = (model.nv,)
    try:
        return bool(
            model.M_rowadr.shape == model.M_rownnz.shape == data.qLDiagInv.shape == data.efc_R.shape == of_hinges
            and model.M_colind.shape == data.qLD.shape
            and data.efc_AR.shape == (model.nv**2,)
        )
    except AttributeError:  # a version with other names
        return False
