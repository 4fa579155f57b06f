// The thesis's unit masses and springs (7.3.1, Algorithm 1) with Stoermer-Verlet integration (eq. 7.3.6).
//
// Algorithm of both methods, after J. Huang's thesis:
//   clamp the target to the reach; repeat until the tip reaches it:
//     f_i = k (stretch of bone i) - k (stretch of bone i - 1)           Hooke, eq. 7.3.1 and 7.3.2
//     x_i <- x_i + (1 - damping) (x_i - x_i before) + f_i dt^2          VerletSettings with friction
// Method 1 pulls the free end mass to the target by a force k (T - E); method 2 pins the end mass to the target.
// The residual is that of the real chain: bones of fixed length along the springs' directions.

#pragma once

#include "chain_state.h"

namespace kinesic::chains {

// Fractions of the theoretical stiffness and damping of a straight chain, because bends add slower modes. They minimise
// the mean iteration count for 3 to 10 bones. Long compressed chains oscillate forever near the stability bound (a third
// of the targets at 32 bones), so their stiffness has a larger margin.
struct PaceFractions {
    double stiffness, damping;
};
constexpr PaceFractions SHORT_CHAIN{0.95, 0.6}, LONG_CHAIN{0.7, 0.5};
constexpr int MAX_SHORT_BONES = 10;

struct VerletSettings {
    double stiffness, momentum;  // k dt^2; fraction of its velocity that a mass keeps per step
};

// Heavy-ball optimum of a row of springs fixed at both ends: with m and L the least and the greatest eigenvalue of its
// Laplacian, k = 4 / (sqrt L + sqrt m)^2 and damping 1 - ((sqrt L - sqrt m) / (sqrt L + sqrt m))^2.
inline VerletSettings heavy_ball(int springs, const PaceFractions& fractions) {
    const double slow = std::sqrt(2.0 - 2.0 * std::cos(arm::PI / springs));
    const double fast = std::sqrt(2.0 - 2.0 * std::cos(arm::PI * (springs - 1) / springs));
    const double ratio = (fast - slow) / (fast + slow);
    return {fractions.stiffness * 4.0 / ((fast + slow) * (fast + slow)), 1.0 - fractions.damping * (1.0 - ratio * ratio)};
}

inline const PaceFractions& pace_fractions_of(int bones) { return bones <= MAX_SHORT_BONES ? SHORT_CHAIN : LONG_CHAIN; }

// Computes the pull of each spring / stiffness, outward along its bone; returns the tip of the real chain.
inline Vector stretch(const Chain& chain, const Vector* points, Vector* pulls) {
    Vector tip;
    for (int j = 0; j < chain.bones; ++j) {
        const Vector along = points[j + 1] - points[j];
        const double length = norm(along);
        const double scale = length > 0.0 ? chain.lengths[j] / length : 0.0;
        const Vector bone = along * scale;
        pulls[j] = along - bone;
        tip = tip + bone;
    }
    return tip;
}

inline void verlet(const VerletSettings& tuned, const Vector& force, Vector& now, Vector& before) {
    const Vector next = now + (now - before) * tuned.momentum + force * tuned.stiffness;
    before = now;
    now = next;
}

// Method 1, force based.
inline int force_verlet(const Chain& chain, const Goal& goal, Posture& posture) {
    const int n = chain.bones;
    const VerletSettings tuned = heavy_ball(n + 1, pace_fractions_of(n));  // the force acts like one more spring
    Vector before[MAX_BONES + 1], pulls[MAX_BONES];
    Vector* points = posture.points;
    for (int i = 1; i <= n; ++i) before[i] = points[i];
    int k = 0;
    while (distance(stretch(chain, points, pulls), goal.target) > goal.tolerance && k < goal.max_iterations) {
        for (int i = 1; i < n; ++i) verlet(tuned, pulls[i] - pulls[i - 1], points[i], before[i]);
        verlet(tuned, goal.target - points[n] - pulls[n - 1], points[n], before[n]);
        ++k;
    }
    aim(chain, posture);
    return k;
}

// Method 2, position based: the end mass is pinned to the target.
inline int pinned_verlet(const Chain& chain, const Goal& goal, Posture& posture) {
    const int n = chain.bones;
    const VerletSettings tuned = heavy_ball(n, pace_fractions_of(n));
    Vector before[MAX_BONES + 1], pulls[MAX_BONES];
    Vector* points = posture.points;
    points[n] = goal.target;
    for (int i = 1; i < n; ++i) before[i] = points[i];
    int k = 0;
    while (distance(stretch(chain, points, pulls), goal.target) > goal.tolerance && k < goal.max_iterations) {
        for (int i = 1; i < n; ++i) verlet(tuned, pulls[i] - pulls[i - 1], points[i], before[i]);
        ++k;
    }
    aim(chain, posture);
    return k;
}

}  // namespace kinesic::chains
