// Wrist angles that meet pointing and palm directions (tests/reference/ik/wrist.py).

#pragma once

#include <algorithm>

#include "arm_linkage.h"

namespace kinesic::arm {

constexpr int MAX_DIRECTIONS = 2;

struct Wish {
    Vector own, wanted;  // unit: direction in the last segment, and desired direction in the base
};

namespace wrist {

constexpr int MAX_ITERATIONS = 40;
constexpr double TOLERANCE = 1e-6;            // [rad] largest hinge rotation of the last iteration
constexpr double AGREEMENT_TOLERANCE = 1e-4;  // distance from full agreement below which no restart is needed
constexpr double REST_WEIGHT = 2e-4;          // weight of the rest angles; each direction has weight 1

struct Aim {  // hinge at an angle
    double angle;
    Turn turn;
};

struct Hinge {  // wrist hinge, with the data that stay constant in the search
    Vector axis;
    Aim lower, upper;
    Turn home;  // rest angle
};

struct Peak {
    Aim aim;
    double height;
};

inline Aim aimed_at(double angle) { return {angle, turn_of(angle)}; }

inline Vector forth(const Vector& a, const Hinge& hinge, const Aim& aim) {
    return turned(a, hinge.axis, aim.turn.cosine, aim.turn.sine);
}

inline Vector back(const Vector& a, const Hinge& hinge, const Aim& aim) {
    return turned(a, hinge.axis, aim.turn.cosine, -aim.turn.sine);
}

// Agreement of directions is A cos q + B sin q in each hinge: returns its best angle in range.
inline Peak best(const Hinge& hinge, const Vector* looks, const Vector* owns, int wishes) {
    double a = REST_WEIGHT * hinge.home.cosine, b = REST_WEIGHT * hinge.home.sine, level = 0.0;
    for (int i = 0; i < wishes; ++i) {
        const double along = dot(hinge.axis, looks[i]) * dot(hinge.axis, owns[i]);
        level += along;
        a += dot(looks[i], owns[i]) - along;
        b += dot(looks[i], cross(hinge.axis, owns[i]));
    }
    const auto height = [&a, &b](const Aim& aim) { return a * aim.turn.cosine + b * aim.turn.sine; };
    const double peak = arctangent(b, a);
    const Aim aim = hinge.lower.angle <= peak && peak <= hinge.upper.angle ? aimed_at(peak)
                    : height(hinge.upper) > height(hinge.lower)            ? hinge.upper
                                                                           : hinge.lower;
    return {aim, level + height(aim)};
}

// Optimises one hinge after another until none moves; returns the agreement of the directions.
inline double climbed(const Hinge* hinge, int hinges, const Vector* wanted, const Wish* wishes, int count, Aim* aims) {
    double height = 0.0;
    for (int round = 0; round < MAX_ITERATIONS; ++round) {
        double change = 0.0;
        Vector looks[MAX_DIRECTIONS];             // desired directions before a hinge
        Vector owns[MAX_HINGES][MAX_DIRECTIONS];  // directions of the hand behind each hinge
        for (int i = 0; i < count; ++i) {
            looks[i] = wanted[i];
            owns[hinges - 1][i] = wishes[i].own;
            for (int k = hinges - 1; k > 0; --k) owns[k - 1][i] = forth(owns[k][i], hinge[k], aims[k]);
        }
        for (int k = 0; k < hinges; ++k) {
            const Peak peak = best(hinge[k], looks, owns[k], count);
            change = std::max(change, std::abs(peak.aim.angle - aims[k].angle));
            aims[k] = peak.aim;
            height = peak.height;
            for (int i = 0; i < count && k < hinges - 1; ++i) looks[i] = back(looks[i], hinge[k], aims[k]);
        }
        if (change <= TOLERANCE) break;
    }
    return height;
}

}  // namespace wrist

// Computes the wrist angles. The search restarts at each corner of the ranges, because limits cause local optima.
inline void orient(const Linkage& arm, const Rotation& frame, const Wish* wishes, int count, const double* rest,
                   double* angles) {
    const int hinges = arm.last().count;
    const Pivot* pivots = arm.pivot + arm.own();
    std::copy(rest, rest + hinges, angles);
    if (count == 0) return;
    wrist::Hinge hinge[MAX_HINGES];
    wrist::Aim found[MAX_HINGES];
    Vector wanted[MAX_DIRECTIONS];
    for (int k = 0; k < hinges; ++k) {
        found[k] = wrist::aimed_at(rest[k]);
        hinge[k] = {pivots[k].axis, wrist::aimed_at(pivots[k].lower), wrist::aimed_at(pivots[k].upper), found[k].turn};
    }
    for (int i = 0; i < count; ++i) wanted[i] = within(frame, wishes[i].wanted);
    double height = wrist::climbed(hinge, hinges, wanted, wishes, count, found);
    for (int corner = 0; corner < (1 << hinges) && height <= count - wrist::AGREEMENT_TOLERANCE; ++corner) {
        wrist::Aim tried[MAX_HINGES];
        for (int k = 0; k < hinges; ++k)
            tried[k] = corner >> (hinges - 1 - k) & 1 ? hinge[k].upper : hinge[k].lower;
        const double agreement = wrist::climbed(hinge, hinges, wanted, wishes, count, tried);
        if (agreement > height) {
            height = agreement;
            std::copy(tried, tried + hinges, found);
        }
    }
    for (int k = 0; k < hinges; ++k) angles[k] = found[k].angle;
}

// Turns the wrist of an arm with `angles`, from the frame of its forearm; computes the direction errors [rad].
inline void turn_hand(const Linkage& arm, Rotation frame, const Wish* wishes, int count, const double* home,
                      double* angles, double* errors) {
    orient(arm, frame, wishes, count, home + arm.own(), angles + arm.own());
    for (int k = arm.own(); k < arm.hinges; ++k) frame = behind(frame, arm.pivot[k], angles[k]);
    for (int i = 0; i < count; ++i) {
        const double agreement = dot(rotated(frame, wishes[i].own), wishes[i].wanted);
        errors[i] = arccosine(std::max(-1.0, std::min(1.0, agreement)));
    }
}

}  // namespace kinesic::arm
