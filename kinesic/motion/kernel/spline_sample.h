// Angles, velocities and accelerations of a uniform cubic B-spline, for `motion/trajectory.py`.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace kinesic::motion {

// Computes (m, n) values of one derivative at (m,) positions [knot intervals] from control points (k + 3, n).
inline void sample_spline(const double* controls, int pieces, int hinges, const double* places, size_t count, int order,
                          double scale, double* values) {
    for (size_t m = 0; m < count; ++m) {
        const double place = places[m] > 0.0 ? std::min(places[m], double(pieces)) : 0.0;
        const int piece = std::min(int(place), pieces - 1);
        const double u = std::isnan(places[m]) ? places[m] : place - piece, v = 1.0 - u, *p = controls + size_t(piece) * hinges;
        double* row = values + m * hinges;
        if (order == 0) {
            const double shares[4] = {v * v * v / 6, (3 * (u * u * u) - 6 * (u * u) + 4) / 6,
                                      (3 * (v * v * v) - 6 * (v * v) + 4) / 6, u * u * u / 6};
            for (int i = 0; i < hinges; ++i)
                row[i] = shares[0] * p[i] + shares[1] * p[hinges + i] + shares[2] * p[2 * hinges + i] +
                         shares[3] * p[3 * hinges + i];
        } else if (order == 1) {
            const double shares[3] = {v * v / 2, 0.5 + u * v, u * u / 2};
            for (int i = 0; i < hinges; ++i) {
                const double *q = p + i, a = q[hinges] - q[0], b = q[2 * hinges] - q[hinges],
                             c = q[3 * hinges] - q[2 * hinges];
                row[i] = shares[0] * (a / scale) + shares[1] * (b / scale) + shares[2] * (c / scale);
            }
        } else {
            for (int i = 0; i < hinges; ++i) {
                const double *q = p + i, a = q[hinges] - q[0], b = q[2 * hinges] - q[hinges],
                             c = q[3 * hinges] - q[2 * hinges];
                row[i] = v * ((b - a) / scale) + u * ((c - b) / scale);
            }
        }
    }
}

}  // namespace kinesic::motion
