// Levenberg-Marquardt with an active set (tests/reference/ik/polish.py): free hinges compensate for limited ones.

#pragma once

#include <algorithm>

#include "arm_linkage.h"

namespace kinesic::arm {

namespace correction {

constexpr int MAX_ITERATIONS = 24;
constexpr double TOLERANCE = 1e-7;      // [arm lengths] largest remaining distance
constexpr double ERROR_DAMPING = 0.3;   // lambda^2 = ERROR_DAMPING e^2 + MIN_DAMPING size^2 (after Sugihara)
constexpr double MIN_DAMPING = 1e-7;
constexpr double POSTURE_GAIN = 0.4;    // fraction of the distance to the preferred posture per iteration
constexpr double POSTURE_DECAY = 0.7;   // factor on `POSTURE_GAIN` per iteration, from the first on
constexpr double STALL_RATIO = 0.98;    // error ratio of successive iterations above which progress has stalled
constexpr int MAX_STALLED_STEPS = 6;    // successive stalled iterations that end the solver
constexpr double DAMPING_GROWTH = 8.0;  // factor on the damping after a rejected step, divisor after an accepted one

}  // namespace correction

struct CorrectedPosture {
    double angles[MAX_HINGES] = {};  // [rad] of the hinges before the hand
    double miss = INFINITY;      // [m]
    int rounds = 0;
};

// Hand position [m], and a point and the axis of each hinge before the hand.
inline Vector walked(const Linkage& arm, const double* angles, Vector* axis, Vector* pole) {
    Vector centre = arm.origin;
    Rotation rotation;
    for (int j = 0; j < arm.links - 1; ++j) {
        const Link& link = arm.link[j];
        for (int k = link.first; k < link.first + link.count; ++k) {
            axis[k] = rotated(rotation, arm.pivot[k].axis);
            pole[k] = centre;
            rotation = behind(rotation, arm.pivot[k], angles[k]);
        }
        centre = centre + rotated(rotation, link.bone);
    }
    return centre;
}

// Hand position, and its derivative by each hinge before the hand.
inline Vector columns(const Linkage& arm, const double* angles, Vector* column) {
    Vector axis[MAX_HINGES], pole[MAX_HINGES];
    const Vector centre = walked(arm, angles, axis, pole);
    for (int k = 0; k < arm.own(); ++k) column[k] = cross(axis[k], centre - pole[k]);
    return centre;
}

// Computes (J W J^T + damping)^-1 error over the free hinges by Cramer's rule for 3 x 3.
inline Vector pushed(const Vector* column, const double* mobility, const int* free, int count, double damping,
                     const Vector& error) {
    double xx = damping, yy = damping, zz = damping, xy = 0.0, xz = 0.0, yz = 0.0;
    for (int i = 0; i < count; ++i) {
        const Vector& c = column[free[i]];
        const double w = mobility[free[i]];
        xx += w * c.x * c.x, yy += w * c.y * c.y, zz += w * c.z * c.z;
        xy += w * c.x * c.y, xz += w * c.x * c.z, yz += w * c.y * c.z;
    }
    const Vector first{xx, xy, xz}, second{xy, yy, yz}, third{xz, yz, zz};
    const Vector a = cross(second, third), b = cross(third, first), c = cross(first, second);
    const double volume = dot(first, a);
    return {(a.x * error.x + b.x * error.y + c.x * error.z) / volume,
            (a.y * error.x + b.y * error.y + c.y * error.z) / volume,
            (a.z * error.x + b.z * error.y + c.z * error.z) / volume};
}

// Takes one step; free hinges compensate for those at their limits.
inline void stepped(const Linkage& arm, const double* angles, Vector error, const Vector* column, const double* pulls,
                    const double* mobility, double damping, double* result) {
    int free[MAX_HINGES], count = 0;
    for (int k = 0; k < arm.own(); ++k) {
        result[k] = angles[k];
        if (mobility[k] > 0.0) free[count++] = k;
    }
    while (count > 0) {
        Vector left = error;
        for (int i = 0; i < count; ++i) left = left - column[free[i]] * pulls[free[i]];
        const Vector push = pushed(column, mobility, free, count, damping, left);
        double wanted[MAX_HINGES];
        bool stopped = false;
        for (int i = 0; i < count; ++i) {
            const int k = free[i];
            wanted[k] = angles[k] + pulls[k] + mobility[k] * dot(column[k], push);
            stopped = stopped || !(arm.pivot[k].lower <= wanted[k] && wanted[k] <= arm.pivot[k].upper);
        }
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const int k = free[i];
            const Pivot& pivot = arm.pivot[k];
            if (stopped && pivot.lower <= wanted[k] && wanted[k] <= pivot.upper) {
                free[kept++] = k;
                continue;
            }
            result[k] = pivot.clipped(wanted[k]);
            error = error - column[k] * (result[k] - angles[k]);
        }
        count = kept;
    }
}

// Moves the hand to a target, with a null-space pull towards `posture`; returns the best angles.
inline CorrectedPosture polish(const Linkage& arm, const Vector& target, const double* angles, const double* posture,
                       const double* mobility, int most_rounds = correction::MAX_ITERATIONS) {
    using namespace correction;
    const double size = arm.farthest;
    const int n = arm.own();
    CorrectedPosture now;
    Vector buffers[2][MAX_HINGES], *column = buffers[0], *spare = buffers[1];
    std::copy(angles, angles + n, now.angles);
    Vector error = target - columns(arm, now.angles, column);
    now.miss = norm(error);
    double damping_factor = 1.0, posture_decay = 1.0;
    for (int stalled = 0; now.miss > TOLERANCE * size && stalled < MAX_STALLED_STEPS && now.rounds < most_rounds;) {
        ++now.rounds;
        posture_decay *= POSTURE_DECAY;
        const double damping = damping_factor * (ERROR_DAMPING * dot(error, error) + MIN_DAMPING * size * size);
        double pulls[MAX_HINGES], tried[MAX_HINGES];
        const double share = POSTURE_GAIN * posture_decay / damping_factor;
        for (int k = 0; k < n; ++k) pulls[k] = share * (posture[k] - now.angles[k]);
        stepped(arm, now.angles, error, column, pulls, mobility, damping, tried);
        const Vector tried_error = target - columns(arm, tried, spare);
        const double tried_miss = norm(tried_error), gain = tried_miss / now.miss;
        stalled = gain > STALL_RATIO ? stalled + 1 : 0;
        damping_factor = gain >= 1.0 ? DAMPING_GROWTH * damping_factor : std::max(1.0, damping_factor / DAMPING_GROWTH);
        if (gain < 1.0) {
            std::copy(tried, tried + n, now.angles);
            std::swap(column, spare);
            error = tried_error;
            now.miss = tried_miss;
        }
    }
    return now;
}

}  // namespace kinesic::arm
