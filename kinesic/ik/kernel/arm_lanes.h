// Several arms in step: one number of each beside the other, in the registers that every processor of its kind has.

#pragma once

#include "arm_linkage.h"

namespace kinesic::arm {

constexpr int LANES = 2;
typedef double Lanes __attribute__((vector_size(8 * LANES)));
typedef long long Mask __attribute__((vector_size(8 * LANES)));  // of each lane all bits or none

inline Lanes all(double value) { return Lanes{} + value; }
inline Lanes either(Mask mask, Lanes yes, Lanes no) { return Lanes((mask & Mask(yes)) | (~mask & Mask(no))); }
inline Lanes only(Mask mask, Lanes value) { return Lanes(mask & Mask(value)); }

inline bool any(Mask mask) {
    long long bits = 0;
    for (int i = 0; i < LANES; ++i) bits |= mask[i];
    return bits != 0;
}

inline Lanes root(Lanes a) {
    for (int i = 0; i < LANES; ++i) a[i] = std::sqrt(a[i]);
    return a;
}

// Sine and cosine of angles of a few turns: Cody and Waite's reduction to an eighth of a turn, then the minimax
// polynomials of fdlibm; within one unit in the last place.
inline void sincos(Lanes angle, Lanes& sine, Lanes& cosine) {
    const Lanes shift = all(6755399441055744.0);  // 1.5 x 2^52: adding it rounds, and leaves the integer in the low bits
    const Lanes shifted = angle * (2.0 / PI) + shift;
    const Lanes quarters = shifted - shift;
    const Lanes x = ((angle - quarters * 1.57079632673412561417e+00) - quarters * 6.07710050630396597660e-11) -
                    quarters * 2.02226624879595063154e-21;
    const Lanes z = x * x;
    const Lanes s =
        x + x * z *
                (-1.66666666666666324348e-01 +
                 z * (8.33333333332248946124e-03 +
                      z * (-1.98412698298579493134e-04 +
                           z * (2.75573137070700676789e-06 +
                                z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)))));
    const Lanes c =
        1.0 - 0.5 * z +
        z * z *
            (4.16666666666666019037e-02 +
             z * (-1.38888888888741095749e-03 +
                  z * (2.48015872894767294178e-05 +
                       z * (-2.75573143513906633035e-07 +
                            z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    const Mask quarter = Mask(shifted);
    const Mask swapped = -(quarter & 1);
    sine = Lanes(Mask(either(swapped, c, s)) ^ ((quarter & 2) << 62));
    cosine = Lanes(Mask(either(swapped, s, c)) ^ (((quarter + 1) & 2) << 62));
}

struct Vectors {
    Lanes x, y, z;
};

inline Vectors all(const Vector& a) { return {all(a.x), all(a.y), all(a.z)}; }
inline Vectors operator+(const Vectors& a, const Vectors& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vectors operator-(const Vectors& a, const Vectors& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vectors operator*(const Vectors& a, Lanes factor) { return {a.x * factor, a.y * factor, a.z * factor}; }
inline Lanes dot(const Vectors& a, const Vectors& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lanes norm(const Vectors& a) { return root(dot(a, a)); }

inline Vectors cross(const Vectors& a, const Vectors& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline Vectors either(Mask mask, const Vectors& yes, const Vectors& no) {
    return {either(mask, yes.x, no.x), either(mask, yes.y, no.y), either(mask, yes.z, no.z)};
}

struct Rotations {
    Vectors x = all(Vector{1.0, 0.0, 0.0}), y = all(Vector{0.0, 1.0, 0.0}), z = all(Vector{0.0, 0.0, 1.0});
};

inline Vectors rotated(const Rotations& r, const Vector& a) {
    return {r.x.x * a.x + r.y.x * a.y + r.z.x * a.z, r.x.y * a.x + r.y.y * a.y + r.z.y * a.z,
            r.x.z * a.x + r.y.z * a.y + r.z.z * a.z};
}

// Where a hinge's axis points.
inline Vectors pointing(const Rotations& r, const Pivot& pivot) {
    switch (pivot.kind) {
        case Kind::x: return r.x * all(pivot.axis.x);
        case Kind::y: return r.y * all(pivot.axis.y);
        case Kind::z: return r.z * all(pivot.axis.z);
        default: return rotated(r, pivot.axis);
    }
}

// The frames behind a hinge. An oblique axis turns each column a of the frame about the axis u in the base:
// a cos + (u x a) sin + u (u.a) (1 - cos).
inline Rotations behind(const Rotations& r, const Pivot& pivot, const Vectors& axis, Lanes angle) {
    Lanes s, c;
    sincos(angle, s, c);
    switch (pivot.kind) {
        case Kind::x: s = s * pivot.axis.x; return {r.x, r.y * c + r.z * s, r.z * c - r.y * s};
        case Kind::y: s = s * pivot.axis.y; return {r.x * c - r.z * s, r.y, r.x * s + r.z * c};
        case Kind::z: s = s * pivot.axis.z; return {r.x * c + r.y * s, r.y * c - r.x * s, r.z};
        default: break;
    }
    const auto turned = [&](const Vectors& a) {
        return a * c + cross(axis, a) * s + axis * (dot(axis, a) * (1.0 - c));
    };
    return {turned(r.x), turned(r.y), turned(r.z)};
}

}  // namespace kinesic::arm
