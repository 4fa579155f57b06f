// `polish` for several targets at once: the same iterations, each branch as a mask over the lanes.

#pragma once

#include "arm_lanes.h"
#include "arm_polish.h"

namespace kinesic::arm {

struct CorrectedPostures {  // angles of each lane, and their distances [m] to the target
    Lanes angles[MAX_HINGES];
    Lanes miss;
};

// Hand positions, and their derivatives by each hinge.
inline Vectors columns(const Linkage& arm, const Lanes* angles, Vectors* column) {
    Vectors axis[MAX_HINGES], pole[MAX_HINGES], centre = all(arm.origin);
    Rotations rotation;
    for (int j = 0; j < arm.links - 1; ++j) {
        const Link& link = arm.link[j];
        for (int k = link.first; k < link.first + link.count; ++k) {
            axis[k] = pointing(rotation, arm.pivot[k]);
            pole[k] = centre;
            Turns turns;
            sincos(angles[k], turns.sine, turns.cosine);
            rotation = behind(rotation, arm.pivot[k], turns);
        }
        centre = centre + rotated(rotation, link.bone);
    }
    for (int k = 0; k < arm.own(); ++k) column[k] = cross(axis[k], centre - pole[k]);
    return centre;
}

// Computes (J W J^T + damping)^-1 error by Cramer's rule for 3 x 3.
inline Vectors pushed(const Vectors* column, const Lanes* weight, int count, Lanes damping, const Vectors& error) {
    Lanes xx = damping, yy = damping, zz = damping, xy = all(0.0), xz = all(0.0), yz = all(0.0);
    for (int k = 0; k < count; ++k) {
        const Vectors& c = column[k];
        const Vectors w = c * weight[k];
        xx += w.x * c.x, yy += w.y * c.y, zz += w.z * c.z;
        xy += w.x * c.y, xz += w.x * c.z, yz += w.y * c.z;
    }
    const Vectors first{xx, xy, xz}, second{xy, yy, yz}, third{xz, yz, zz};
    const Vectors a = cross(second, third), b = cross(third, first), c = cross(first, second);
    return Vectors{dot({a.x, b.x, c.x}, error), dot({a.y, b.y, c.y}, error), dot({a.z, b.z, c.z}, error)} *
           (1.0 / dot(first, a));
}

// Takes one step in every lane that is `going`.
inline void stepped(const Linkage& arm, const Lanes* angles, Vectors error, const Vectors* column, const Lanes* pulls,
                    const double* mobility, Lanes damping, Mask going, Lanes* result) {
    const int n = arm.own();
    Mask free[MAX_HINGES];
    for (int k = 0; k < n; ++k) {
        free[k] = mobility[k] > 0.0 ? going : Mask{};
        result[k] = angles[k];
    }
    for (Mask left_over = going; any(left_over);) {
        Vectors left = error;
        Lanes weight[MAX_HINGES], wanted[MAX_HINGES];
        for (int k = 0; k < n; ++k) {
            left = left - column[k] * only(free[k], pulls[k]);
            weight[k] = only(free[k], all(mobility[k]));
        }
        const Vectors push = pushed(column, weight, n, damping, left);
        Mask out[MAX_HINGES], stopped{};
        for (int k = 0; k < n; ++k) {
            wanted[k] = angles[k] + pulls[k] + weight[k] * dot(column[k], push);
            out[k] = free[k] & ((wanted[k] < arm.pivot[k].lower) | (wanted[k] > arm.pivot[k].upper));
            stopped |= out[k];
        }
        left_over = Mask{};
        for (int k = 0; k < n; ++k) {
            const Mask set = free[k] & (out[k] | ~stopped);
            const Lanes lower = all(arm.pivot[k].lower), upper = all(arm.pivot[k].upper);
            const Lanes held = either(wanted[k] < lower, lower, either(wanted[k] > upper, upper, wanted[k]));
            result[k] = either(set, held, result[k]);
            error = error - column[k] * only(set, held - angles[k]);
            free[k] &= ~set;
            left_over |= free[k];
        }
    }
}

// Runs `polish` in every lane.
inline CorrectedPostures polish(const Linkage& arm, const Vectors& target, const double* angles, const double* posture,
                        const double* mobility, int rounds) {
    using namespace correction;
    const double size = arm.farthest;
    const int n = arm.own();
    CorrectedPostures now;
    Vectors buffers[2][MAX_HINGES], *column = buffers[0], *spare = buffers[1];
    for (int k = 0; k < n; ++k) now.angles[k] = all(angles[k]);
    Vectors error = target - columns(arm, now.angles, column);
    now.miss = norm(error);
    Lanes damping_factor = all(1.0), stalled = all(0.0);
    double posture_decay = 1.0;
    for (int round = 0; round < rounds; ++round) {
        const Mask going = (now.miss > TOLERANCE * size) & (stalled < MAX_STALLED_STEPS);
        if (!any(going)) break;
        posture_decay *= POSTURE_DECAY;
        const Lanes damping = damping_factor * (ERROR_DAMPING * dot(error, error) + MIN_DAMPING * size * size);
        const Lanes share = POSTURE_GAIN * posture_decay / damping_factor;
        Lanes pulls[MAX_HINGES], tried[MAX_HINGES];
        for (int k = 0; k < n; ++k) pulls[k] = share * (posture[k] - now.angles[k]);
        stepped(arm, now.angles, error, column, pulls, mobility, damping, going, tried);
        const Vectors tried_error = target - columns(arm, tried, spare);
        const Lanes tried_miss = norm(tried_error), gain = tried_miss / now.miss;
        const Mask better = going & (gain < 1.0);
        stalled = only(gain > STALL_RATIO, stalled + 1.0);
        const Lanes smaller_factor = damping_factor / DAMPING_GROWTH;
        const Lanes reduced = either(smaller_factor > 1.0, smaller_factor, all(1.0));
        damping_factor = either(gain >= 1.0, DAMPING_GROWTH * damping_factor, reduced);
        for (int k = 0; k < n; ++k) {
            now.angles[k] = either(better, tried[k], now.angles[k]);
            column[k] = either(better, spare[k], column[k]);
        }
        error = either(better, tried_error, error);
        now.miss = either(better, tried_miss, now.miss);
    }
    return now;
}

}  // namespace kinesic::arm
