// All methods by name, and the complete solution that is timed: from a chain and a target to points and rotations.

#pragma once

#include "chain_dense.h"
#include "chain_heuristics.h"
#include "chain_jacobian.h"
#include "chain_springs.h"
#include "chain_tridiagonal.h"

namespace kinesic::chains {

using Method = int (*)(const Chain&, const Goal&, Posture&);  // returns iterations

struct NamedMethod {
    const char* name;
    Method method;
};

constexpr NamedMethod METHODS[] = {
    {"force_verlet", force_verlet},
    {"pinned_verlet", pinned_verlet},
    {"tridiagonal", tridiagonal},
    {"fabrik", fabrik},
    {"triangulation", triangulation},
    {"ccd", ccd},
    {"transpose", transpose},
    {"pinv", pseudo_inverse},
    {"pinv_svd", pseudo_inverse_svd},
    {"dls", damped},
    {"dls_dense", damped_dense},
    {"sdls", selectively_damped},
};

struct Outcome {
    int iterations;
    double residual;  // [chain lengths] from the tip to the clamped target
};

// Reads rest (n + 1, 3) and target (3,); writes points (n + 1, 3) and rotations (n, 4), each (w, x, y, z) in its parent.
inline Outcome solve(Method method, int bones, const double* rest, const double* target, double tolerance, int most,
                     double* points, double* rotations) {
    Chain chain;
    chain.bones = bones;
    double size = 0.0;
    for (int i = 0; i < bones; ++i) {
        const double* p = rest + 3 * i;
        const Vector bone{p[3] - p[0], p[4] - p[1], p[5] - p[2]};
        chain.lengths[i] = norm(bone);
        chain.along[i] = unit(bone);
        size += chain.lengths[i];
    }
    const double scale = 1.0 / size;
    for (int i = 0; i < bones; ++i) chain.lengths[i] *= scale;

    Vector aim{(target[0] - rest[0]) * scale, (target[1] - rest[1]) * scale, (target[2] - rest[2]) * scale};
    const double far = norm(aim);
    if (far > 1.0) aim = aim * (1.0 / far);  // thesis eq. 7.3.7, with the factor D_max / d
    const Goal goal{aim, tolerance, most};

    Posture posture = at_rest(chain);
    const int iterations = method(chain, goal, posture);

    for (int i = 0; i <= bones; ++i) {
        points[3 * i] = rest[0] + size * posture.points[i].x;
        points[3 * i + 1] = rest[1] + size * posture.points[i].y;
        points[3 * i + 2] = rest[2] + size * posture.points[i].z;
    }
    for (int i = 0; i < bones; ++i) {
        const Quaternion q = local(posture, i);
        double* out = rotations + 4 * i;
        out[0] = q.w, out[1] = q.x, out[2] = q.y, out[3] = q.z;
    }
    return {iterations, residual(chain, goal, posture)};
}

}  // namespace kinesic::chains
