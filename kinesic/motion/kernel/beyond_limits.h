// Limit violations of a spline that another spline does not have, for `motion/limit_check.py` with the same arithmetic.

#pragma once

#include <algorithm>
#include <cmath>

namespace kinesic::motion {

// Limits of a hinge.
struct HingeBounds {
    double middle, half, speed, acceleration, jerk;  // [rad], [rad], [rad/s], ...
    double inertial, viscous, duty;                  // duty per acceleration and per velocity, and duty limit
};

// Flags the control points whose rows exceed a fraction `full` of any limit, except where the spline `before` exceeds it by
// as much; `scales` are the first three powers of the knot interval.
inline void flag_beyond(const double* controls, const double* before, int size, const double* scales,
                        const HingeBounds& bounds, double full, bool* flags) {
    const auto look = [&](int width, auto share) {
        for (int row = 0; row + width <= size; ++row) {
            const double taken = std::abs(share(controls + row));
            if (taken > full && taken > std::max(full, std::abs(share(before + row)) + full - 1.0))
                std::fill_n(flags + row, width, true);
        }
    };
    const auto acceleration = [&](const double* x) { return ((x[2] - x[1]) - (x[1] - x[0])) / scales[1]; };
    look(1, [&](const double* x) { return (x[0] - bounds.middle) / bounds.half; });
    look(2, [&](const double* x) { return (x[1] - x[0]) / scales[0] / bounds.speed; });
    look(3, [&](const double* x) { return acceleration(x) / bounds.acceleration; });
    look(4, [&](const double* x) {
        const double begin = (x[2] - x[1]) - (x[1] - x[0]), end = (x[3] - x[2]) - (x[2] - x[1]);
        return (end - begin) / scales[2] / bounds.jerk;
    });
    look(3, [&](const double* x) {
        const double speeds = (x[1] - x[0]) / scales[0] + (x[2] - x[1]) / scales[0];
        return (bounds.inertial * acceleration(x) + bounds.viscous * speeds / 2) / bounds.duty;
    });
}

}  // namespace kinesic::motion
