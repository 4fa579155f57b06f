// The thesis's masses and springs (7.3.1, Algorithm 1) with Stoermer-Verlet integration (eq. 7.3.6), unit masses.
//
// Algorithm of both methods, after J. Huang's thesis:
//   clamp the target; repeat until the tip reaches it:
//     f_i = k (stretch of bone i) - k (stretch of bone i - 1)           Hooke, eq. 7.3.1 and 7.3.2
//     x_i <- x_i + (1 - damping) (x_i - x_i before) + f_i dt^2          Verlet with friction
// Method 1 draws the free end mass to the target by a force k (T - E); method 2 pins the end mass to the target.
// The tip that counts is that of the real chain: bones of their own length along the springs' directions.

#pragma once

#include "chain_state.h"

namespace kinesic::chains {

// Shares of what the theory says for a straight row, whose bends add slower modes, and shorter ones. Least mean over
// targets for 3 to 10 bones. Near the bound of stability long rows that are pressed together swing for ever (a third of
// the targets at 32 bones): they keep further away from it.
struct Shares {
    double stiffness, damping;
};
constexpr Shares SHORT{0.95, 0.6}, LONG{0.7, 0.5};
constexpr int SHORT_BONES = 10;

struct Verlet {
    double stiffness, momentum;  // k dt^2; share of its speed that a mass keeps
};

// Heavy-ball optimum of a row of springs held at both ends: with m and L the least and the greatest eigenvalue of its
// Laplacian, k = 4 / (sqrt L + sqrt m)^2 and damping 1 - ((sqrt L - sqrt m) / (sqrt L + sqrt m))^2.
inline Verlet heavy_ball(int springs, const Shares& shares) {
    const double slow = std::sqrt(2.0 - 2.0 * std::cos(arm::PI / springs));
    const double fast = std::sqrt(2.0 - 2.0 * std::cos(arm::PI * (springs - 1) / springs));
    const double share = (fast - slow) / (fast + slow);
    return {shares.stiffness * 4.0 / ((fast + slow) * (fast + slow)), 1.0 - shares.damping * (1.0 - share * share)};
}

inline const Shares& shares_of(int bones) { return bones <= SHORT_BONES ? SHORT : LONG; }

// What each spring pulls per stiffness, along its bone outward; returns the tip of the real chain.
inline Vector stretch(const Chain& chain, const Vector* points, Vector* pulls) {
    Vector tip;
    for (int j = 0; j < chain.bones; ++j) {
        const Vector along = points[j + 1] - points[j];
        const double length = norm(along);
        const double share = length > 0.0 ? chain.lengths[j] / length : 0.0;
        const Vector bone = along * share;
        pulls[j] = along - bone;
        tip = tip + bone;
    }
    return tip;
}

inline void verlet(const Verlet& tuned, const Vector& force, Vector& now, Vector& before) {
    const Vector next = now + (now - before) * tuned.momentum + force * tuned.stiffness;
    before = now;
    now = next;
}

// Method 1, force based.
inline int force_verlet(const Chain& chain, const Goal& goal, Posture& posture) {
    const int n = chain.bones;
    const Verlet tuned = heavy_ball(n + 1, shares_of(n));  // the force on the end is one spring more, of no length
    Vector before[MOST_BONES + 1], pulls[MOST_BONES];
    Vector* points = posture.points;
    for (int i = 1; i <= n; ++i) before[i] = points[i];
    int k = 0;
    while (distance(stretch(chain, points, pulls), goal.target) > goal.tolerance && k < goal.most) {
        for (int i = 1; i < n; ++i) verlet(tuned, pulls[i] - pulls[i - 1], points[i], before[i]);
        verlet(tuned, goal.target - points[n] - pulls[n - 1], points[n], before[n]);
        ++k;
    }
    aim(chain, posture);
    return k;
}

// Method 2, position based: the end is pinned.
inline int pinned_verlet(const Chain& chain, const Goal& goal, Posture& posture) {
    const int n = chain.bones;
    const Verlet tuned = heavy_ball(n, shares_of(n));
    Vector before[MOST_BONES + 1], pulls[MOST_BONES];
    Vector* points = posture.points;
    points[n] = goal.target;
    for (int i = 1; i < n; ++i) before[i] = points[i];
    int k = 0;
    while (distance(stretch(chain, points, pulls), goal.target) > goal.tolerance && k < goal.most) {
        for (int i = 1; i < n; ++i) verlet(tuned, pulls[i] - pulls[i - 1], points[i], before[i]);
        ++k;
    }
    aim(chain, posture);
    return k;
}

}  // namespace kinesic::chains
