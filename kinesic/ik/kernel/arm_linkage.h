// Kinematic chain of an arm (kinesic/ik/arm/linkage.py) in arrays of fixed size.

#pragma once

#include "arm_vectors.h"

namespace kinesic::arm {

constexpr int MAX_LINKS = 8;
constexpr int MAX_HINGES = 12;
constexpr int MAX_SEEDS = 64;

enum class Kind { x, y, z, oblique };  // axis of its frame along which a hinge lies

struct Pivot {  // one hinge
    Vector axis;
    double lower = 0.0, upper = 0.0, rest = 0.0;  // [rad]
    Kind kind = Kind::oblique;

    Pivot() = default;
    Pivot(const Vector& axis, double lower, double upper, double rest)
        : axis(axis), lower(lower), upper(upper), rest(rest) {
        if (axis.y == 0.0 && axis.z == 0.0) kind = Kind::x;
        if (axis.x == 0.0 && axis.z == 0.0) kind = Kind::y;
        if (axis.x == 0.0 && axis.y == 0.0) kind = Kind::z;
    }

    // Returns the equivalent angle in range nearest to `near`, or the nearer limit.
    double held(double angle, double near) const {
        const double same = near + wrapped(angle - near);
        if (lower <= same && same <= upper) return same;
        if (lower <= same - TAU && same - TAU <= upper) return same - TAU;
        if (lower <= same + TAU && same + TAU <= upper) return same + TAU;
        return std::abs(wrapped(same - lower)) < std::abs(wrapped(same - upper)) ? lower : upper;
    }

    double clipped(double angle) const { return angle < lower ? lower : angle > upper ? upper : angle; }
};

struct Link {  // bone with the hinges that aim it
    int first = 0, count = 0;  // its hinges in the chain
    Vector bone, along;        // [m] bone vector, and its direction
    double length = 0.0;       // [m]
};

struct Arc {  // arc of a bone's end as its last hinge rotates, seen from the bone's start
    Vector lower, upper;  // [m] end of the bone at both limits
    Vector middle;        // direction from the hinge's axis to the middle of the arc; null for a bone along it
    double opening = 0.0;  // cosine of half the range; -2 for a whole turn
    double height = 0.0;  // [m] along the axis

    Arc() = default;
    Arc(const Pivot& last, const Vector& bone) {
        const double half = 0.5 * (last.upper - last.lower);
        lower = turned(bone, last.axis, last.lower);
        upper = turned(bone, last.axis, last.upper);
        middle = unit(across(turned(bone, last.axis, last.lower + half), last.axis));
        opening = half < PI ? turn_of(half).cosine : -2.0;
        height = dot(last.axis, bone);
    }
};

struct Seed {  // start posture with its hand position
    double angles[MAX_HINGES];
    Vector hand;
};

struct Linkage {
    Vector origin;  // [m] in the base
    int links = 0, hinges = 0, seeds = 0;
    Link link[MAX_LINKS];  // from the base outward; the last bone is the hand, which moves no joint
    Arc arc[MAX_LINKS];    // arc of each link with hinges
    Pivot pivot[MAX_HINGES];
    double side = 1.0;      // +1: an arm on the left; -1: on the right
    double farthest = 0.0;  // [m] shoulder to hand with the elbow as straight as possible
    double closest = 0.0;   // [m] shoulder to hand with the elbow as bent as possible
    Vector palm;            // unit, in the last segment
    Vector resting;         // [m] shoulder position with the collar bone at rest
    Seed seed[MAX_SEEDS];  // last, because few solves read them

    int girdle() const { return links - 3; }                   // number of links before the shoulder
    int own() const { return link[links - 1].first; }          // number of hinges before those of the hand
    const Link& upper() const { return link[links - 3]; }      // from shoulder to elbow
    const Link& fore() const { return link[links - 2]; }       // from elbow to hand
    const Link& last() const { return link[links - 1]; }       // along the hand

    void draw_arcs() {
        for (int j = 0; j < links; ++j)
            if (link[j].count > 0) arc[j] = Arc(pivot[link[j].first + link[j].count - 1], link[j].bone);
    }
};

// Computes the frame behind a hinge like `after`, without products with the zeros of most axes.
inline Rotation behind(const Rotation& r, const Pivot& pivot, double angle) {
    const auto [c, s] = turn_of(angle);
    const double one = c + (1.0 - c);
    const Vector& a = pivot.axis;
    switch (pivot.kind) {
        case Kind::x: return {r.x * one, r.y * c + r.z * (a.x * s), r.y * -(a.x * s) + r.z * c};
        case Kind::y: return {r.x * c + r.z * -(a.y * s), r.y * one, r.x * (a.y * s) + r.z * c};
        case Kind::z: return {r.x * c + r.y * (a.z * s), r.x * -(a.z * s) + r.y * c, r.z * one};
        default: return after(r, a, c, s);
    }
}

// Forward kinematics: frame after `count` links, and their joint centres, one more than links.
inline Rotation walk(const Linkage& arm, const double* angles, int count, Vector* points) {
    Rotation rotation;
    points[0] = arm.origin;
    for (int j = 0; j < count; ++j) {
        const Link& link = arm.link[j];
        for (int k = link.first; k < link.first + link.count; ++k)
            rotation = behind(rotation, arm.pivot[k], angles[k]);
        points[j + 1] = points[j] + rotated(rotation, link.bone);
    }
    return rotation;
}

inline Vector hand(const Linkage& arm, const double* angles) {
    Vector points[MAX_LINKS + 1];
    walk(arm, angles, arm.links - 1, points);
    return points[arm.links - 1];
}

}  // namespace kinesic::arm
