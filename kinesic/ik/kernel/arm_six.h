// Levenberg-Marquardt for position and orientation together, within the ranges (kinesic/ik/pose.py).

#pragma once

#include "arm_orientation.h"
#include "box_lm.h"

namespace kinesic::arm {

namespace six {

constexpr double TOLERANCE = 1e-7;  // error in arm lengths and rad

using Residuals = box::Residuals<MAX_HINGES>;

// Errors: position in arm lengths, orientation in rad.
inline void measure(const Linkage& arm, const Vector& target, const Rotation& wanted, const double* angles,
                    Residuals& residuals) {
    Vector axis[MAX_HINGES], pole[MAX_HINGES], centre = arm.origin, hand;
    Rotation rotation;
    for (int j = 0; j < arm.links; ++j) {
        const Link& link = arm.link[j];
        for (int k = link.first; k < link.first + link.count; ++k) {
            axis[k] = rotated(rotation, arm.pivot[k].axis);
            pole[k] = centre;
            rotation = behind(rotation, arm.pivot[k], angles[k]);
        }
        hand = centre;
        centre = centre + rotated(rotation, link.bone);
    }
    const double scale = 1.0 / arm.farthest;
    for (int k = 0; k < arm.hinges; ++k) {
        const Vector moved = cross(axis[k], hand - pole[k]) * scale;
        const double column[box::RESIDUAL_COUNT] = {moved.x, moved.y, moved.z, axis[k].x, axis[k].y, axis[k].z};
        std::copy_n(column, box::RESIDUAL_COUNT, residuals.column[k]);
    }
    const Vector off = (target - hand) * scale, turn = shortest_turn(rotation, wanted);
    const double row[box::RESIDUAL_COUNT] = {off.x, off.y, off.z, turn.x, turn.y, turn.z};
    std::copy_n(row, box::RESIDUAL_COUNT, residuals.row);
}

// Descends in place, with a null-space pull towards `home`; returns the number of iterations.
inline int descend(const Linkage& arm, const Vector& target, const Rotation& wanted, const double* home,
                   const double* mobility, double* angles) {
    double lower[MAX_HINGES], upper[MAX_HINGES];
    for (int k = 0; k < arm.hinges; ++k) lower[k] = arm.pivot[k].lower, upper[k] = arm.pivot[k].upper;
    const auto residuals = [&](const double* now, Residuals& into) { measure(arm, target, wanted, now, into); };
    return box::descend<MAX_HINGES>({arm.hinges, lower, upper, home, mobility}, residuals, TOLERANCE, angles).rounds;
}

}  // namespace six

}  // namespace kinesic::arm
