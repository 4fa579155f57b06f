// Jacobian methods. Every ball joint i has three columns: a rotation vector omega_i moves the tip e by omega_i x r_i,
// r_i = e - p_i. So J^T y is r_i x y joint by joint, and J J^T = sum (|r_i|^2 I - r_i r_i^T) is 3 x 3.
//
//   transpose        dtheta = alpha J^T e,  alpha = (e . J J^T e) / |J J^T e|^2   W. A. Wolovich, H. Elliott 1984
//   pseudo-inverse   dtheta = J^T (J J^T)^-1 e                                    D. E. Whitney 1969
//   damped           dtheta = J^T (J J^T + lambda^2 I)^-1 e                       C. W. Wampler 1986
//   the same, large  dtheta = (J^T J + lambda^2 I)^-1 J^T e, 3n x 3n
// The forms follow S. R. Buss's survey (2004), which clamps the error and the joint rotation of each step.

#pragma once

#include "chain_state.h"

namespace kinesic::chains {

constexpr double MAX_STEP = 0.5;               // [chain lengths] largest tip displacement of an iteration
constexpr double MAX_ROTATION = arm::PI / 4.0;  // [rad] largest joint rotation of an iteration
constexpr double DAMPING_LAMBDA = 0.05;        // [chain lengths] lambda of the damped methods
constexpr double MIN_PIVOT_RATIO = 1e-12;      // smallest used pivot of J J^T / its trace

struct Symmetric {  // 3 x 3
    double xx, xy, xz, yy, yz, zz;
};

inline Vector times(const Symmetric& m, const Vector& a) {
    return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
            m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

// J J^T + lambda^2 I.
inline Symmetric normal_matrix(const Chain& chain, const Posture& posture, double lambda) {
    const double square = lambda * lambda;
    Symmetric m{square, 0.0, 0.0, square, 0.0, square};
    const Vector tip = posture.points[chain.bones];
    for (int i = 0; i < chain.bones; ++i) {
        const Vector r = tip - posture.points[i];
        m.xx += r.y * r.y + r.z * r.z;
        m.yy += r.x * r.x + r.z * r.z;
        m.zz += r.x * r.x + r.y * r.y;
        m.xy -= r.x * r.y;
        m.xz -= r.x * r.z;
        m.yz -= r.y * r.z;
    }
    return m;
}

// M^-1 b by L D L^T; zero along directions with too small a pivot.
inline Vector solved(const Symmetric& m, const Vector& b) {
    const double least = MIN_PIVOT_RATIO * (m.xx + m.yy + m.zz);
    const double dx = m.xx > least ? 1.0 / m.xx : 0.0;
    const double yx = m.xy * dx, zx = m.xz * dx;
    const double py = m.yy - yx * m.xy, off = m.yz - yx * m.xz;
    const double dy = py > least ? 1.0 / py : 0.0;
    const double zy = off * dy;
    const double pz = m.zz - zx * m.xz - zy * off;
    const double dz = pz > least ? 1.0 / pz : 0.0;
    const double u = b.y - yx * b.x;
    const double z = (b.z - zx * b.x - zy * u) * dz;
    const double y = u * dy - zy * z;
    return {b.x * dx - yx * y - zx * z, y, z};
}

// Error from the tip to the target, clamped to the largest step.
inline Vector error(const Chain& chain, const Goal& goal, const Posture& posture) {
    const Vector e = goal.target - posture.points[chain.bones];
    const double length = norm(e);
    return length > MAX_STEP ? e * (MAX_STEP / length) : e;
}

// Rotates the joints by rotation vectors, all scaled by one factor if one of them is too large.
inline void step(const Chain& chain, const Vector* omegas, Posture& posture) {
    double most = 0.0;
    for (int i = 0; i < chain.bones; ++i) most = std::fmax(most, dot(omegas[i], omegas[i]));
    most = std::sqrt(most);
    const double scale = most > MAX_ROTATION ? MAX_ROTATION / most : 1.0;
    Quaternion turns[MAX_BONES];
    for (int i = 0; i < chain.bones; ++i) turns[i] = turn(omegas[i] * scale);
    turn_joints(chain, turns, posture);
}

// Repeats steps dtheta = J^T y until the tip reaches the target; `find` computes y from the error.
template <typename Find>
int descend(const Chain& chain, const Goal& goal, Posture& posture, Find find) {
    Vector omegas[MAX_BONES];
    int k = 0;
    while (residual(chain, goal, posture) > goal.tolerance && k < goal.max_iterations) {
        const Vector tip = posture.points[chain.bones];
        const Vector y = find(error(chain, goal, posture));
        for (int i = 0; i < chain.bones; ++i) omegas[i] = cross(tip - posture.points[i], y);
        step(chain, omegas, posture);
        ++k;
    }
    return k;
}

inline int transpose(const Chain& chain, const Goal& goal, Posture& posture) {
    return descend(chain, goal, posture, [&](const Vector& e) {
        const Vector moved = times(normal_matrix(chain, posture, 0.0), e);
        const double square = dot(moved, moved);
        return square > 0.0 ? e * (dot(e, moved) / square) : Vector{};
    });
}

inline int pseudo_inverse(const Chain& chain, const Goal& goal, Posture& posture) {
    return descend(chain, goal, posture,
                   [&](const Vector& e) { return solved(normal_matrix(chain, posture, 0.0), e); });
}

inline int damped(const Chain& chain, const Goal& goal, Posture& posture) {
    return descend(chain, goal, posture,
                   [&](const Vector& e) { return solved(normal_matrix(chain, posture, DAMPING_LAMBDA), e); });
}

}  // namespace kinesic::chains
