// Ball chains without limits: n bones in a row, from the base outward, and the rotation of each.
//
// All lengths are in units of the chain's length, with the base at the origin, so that thresholds hold for every chain.
// All methods share these types, this forward kinematics and this arithmetic, so that their times are comparable.

#pragma once

#include "arm_vectors.h"

namespace kinesic::chains {

using arm::Vector;

constexpr int MAX_BONES = 32;

struct Quaternion {
    double w, x, y, z;
};

constexpr Quaternion NO_ROTATION{1.0, 0.0, 0.0, 0.0};

struct Chain {
    int bones;
    double lengths[MAX_BONES];
    Vector along[MAX_BONES];  // unit direction of each bone at rest
};

struct Goal {
    Vector target;  // inside the reach
    double tolerance;
    int max_iterations;
};

struct Posture {
    Vector points[MAX_BONES + 1];  // joint centres and the tip; the first is the origin
    Quaternion frames[MAX_BONES];  // rotation of each bone from rest, in the base frame
};

inline Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

inline Quaternion conjugate(const Quaternion& q) { return {q.w, -q.x, -q.y, -q.z}; }

inline Quaternion normalised(const Quaternion& q) {
    const double factor = 1.0 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {q.w * factor, q.x * factor, q.y * factor, q.z * factor};
}

// q a q*: a + 2 w (v x a) + 2 v x (v x a).
inline Vector rotated(const Quaternion& q, const Vector& a) {
    const Vector v{q.x, q.y, q.z};
    const Vector t = cross(v, a) * 2.0;
    return a + t * q.w + cross(v, t);
}

// Any unit vector perpendicular to a unit vector.
inline Vector aside(const Vector& a) {
    const bool flat = std::abs(a.x) < 0.6;
    return unit(cross(a, flat ? Vector{1.0, 0.0, 0.0} : Vector{0.0, 1.0, 0.0}));
}

// The shortest rotation from one unit vector to another, by their bisector. Opposite vectors have no bisector: a rotation
// by half a turn about any perpendicular axis comes first.
inline Quaternion arc(const Vector& from, const Vector& to) {
    const Vector sum = from + to;
    const double square = dot(sum, sum);
    if (square < 1e-12) {
        const Vector axis = aside(from);
        return arc(from * -1.0, to) * Quaternion{0.0, axis.x, axis.y, axis.z};
    }
    const Vector half = sum * (1.0 / std::sqrt(square));
    const Vector v = cross(from, half);
    return {dot(from, half), v.x, v.y, v.z};
}

// exp(omega / 2): the quaternion of a rotation vector [rad].
inline Quaternion turn(const Vector& omega) {
    const double angle = norm(omega);
    const double scale = angle > 1e-9 ? std::sin(0.5 * angle) / angle : 0.5;
    return {std::cos(0.5 * angle), omega.x * scale, omega.y * scale, omega.z * scale};
}

inline Posture at_rest(const Chain& chain) {
    Posture posture;
    for (int i = 0; i < chain.bones; ++i) {
        posture.frames[i] = NO_ROTATION;
        posture.points[i + 1] = posture.points[i] + chain.along[i] * chain.lengths[i];
    }
    return posture;
}

// Rotates all joints at once, each by a rotation in base coordinates: frame_i <- turn_0 .. turn_i frame_i.
inline void turn_joints(const Chain& chain, const Quaternion* turns, Posture& posture) {
    Quaternion sum = NO_ROTATION;
    for (int i = 0; i < chain.bones; ++i) {
        sum = sum * turns[i];
        posture.frames[i] = normalised(sum * posture.frames[i]);
        const Vector bone = rotated(posture.frames[i], chain.along[i]) * chain.lengths[i];
        posture.points[i + 1] = posture.points[i] + bone;
    }
}

// Computes rotations from points: each bone rotates by the shortest rotation relative to its parent (the thesis's bone
// and up vectors, 7.3.1). The points are then recomputed from the rotations, so that bones keep their exact length.
inline void aim(const Chain& chain, Posture& posture) {
    Quaternion parent = NO_ROTATION;
    Vector end;
    for (int i = 0; i < chain.bones; ++i) {
        const Vector wanted = unit(posture.points[i + 1] - posture.points[i]);
        const Vector carried = rotated(parent, chain.along[i]);
        posture.points[i] = end;
        posture.frames[i] = null(wanted) ? parent : normalised(arc(carried, wanted) * parent);
        parent = posture.frames[i];
        end = end + rotated(parent, chain.along[i]) * chain.lengths[i];
    }
    posture.points[chain.bones] = end;
}

// Rotation of joint i in the frame of its parent bone.
inline Quaternion local(const Posture& posture, int i) {
    return i == 0 ? posture.frames[0] : conjugate(posture.frames[i - 1]) * posture.frames[i];
}

inline double residual(const Chain& chain, const Goal& goal, const Posture& posture) {
    return distance(posture.points[chain.bones], goal.target);
}

}  // namespace kinesic::chains
