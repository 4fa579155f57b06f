// Numbers, vectors and symmetric matrices in several postures at once, for `impact_tree.h`.

#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace kinesic::sim {

constexpr int LANES = 4;  // postures that are computed together

// One number in each posture of a group.
struct Lane {
    double v[LANES];

    static Lane of(double value) {
        Lane made;
        for (double& entry : made.v) entry = value;
        return made;
    }
};

#define KINESIC_LANE_OPERATOR(op)                                              \
    inline Lane operator op(const Lane& a, const Lane& b) {                    \
        Lane made;                                                             \
        for (int i = 0; i < LANES; ++i) made.v[i] = a.v[i] op b.v[i];          \
        return made;                                                           \
    }                                                                          \
    inline Lane operator op(const Lane& a, double b) {                         \
        Lane made;                                                             \
        for (int i = 0; i < LANES; ++i) made.v[i] = a.v[i] op b;               \
        return made;                                                           \
    }
KINESIC_LANE_OPERATOR(+)
KINESIC_LANE_OPERATOR(-)
KINESIC_LANE_OPERATOR(*)
KINESIC_LANE_OPERATOR(/)
#undef KINESIC_LANE_OPERATOR

using Lane3 = std::array<Lane, 3>;
using Lane6 = std::array<Lane, 6>;
using Symmetric6 = std::array<Lane, 21>;  // lower triangle, row by row

constexpr int entry(int i, int j) { return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i; }

inline Lane3 cross(const Lane3& a, const Lane3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline Lane dot(const Lane6& a, const Lane6& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

inline Lane6 product(const Symmetric6& matrix, const Lane6& vector) {
    Lane6 made;
    for (int i = 0; i < 6; ++i) {
        made[i] = matrix[entry(i, 0)] * vector[0];
        for (int j = 1; j < 6; ++j) made[i] = made[i] + matrix[entry(i, j)] * vector[j];
    }
    return made;
}

// Multiplies a rotation from the right by one about a link's own axis (Rodrigues' formula).
inline void turned(const double* a, const Lane& angle, std::array<Lane, 9>& rotation) {
    Lane sine, rest;
    for (int m = 0; m < LANES; ++m) {
        sine.v[m] = std::sin(angle.v[m]);
        rest.v[m] = 1.0 - std::cos(angle.v[m]);
    }
    for (int i = 0; i < 3; ++i) {
        Lane &x = rotation[3 * i], &y = rotation[3 * i + 1], &z = rotation[3 * i + 2];
        const Lane ox = y * a[2] - z * a[1], oy = z * a[0] - x * a[2], oz = x * a[1] - y * a[0];
        const Lane px = oy * a[2] - oz * a[1], py = oz * a[0] - ox * a[2], pz = ox * a[1] - oy * a[0];
        x = x + sine * ox + rest * px;
        y = y + sine * oy + rest * py;
        z = z + sine * oz + rest * pz;
    }
}

// Returns W = J M^-1 J' of a point, given the link's inverse inertia.
inline std::array<Lane, 6> mobility_at(const Symmetric6& inverse, const Lane3& p) {
    Lane3 rows[6];  // inverse inertia times the transposed map from twists to velocities of the point
    for (int i = 0; i < 6; ++i) {
        const Lane &x = inverse[entry(i, 0)], &y = inverse[entry(i, 1)], &z = inverse[entry(i, 2)];
        rows[i] = {inverse[entry(i, 3)] + (y * p[2] - z * p[1]), inverse[entry(i, 4)] + (z * p[0] - x * p[2]),
                   inverse[entry(i, 5)] + (x * p[1] - y * p[0])};
    }
    std::array<Lane, 6> made;
    for (int i = 0, k = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j, ++k) {
            const int a = (i + 1) % 3, b = (i + 2) % 3;
            made[size_t(k)] = rows[i + 3][j] + (rows[a][j] * p[b] - rows[b][j] * p[a]);
        }
    return made;
}

// Returns v' (W + I x)^-1 v by cofactors.
inline Lane quotient(const std::array<Lane, 6>& w, double x, const Lane3& v) {
    const Lane a = w[0] + x, b = w[2] + x, c = w[5] + x, &d = w[1], &e = w[3], &f = w[4];
    const Lane xx = b * c - f * f, yy = a * c - e * e, zz = a * b - d * d;
    const Lane xy = e * f - d * c, xz = d * f - e * b, yz = d * e - a * f;
    const Lane determinant = a * xx + d * xy + e * xz;
    const Lane sum = v[0] * v[0] * xx + v[1] * v[1] * yy + v[2] * v[2] * zz +
                     (v[0] * v[1] * xy + v[0] * v[2] * xz + v[1] * v[2] * yz) * 2.0;
    return sum / determinant;
}

}  // namespace kinesic::sim
