"""Stages of a physics step whose only constraints are hinge friction.

The rows of friction are the same in every posture, and each belongs to one hinge. A compiled loop has MuJoCo build them
once and only updates the matrix A + R that couples them. When a hinge is beyond its stop, MuJoCo rebuilds all rows.

Source: MuJoCo's documentation, chapter Computation: A = J M^-1 J^T is the inverse inertia of constraints with the
Jacobian J, which is the identity here; R makes them soft; M = L^T D L. Names of fields are those of `mjData`.
"""

from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np

from kinesic.body.arrays import Floats, Indices
from kinesic.sim.stepping.addresses import function_address

# Stages of `mj_step`, in its order, that a model with only friction needs before and after its constraints are built.
STAGES_BEFORE_CONSTRAINTS = ("mj_checkPos", "mj_checkVel", "mj_kinematics", "mj_comPos", "mj_makeM", "mj_factorM")
STAGES_AFTER_CONSTRAINTS = (
    "mj_transmission",
    "mj_fwdVelocity",
    "mj_fwdActuation",
    "mj_fwdAcceleration",
    "mj_fwdConstraint",
    "mj_checkAcc",
    "mj_implicit",
)

PENDULUM_XML = """
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
    """Stage addresses, joint stops and arrays of a friction-only physics step.

    From `positions` on, the arrays belong to MuJoCo.
    """

    before: Indices  # (k,) addresses of the stages up to the factorisation of the inertia
    after: Indices  # (l,) addresses of the later stages
    lower: Floats  # (n,) [rad] angle below which a stop acts
    upper: Floats  # (n,) [rad] angle above which a stop acts
    begins: Indices  # (n,) index of the first entry of each row of qLD
    ends: Indices  # (n,) index of the diagonal, the last entry of each row
    columns: Indices  # (c,) column of each entry
    positions: Floats  # (n,) [rad] qpos
    factor: Floats  # (c,) qLD, the entries of L, with D on the diagonal
    inverse_d: Floats  # (n,) qLDiagInv, 1 / D
    softness: Floats  # (n,) efc_R, the diagonal of the regularisation R
    matrix: Floats  # (n * n,) efc_AR, A + R


def find_friction_parts(model: mujoco.MjModel, data: mujoco.MjData, longest: float) -> FrictionParts | None:
    """Return MuJoCo stages and arrays for steps with friction alone, or None.

    Must be called before the first step.

    Args:
        model: Model of which only the timestep changes afterwards.
        data: Data with the first posture.
        longest: [s] longest step.

    Returns:
        None if steps must use `mj_step`.
    """
    before, after = (
        [function_address(name) or 0 for name in stages]
        for stages in (STAGES_BEFORE_CONSTRAINTS, STAGES_AFTER_CONSTRAINTS)
    )
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
    """Return whether the listed stages are equivalent to `mj_step` on a pendulum.

    The constraint matrix of the pendulum is the same in every posture.
    """
    model = mujoco.MjModel.from_xml_string(PENDULUM_XML)
    reference, staged = mujoco.MjData(model), mujoco.MjData(model)
    reference.ctrl[:] = staged.ctrl[:] = 1.0
    mujoco.mj_step(model, reference, 3)
    mujoco.mj_step(model, staged)
    try:
        for name in (*STAGES_BEFORE_CONSTRAINTS, *STAGES_AFTER_CONSTRAINTS) * 2:
            getattr(mujoco, name)(model, staged)
    except (AttributeError, TypeError):  # a MuJoCo version with other stages or other arguments
        return False
    return np.array_equal(reference.qpos, staged.qpos) and np.array_equal(reference.qvel, staged.qvel)


def _is_as_expected(model: mujoco.MjModel, longest: float) -> bool:
    """Return whether options and joints of a model allow the staged step.

    Contacts and control callbacks are off, all joints are hinges, and friction rows are independent of the timestep.
    """
    return bool(
        mujoco.get_mjcb_control() is None  # only `mj_step` calls a user's control callback
        and model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT
        and model.opt.solver == mujoco.mjtSolver.mjSOL_PGS
        and model.opt.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
        and model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        and (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE).all()
        and (model.dof_solref[:, 0] >= 2 * longest).all()  # MuJoCo raises smaller time constants to two timesteps
    )


def _is_laid_out_as_expected(model: mujoco.MjModel, data: mujoco.MjData) -> bool:
    """Return whether MuJoCo's matrices have the expected layout.

    These are L, 1 / D and A + R.
    """
    hinge_shape = (model.nv,)
    try:
        return bool(
            model.M_rowadr.shape == model.M_rownnz.shape == data.qLDiagInv.shape == data.efc_R.shape == hinge_shape
            and model.M_colind.shape == data.qLD.shape
            and data.efc_AR.shape == (model.nv**2,)
        )
    except AttributeError:  # a MuJoCo version with other names
        return False
