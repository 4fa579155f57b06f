// Tracking of a moving target from the previous posture (kinesic/ik/track.py).

#pragma once

#include "arm_place.h"
#include "arm_polish.h"

namespace kinesic::arm {

namespace tracking {

constexpr int MAX_ITERATIONS = 8;
constexpr double TOLERANCE = 1e-8;       // [arm lengths] largest remaining distance
constexpr double ERROR_DAMPING = 0.3;    // lambda^2 = ERROR_DAMPING e^2 + MIN_DAMPING size^2
constexpr double MIN_DAMPING = 1e-7;
constexpr double SOFT_FRACTION = 0.05;   // last fraction of the reach, which targets approach asymptotically

}  // namespace tracking

// Moves a target smoothly inside the reach D: d' = s + w (1 - exp((s - d) / w)) beyond s = D - w, w = SOFT_FRACTION D.
inline Vector softened(const Linkage& arm, const Vector& target, const double* rest) {
    using namespace tracking;
    const double width = SOFT_FRACTION * arm.farthest, begin = MAX_STRETCH_RATIO * arm.farthest - width;
    if (distance(arm.resting, target) <= begin) return target;
    Vector points[MAX_LINKS + 1];
    places::nearest_girdle(arm, target, rest, points);
    const Vector shoulder = points[arm.girdle()];
    const double d = distance(shoulder, target);
    if (d <= begin) return target;
    return shoulder + (target - shoulder) * ((begin + width * (1.0 - std::exp((begin - d) / width))) / d);
}

// Moves the angles until the hand is on the target; the first iteration pulls them towards rest by the fraction `pull`.
// Returns the remaining error [m].
inline Vector moved(const Linkage& arm, const Vector& target, double pull, const double* rest, const double* mobility,
                    double* angles) {
    using namespace tracking;
    const double size = arm.farthest;
    for (int k = arm.own(); k < arm.hinges; ++k) angles[k] = angles[k] + pull * (rest[k] - angles[k]);
    Vector column[MAX_HINGES];
    Vector error = target - columns(arm, angles, column);
    for (int round = 0; round < MAX_ITERATIONS; ++round, pull = 0.0) {
        const double damping = ERROR_DAMPING * dot(error, error) + MIN_DAMPING * size * size;
        double pulls[MAX_HINGES], next[MAX_HINGES];
        for (int k = 0; k < arm.own(); ++k) pulls[k] = pull * (rest[k] - angles[k]);
        stepped(arm, angles, error, column, pulls, mobility, damping, next);
        std::copy(next, next + arm.own(), angles);
        error = target - columns(arm, angles, column);
        if (norm(error) <= TOLERANCE * size) break;
    }
    return error;
}

// Tracks for one tick in `parts` equal steps. Returns the distance from the hand to the requested target [m].
inline double follow(const Linkage& arm, const Vector& target, double pull, int parts, const double* rest,
                     const double* mobility, double* angles) {
    const Vector aim = softened(arm, target, rest), from = parts > 1 ? hand(arm, angles) : aim;
    Vector error;
    for (int part = 1; part <= parts; ++part)
        error = moved(arm, from + (aim - from) * (double(part) / parts), pull, rest, mobility, angles);
    return norm((target - aim) + error);
}

}  // namespace kinesic::arm
