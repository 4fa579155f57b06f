// From points to hinge angles in closed form, every branch looked at (kinesic/ik/arm/hinges.py).

#pragma once

#include <algorithm>

#include "arm_linkage.h"

namespace kinesic::arm {

constexpr double UNDEFINED = 1e-9;    // nearer than this to the axis, a direction defines no angle
constexpr double MISS_COST = 1e3;     // per arm length that a joint misses its point
constexpr double TRAVEL_COST = 1e-3;  // per radian away from the current angles
constexpr double SLACK = 1e-3;        // of the bones' length: costs as much as a travel of a thousand radians

// Subproblem 1: th = atan2(a.(r x v), r.v - (a.r)(a.v)); false where a direction lies along the axis.
inline bool turn_towards(const Vector& axis, const Vector& rest, const Vector& wanted, double& turn) {
    const double s = dot(axis, cross(rest, wanted));
    const double c = dot(rest, wanted) - dot(axis, rest) * dot(axis, wanted);
    if (std::sqrt(s * s + c * c) < UNDEFINED) return false;
    turn = arctangent(s, c);
    return true;
}

// Subproblem 2, its first hinge: A cos q1 + B sin q1 = C. Up to two branches; their number is returned.
inline int first_of_two(const Vector& first, const Vector& second, const Vector& rest, const Vector& wanted,
                        double* turns) {
    const double along = dot(first, wanted), skew = dot(second, first);
    const double a = dot(second, wanted) - skew * along;
    const double b = -dot(second, cross(first, wanted));
    const double c = dot(second, rest) - skew * along;
    const double rho = std::sqrt(a * a + b * b);
    if (rho < UNDEFINED) return 0;
    const double middle = arctangent(b, a);
    if (std::abs(c) >= rho) {
        turns[0] = c > 0.0 ? middle : middle + PI;
        return 1;
    }
    const double spread = arccosine(c / rho);
    turns[0] = middle + spread;
    turns[1] = middle - spread;
    return 2;
}

struct Extraction {
    double angles[MOST_HINGES] = {};  // [rad] of the hinges of the extracted bones
    double miss = INFINITY;      // [m] sum over the joints
};

namespace hinges {

struct Branch {  // the first links aimed in one of the possible ways
    double cost, miss;
    Rotation frame;
    Vector end;
    double angles[MOST_HINGES];
    int links;
};

inline double aimed(const Pivot& pivot, const Vector& along, const Vector& wanted, double now) {
    double turn;
    return turn_towards(pivot.axis, along, wanted, turn) ? pivot.held(turn, now) : now;
}

// The branch with one more link turned by the angles already written into it.
inline void grow(const Linkage& arm, Branch& branch, const Vector& point, const double* near, double size) {
    const Link& link = arm.link[branch.links];
    double travel = 0.0;
    for (int k = link.first; k < link.first + link.count; ++k) {
        branch.frame = behind(branch.frame, arm.pivot[k], branch.angles[k]);
        travel += std::abs(branch.angles[k] - near[k]);
    }
    branch.end = branch.end + rotated(branch.frame, link.bone);
    const double miss = distance(branch.end, point);
    branch.cost = branch.cost + MISS_COST * miss / size + TRAVEL_COST * travel;
    branch.miss += miss;
    branch.links += 1;
}

// The ways to aim the next bone: its last two hinges aim, any before them stay. One or two children are written.
inline int grown(const Linkage& arm, const Branch& branch, const Vector& point, const double* near, double size,
                 Branch* children) {
    const Link& link = arm.link[branch.links];
    const int end = link.first + link.count;
    Vector wanted = within(branch.frame, unit(point - branch.end));
    children[0] = branch;
    for (int k = link.first; k < end - 2; ++k) {
        children[0].angles[k] = near[k];
        wanted = turned(wanted, arm.pivot[k].axis, -near[k]);
    }
    int count = 1;
    if (link.count == 1) {
        children[0].angles[end - 1] = aimed(arm.pivot[end - 1], link.along, wanted, near[end - 1]);
    } else if (link.count >= 2) {
        const Pivot &first = arm.pivot[end - 2], &last = arm.pivot[end - 1];
        double ways[2] = {near[end - 2], 0.0};
        count = std::max(1, first_of_two(first.axis, last.axis, link.along, wanted, ways));
        if (count == 2) children[1] = children[0];
        for (int way = 0; way < count; ++way) {
            const double turn = first.held(ways[way], near[end - 2]);
            children[way].angles[end - 2] = turn;
            const Vector seen = turned(wanted, first.axis, -turn);
            children[way].angles[end - 1] = aimed(last, link.along, seen, near[end - 1]);
        }
    }
    for (int way = 0; way < count; ++way) grow(arm, children[way], point, near, size);
    return count;
}

// The ways to aim the first bone, the cheaper last: the same for all postures whose first joint's centre is the same.
struct Stem {
    Branch ways[2];
    int count = 0;

    Stem() = default;
    Stem(const Linkage& arm, const Vector& point, const double* near, double size) {
        Branch root;
        root.cost = root.miss = 0.0;
        root.frame = Rotation{};
        root.end = arm.origin;
        root.links = 0;
        std::copy(near, near + arm.own(), root.angles);
        count = grown(arm, root, point, near, size, ways);
        if (count == 2 && ways[0].cost < ways[1].cost) std::swap(ways[0], ways[1]);
    }
};

inline double length_of(const Linkage& arm, int count) {
    double size = 0.0;
    for (int j = 0; j < count; ++j) size += arm.link[j].length;
    return size;
}

}  // namespace hinges

// The angles inside the ranges whose joint centres come nearest to the points: depth-first, cheaper branch first,
// because a shoulder's branch can only be judged by what the elbow makes of it. A posture that misses by more than
// `bound` need not be found: the miss is then told as infinite, or as that of another one beyond the bound.
inline Extraction extract(const Linkage& arm, const hinges::Stem& stem, const Vector* points, int count,
                          const double* near, double bound = INFINITY) {
    const double size = hinges::length_of(arm, count);
    hinges::Branch waiting[MOST_LINKS + 1];  // each level leaves at most one
    int left = stem.count;
    std::copy_n(stem.ways, left, waiting);
    Extraction best;
    double least = INFINITY;
    while (left > 0) {
        const hinges::Branch branch = waiting[--left];
        if (branch.cost >= least || branch.miss > bound + SLACK * size) continue;
        if (branch.links == count) {
            least = branch.cost;
            best.miss = branch.miss;
            std::copy(branch.angles, branch.angles + arm.own(), best.angles);
            continue;
        }
        hinges::Branch* children = waiting + left;
        const int ways = hinges::grown(arm, branch, points[branch.links], near, size, children);
        if (ways == 2 && children[0].cost < children[1].cost) std::swap(children[0], children[1]);
        left += ways;
    }
    return best;
}

inline Extraction extract(const Linkage& arm, const Vector* points, int count, const double* near) {
    if (count == 0) {
        Extraction still;
        std::copy(near, near + arm.own(), still.angles);
        still.miss = 0.0;
        return still;
    }
    return extract(arm, hinges::Stem(arm, points[0], near, hinges::length_of(arm, count)), points, count, near);
}

}  // namespace kinesic::arm
