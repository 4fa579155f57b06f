// 3D vectors and rotation matrices: the same arithmetic as kinesic/ik/scalar3.py, in the same order.

#pragma once

#include <cmath>

#include "arm_angles.h"

namespace kinesic::arm {

constexpr double PI = 3.14159265358979323846;
constexpr double TAU = 2.0 * PI;

struct Vector {
    double x = 0.0, y = 0.0, z = 0.0;
};

inline Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(const Vector& a, double factor) { return {a.x * factor, a.y * factor, a.z * factor}; }

inline double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double norm(const Vector& a) { return std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }
inline double distance(const Vector& a, const Vector& b) { return norm(a - b); }
inline bool null(const Vector& a) { return a.x == 0.0 && a.y == 0.0 && a.z == 0.0; }

// Unit direction; the null vector stays null.
inline Vector unit(const Vector& a) {
    const double length = norm(a);
    return length > 0.0 ? a * (1.0 / length) : a;
}

// Component perpendicular to a unit axis.
inline Vector across(const Vector& a, const Vector& axis) { return a - axis * dot(a, axis); }

// Rotation about a unit axis (Rodrigues), given cosine and sine of the angle.
inline Vector turned(const Vector& a, const Vector& axis, double c, double s) {
    const double d = dot(axis, a) * (1.0 - c);
    const Vector k = cross(axis, a);
    return {a.x * c + k.x * s + axis.x * d, a.y * c + k.y * s + axis.y * d, a.z * c + k.z * s + axis.z * d};
}

inline Vector turned(const Vector& a, const Vector& axis, double angle) {
    const Turn turn = turn_of(angle);
    return turned(a, axis, turn.cosine, turn.sine);
}

// Equivalent angle nearest to zero [rad]. Subtracting one turn is as exact as std::remainder, in a tenth of its time.
inline double wrapped(double angle) {
    if (std::abs(angle) <= PI) return angle;
    const double once = angle - std::copysign(TAU, angle);
    return std::abs(once) < PI ? once : std::remainder(angle, TAU);
}

struct Rotation {  // columns: axes of the frame
    Vector x{1.0, 0.0, 0.0}, y{0.0, 1.0, 0.0}, z{0.0, 0.0, 1.0};
};

// From frame to base coordinates: R a.
inline Vector rotated(const Rotation& r, const Vector& a) {
    return {r.x.x * a.x + r.y.x * a.y + r.z.x * a.z, r.x.y * a.x + r.y.y * a.y + r.z.y * a.z,
            r.x.z * a.x + r.y.z * a.y + r.z.z * a.z};
}

// From base to frame coordinates: R transposed times a.
inline Vector within(const Rotation& r, const Vector& a) { return {dot(r.x, a), dot(r.y, a), dot(r.z, a)}; }

// R about(axis, angle), given cosine and sine of the angle.
inline Rotation after(const Rotation& r, const Vector& axis, double c, double s) {
    const double d = 1.0 - c;
    const double xs = axis.x * s, ys = axis.y * s, zs = axis.z * s;
    const double xy = axis.x * axis.y * d, xz = axis.x * axis.z * d, yz = axis.y * axis.z * d;
    return {rotated(r, {c + axis.x * axis.x * d, xy + zs, xz - ys}),
            rotated(r, {xy - zs, c + axis.y * axis.y * d, yz + xs}),
            rotated(r, {xz + ys, yz - xs, c + axis.z * axis.z * d})};
}

inline Rotation after(const Rotation& r, const Vector& axis, double angle) {
    const Turn turn = turn_of(angle);
    return after(r, axis, turn.cosine, turn.sine);
}

}  // namespace kinesic::arm
