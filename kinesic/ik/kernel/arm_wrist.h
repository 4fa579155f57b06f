// Turns the hand's own hinges so that it points and its palm faces as asked (kinesic/ik/arm/wrist.py).

#pragma once

#include <algorithm>

#include "arm_linkage.h"

namespace kinesic::arm {

constexpr int MOST_WISHES = 2;

struct Wish {
    Vector own, wanted;  // unit, in the last segment and in the base
};

namespace wrist {

constexpr int ROUNDS = 40;
constexpr double TOLERANCE = 1e-6;
constexpr double PERFECT = 1e-4;
constexpr double POSTURE = 2e-4;

struct Peak {
    double angle, height;
};

// How well directions agree is A cos q + B sin q in each single hinge: its best angle inside the range.
inline Peak best(const Pivot& pivot, const Vector* looks, const Vector* owns, int wishes, double rest) {
    const Turn home = turn_of(rest);
    double a = POSTURE * home.cosine, b = POSTURE * home.sine, level = 0.0;
    for (int i = 0; i < wishes; ++i) {
        const double along = dot(pivot.axis, looks[i]) * dot(pivot.axis, owns[i]);
        level += along;
        a += dot(looks[i], owns[i]) - along;
        b += dot(looks[i], cross(pivot.axis, owns[i]));
    }
    const auto height = [&a, &b](double angle) {
        const Turn turn = turn_of(angle);
        return a * turn.cosine + b * turn.sine;
    };
    double peak = arctangent(b, a);
    if (!(pivot.lower <= peak && peak <= pivot.upper))
        peak = height(pivot.upper) > height(pivot.lower) ? pivot.upper : pivot.lower;
    return {peak, level + height(peak)};
}

// Hinge after hinge to its best angle until none moves; how well the directions agree then.
inline double climbed(const Linkage& arm, const Vector* wanted, const Wish* wishes, int count, const double* rest,
                      double* angles) {
    const Pivot* pivots = arm.pivot + arm.own();
    const int hinges = arm.last().count;
    double height = 0.0;
    for (int round = 0; round < ROUNDS; ++round) {
        double change = 0.0;
        for (int k = 0; k < hinges; ++k) {
            Vector looks[MOST_WISHES], owns[MOST_WISHES];
            for (int i = 0; i < count; ++i) {
                looks[i] = wanted[i];
                owns[i] = wishes[i].own;
                for (int j = 0; j < k; ++j) looks[i] = turned(looks[i], pivots[j].axis, -angles[j]);
                for (int j = hinges - 1; j > k; --j) owns[i] = turned(owns[i], pivots[j].axis, angles[j]);
            }
            const Peak peak = best(pivots[k], looks, owns, count, rest[k]);
            change = std::max(change, std::abs(peak.angle - angles[k]));
            angles[k] = peak.angle;
            height = peak.height;
        }
        if (change < TOLERANCE) break;
    }
    return height;
}

}  // namespace wrist

// The angles of the hand's own hinges; where stops make several peaks the climb begins again at each corner.
inline void orient(const Linkage& arm, const Rotation& frame, const Wish* wishes, int count, const double* rest,
                   double* angles) {
    const int hinges = arm.last().count;
    const Pivot* pivots = arm.pivot + arm.own();
    std::copy(rest, rest + hinges, angles);
    if (count == 0) return;
    Vector wanted[MOST_WISHES];
    for (int i = 0; i < count; ++i) wanted[i] = within(frame, wishes[i].wanted);
    double height = wrist::climbed(arm, wanted, wishes, count, rest, angles);
    for (int corner = 0; corner < (1 << hinges) && height <= count - wrist::PERFECT; ++corner) {
        double tried[MOST_HINGES];
        for (int k = 0; k < hinges; ++k)
            tried[k] = corner >> (hinges - 1 - k) & 1 ? pivots[k].upper : pivots[k].lower;
        const double agreement = wrist::climbed(arm, wanted, wishes, count, rest, tried);
        if (agreement > height) {
            height = agreement;
            std::copy(tried, tried + hinges, angles);
        }
    }
}

// Turns the hand of an arm bent to `angles`, from the frame of its forearm; what each direction then is off [rad].
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
