// Hand orientations (kinesic/ik/arm/orientation.py): from two directions, and the wrist angles for them.

#pragma once

#include "arm_hinges.h"
#include "arm_wrist.h"

namespace kinesic::arm {

constexpr double NEGLIGIBLE_ROTATION = 1e-6;  // [rad] rotations below this count as zero

inline Rotation product(const Rotation& a, const Rotation& b) {
    return {rotated(a, b.x), rotated(a, b.y), rotated(a, b.z)};
}

inline Rotation transposed(const Rotation& r) {
    return {{r.x.x, r.y.x, r.z.x}, {r.x.y, r.y.y, r.z.y}, {r.x.z, r.y.z, r.z.z}};
}

// Shortest rotation between two orientations as a vector [rad] in the base.
inline Vector shortest_turn(const Rotation& present, const Rotation& wanted) {
    const Rotation m = product(wanted, transposed(present));
    const Vector axis{m.y.z - m.z.y, m.z.x - m.x.z, m.x.y - m.y.x};
    const double twice_sine = norm(axis), twice_cosine = m.x.x + m.y.y + m.z.z - 1.0;
    if (twice_sine < 1e-12 && twice_cosine < 0.0) {
        const Vector rows[3] = {
            {m.x.x + 1.0, m.y.x, m.z.x}, {m.x.y, m.y.y + 1.0, m.z.y}, {m.x.z, m.y.z, m.z.z + 1.0}};
        const int widest = m.x.x >= m.y.y && m.x.x >= m.z.z ? 0 : m.y.y >= m.z.z ? 1 : 2;
        return unit(rows[widest]) * PI;
    }
    return axis * (twice_sine > 0.0 ? arctangent(twice_sine, twice_cosine) / twice_sine : 0.5);
}

// Orientation with the requested pointing and the nearest possible palm direction; false if the palm's direction is
// parallel to the pointing.
inline bool orientation_of(const Vector& along, const Vector& palm, const Vector& pointing, const Vector& facing,
                           Rotation& wanted) {
    const Vector own = across(palm, along), seen = across(facing, pointing);
    if (norm(own) < NEGLIGIBLE_ROTATION || norm(seen) < NEGLIGIBLE_ROTATION) return false;
    const Vector aside = unit(own), turned_aside = unit(seen);
    const Rotation mine{along, aside, cross(along, aside)};
    const Rotation theirs{pointing, turned_aside, cross(pointing, turned_aside)};
    wanted = product(theirs, transposed(mine));
    return true;
}

namespace wrist {

// Solves about(a1, q1) about(a2, q2) about(a3, q3) = R for both branches: the image of a3 under R gives q1 and q2.
inline int three_turns(const Pivot* pivots, const Rotation& wanted, const double* now, double ways[2][3]) {
    const Vector &first = pivots[0].axis, &second = pivots[1].axis, &third = pivots[2].axis;
    const Vector aside =
        unit(across(std::abs(third.z) < 0.9 ? Vector{0.0, 0.0, 1.0} : Vector{1.0, 0.0, 0.0}, third));
    const Vector tip = rotated(wanted, third), edge = rotated(wanted, aside);
    double firsts[2] = {now[0], 0.0};
    const int count = std::max(1, first_of_two(first, second, third, tip, firsts));
    for (int way = 0; way < count; ++way) {
        double* turns = ways[way];
        turns[0] = firsts[way];
        if (!turn_towards(second, third, turned(tip, first, -turns[0]), turns[1])) turns[1] = now[1];
        const Vector seen = turned(turned(edge, first, -turns[0]), second, -turns[1]);
        if (!turn_towards(third, aside, seen, turns[2])) turns[2] = now[2];
    }
    return count;
}

}  // namespace wrist

// Wrist angles in range for an orientation, from the frame of the forearm; returns the remaining rotation [rad].
inline double face(const Linkage& arm, const Rotation& frame, const Rotation& wanted, const double* near,
                   double* angles) {
    const int hinges = arm.last().count;
    const Pivot* pivots = arm.pivot + arm.own();
    const double* now = near + arm.own();
    const Rotation inner = product(transposed(frame), wanted);
    double ways[2][MAX_HINGES], three[2][3], least = INFINITY, shortest = INFINITY;
    int count = 1;
    if (hinges == 3) {
        count = wrist::three_turns(pivots, inner, now, three);
        for (int way = 0; way < count; ++way) std::copy_n(three[way], 3, ways[way]);
    } else {
        const Wish wishes[2] = {{{1.0, 0.0, 0.0}, wanted.x}, {{0.0, 0.0, 1.0}, wanted.z}};
        orient(arm, frame, wishes, 2, now, ways[0]);
    }
    double left = INFINITY;
    for (int way = 0; way < count; ++way) {
        Rotation held;
        double travel = 0.0;
        for (int k = 0; k < hinges; ++k) {
            ways[way][k] = pivots[k].held(ways[way][k], now[k]);
            held = behind(held, pivots[k], ways[way][k]);
            travel += std::abs(ways[way][k] - now[k]);
        }
        const double turn = norm(shortest_turn(held, inner)), price = turn > NEGLIGIBLE_ROTATION ? turn : 0.0;
        if (way > 0 && (price > least || (price == least && travel >= shortest))) continue;
        least = price, shortest = travel, left = turn;
        std::copy_n(ways[way], hinges, angles);
    }
    return left;
}

}  // namespace kinesic::arm
