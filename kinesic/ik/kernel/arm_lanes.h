// Several arms at once: one number of each arm per lane of a SIMD register that every processor of this kind has.

#pragma once

#include "arm_linkage.h"

#if defined(_MSC_VER) && !defined(__clang__) && !defined(KINESIC_PLAIN_LANES)
#define KINESIC_PLAIN_LANES
#endif
#ifdef KINESIC_PLAIN_LANES
#include "plain_lanes.h"
#endif

namespace kinesic::arm {

constexpr int LANES = 2;
#ifndef KINESIC_PLAIN_LANES
typedef double Lanes __attribute__((vector_size(8 * LANES)));
typedef long long Mask __attribute__((vector_size(8 * LANES)));  // all bits of a lane are set, or none
#endif

inline Lanes all(double value) { return Lanes{value, value}; }
inline Lanes either(Mask mask, Lanes yes, Lanes no) { return Lanes((mask & Mask(yes)) | (~mask & Mask(no))); }
inline Lanes only(Mask mask, Lanes value) { return Lanes(mask & Mask(value)); }

inline Lanes magnitude(Lanes value) { return Lanes(Mask(value) & ~Mask(all(-0.0))); }

inline bool any(Mask mask) {
    long long bits = 0;
    for (int i = 0; i < LANES; ++i) bits |= mask[i];
    return bits != 0;
}

inline Lanes root(Lanes a) {
    for (int i = 0; i < LANES; ++i) a[i] = std::sqrt(a[i]);
    return a;
}

// Sine and cosine of moderate angles: Cody and Waite's reduction to an eighth of a turn, then the minimax
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

struct Turns {
    Lanes cosine, sine;
};

// Same as for one angle in arm_angles.h, whose bits come from here.
Turns turns_of(Lanes angle);
Lanes arctangent(Lanes y, Lanes x);

struct Vectors {
    Lanes x, y, z;
};

inline Vector lane(const Vectors& a, int which) { return {a.x[which], a.y[which], a.z[which]}; }
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

inline Rotation lane(const Rotations& r, int which) { return {lane(r.x, which), lane(r.y, which), lane(r.z, which)}; }
inline Rotations all(const Rotation& r) { return {all(r.x), all(r.y), all(r.z)}; }

template <class Each>  // Vector or Vectors
Vectors rotated(const Rotations& r, const Each& a) {
    return {r.x.x * a.x + r.y.x * a.y + r.z.x * a.z, r.x.y * a.x + r.y.y * a.y + r.z.y * a.z,
            r.x.z * a.x + r.y.z * a.y + r.z.z * a.z};
}

// Direction of a hinge's axis.
inline Vectors pointing(const Rotations& r, const Pivot& pivot) {
    switch (pivot.kind) {
        case Kind::x: return r.x * all(pivot.axis.x);
        case Kind::y: return r.y * all(pivot.axis.y);
        case Kind::z: return r.z * all(pivot.axis.z);
        default: return rotated(r, pivot.axis);
    }
}

// Same as `turned` for one vector.
inline Vectors turned(const Vectors& a, const Vector& axis, Lanes c, Lanes s) {
    const Lanes d = (axis.x * a.x + axis.y * a.y + axis.z * a.z) * (1.0 - c);
    const Vectors k{axis.y * a.z - axis.z * a.y, axis.z * a.x - axis.x * a.z, axis.x * a.y - axis.y * a.x};
    return {a.x * c + k.x * s + axis.x * d, a.y * c + k.y * s + axis.y * d, a.z * c + k.z * s + axis.z * d};
}

// Same as `behind` for one frame.
inline Rotations behind(const Rotations& r, const Pivot& pivot, const Turns& turns) {
    const Lanes c = turns.cosine, s = turns.sine, d = 1.0 - c, one = c + d;
    const Vector& a = pivot.axis;
    switch (pivot.kind) {
        case Kind::x: return {r.x * one, r.y * c + r.z * (a.x * s), r.z * c - r.y * (a.x * s)};
        case Kind::y: return {r.x * c - r.z * (a.y * s), r.y * one, r.x * (a.y * s) + r.z * c};
        case Kind::z: return {r.x * c + r.y * (a.z * s), r.y * c - r.x * (a.z * s), r.z * one};
        default: break;
    }
    const Lanes xs = a.x * s, ys = a.y * s, zs = a.z * s;
    const Lanes xy = a.x * a.y * d, xz = a.x * a.z * d, yz = a.y * a.z * d;
    return {rotated(r, Vectors{c + a.x * a.x * d, xy + zs, xz - ys}),
            rotated(r, Vectors{xy - zs, c + a.y * a.y * d, yz + xs}),
            rotated(r, Vectors{xz + ys, yz - xs, c + a.z * a.z * d})};
}

}  // namespace kinesic::arm
