// Hinge angles from joint positions in closed form, over all branches (tests/reference/ik/hinges.py).

#pragma once

#include <algorithm>

#include "arm_lanes.h"

namespace kinesic::arm {

constexpr double AXIS_TOLERANCE = 1e-9;  // distance to the axis below which a direction defines no angle
constexpr double MISS_COST = 1e3;     // cost per arm length of a joint's distance from its point
constexpr double TRAVEL_COST = 1e-3;  // cost per radian of travel from the current angles
constexpr double MISS_SLACK = 1e-4;      // [chain lengths] miss that costs as much as a travel of 100 rad

// Subproblem 1: th = atan2(a.(r x v), r.v - (a.r)(a.v)); not `defined` for a direction along the axis.
inline Lanes turn_towards(const Vector& axis, const Vector& rest, const Vectors& wanted, Mask& defined) {
    const Vectors a = all(axis), r = all(rest);
    const Lanes s = dot(a, cross(r, wanted));
    const Lanes c = dot(r, wanted) - dot(axis, rest) * dot(a, wanted);
    defined = ~(root(s * s + c * c) < AXIS_TOLERANCE);
    return arctangent(s, c);
}

// Solves subproblem 1; false if it is not defined.
inline bool turn_towards(const Vector& axis, const Vector& rest, const Vector& wanted, double& turn) {
    Mask defined;
    turn = turn_towards(axis, rest, all(wanted), defined)[0];
    return defined[0];
}

// Solves subproblem 2 for its first hinge: A cos q1 + B sin q1 = C. Returns the number of branches, at most two.
inline int first_of_two(const Vector& first, const Vector& second, const Vector& rest, const Vector& wanted,
                        double* turns) {
    const double along = dot(first, wanted), skew = dot(second, first);
    const double a = dot(second, wanted) - skew * along;
    const double b = -dot(second, cross(first, wanted));
    const double c = dot(second, rest) - skew * along;
    const double rho = std::sqrt(a * a + b * b);
    if (rho < AXIS_TOLERANCE) return 0;
    if (std::abs(c) >= rho) {
        const double middle = arctangent(b, a);
        turns[0] = c > 0.0 ? middle : middle + PI;
        return 1;
    }
    const double ratio = c / rho;
    const Lanes angles = arctangent(Lanes{b, std::sqrt(1.0 - ratio)}, Lanes{a, std::sqrt(1.0 + ratio)});
    const double middle = angles[0], spread = 2.0 * angles[1];
    turns[0] = middle + spread;
    turns[1] = middle - spread;
    return 2;
}

struct Extraction {
    double angles[MAX_HINGES] = {};  // [rad] angles of the hinges that aim the bones
    double miss = INFINITY;      // [m] sum of the joints' distances from their points
};

namespace hinges {

struct Branch {  // solution of the first links on one branch
    double cost, miss;
    Rotation frame;
    Vector end;
    double angles[MAX_HINGES];
    int links;
};

struct LinkSolutions {  // solutions of one link's hinges, in array form
    Lanes angle[MAX_HINGES];
    Turns turns[MAX_HINGES];
    int count = 1;
};

// Returns the distances of points [m] from an arc about an axis.
inline Lanes off_arc(const Arc& arc, const Vector& axis, const Vectors& point) {
    const Lanes along = dot(all(axis), point);
    const Mask beside = dot(all(arc.middle), point) >= arc.opening * norm(point - all(axis) * along);
    const Lanes lower = norm(point - all(arc.lower)), upper = norm(point - all(arc.upper));
    return either(beside, magnitude(along - arc.height), either(lower < upper, lower, upper));
}

// Returns the solutions for the next bone: its last two hinges aim it, the others keep their angles. None if every miss
// exceeds `most`.
inline LinkSolutions aimed(const Linkage& arm, const Branch& branch, const Vector& point, const double* near, double most) {
    const Link& link = arm.link[branch.links];
    const int end = link.first + link.count;
    const Vector away = point - branch.end;
    LinkSolutions ways;
    Vectors wanted = all(within(branch.frame, unit(away)));
    int k = link.first;
    const auto turn = [&](Lanes angle) {
        ways.angle[k] = angle;
        ways.turns[k] = turns_of(angle);
        if (k < end - 1) wanted = turned(wanted, arm.pivot[k].axis, ways.turns[k].cosine, -ways.turns[k].sine);
        ++k;
    };
    while (k < end - 2) turn(all(near[k]));
    if (link.count >= 2) {
        const Pivot &first = arm.pivot[k], &last = arm.pivot[k + 1];
        double turns[2] = {near[k], near[k]};
        ways.count = std::max(1, first_of_two(first.axis, last.axis, link.along, lane(wanted, 0), turns));
        const double held = first.held(turns[0], near[k]);
        turn(Lanes{held, ways.count == 2 ? first.held(turns[1], near[k]) : held});
    }
    if (link.count >= 1) {
        const Pivot& last = arm.pivot[k];
        if (most < INFINITY && !any(off_arc(arm.arc[branch.links], last.axis, wanted * all(norm(away))) <= most)) {
            ways.count = 0;
            return ways;
        }
        Mask defined;
        Lanes angle = turn_towards(last.axis, link.along, wanted, defined);
        for (int way = 0; way < LANES; ++way) angle[way] = defined[way] ? last.held(angle[way], near[k]) : near[k];
        turn(angle);
    }
    return ways;
}

// Extends a branch by all solutions of the next link. Writes at most two children, and none if every miss exceeds `most`.
inline int grown(const Linkage& arm, const Branch& branch, const Vector& point, const double* near, double size,
                 Branch* children, double most = INFINITY) {
    const Link& link = arm.link[branch.links];
    const LinkSolutions ways = aimed(arm, branch, point, near, most);
    if (ways.count == 0) return 0;
    Rotations frame = all(branch.frame);
    Lanes travel = all(0.0);
    for (int k = link.first; k < link.first + link.count; ++k) {
        frame = behind(frame, arm.pivot[k], ways.turns[k]);
        travel += magnitude(ways.angle[k] - near[k]);
    }
    const Vectors end = all(branch.end) + rotated(frame, link.bone);
    const Lanes miss = norm(end - all(point));
    const Lanes cost = branch.cost + MISS_COST * miss / size + TRAVEL_COST * travel;
    for (int way = 0; way < ways.count; ++way) {
        Branch& child = children[way];
        child.cost = cost[way];
        child.miss = branch.miss + miss[way];
        child.frame = lane(frame, way);
        child.end = lane(end, way);
        std::copy(branch.angles, branch.angles + arm.own(), child.angles);
        for (int k = link.first; k < link.first + link.count; ++k) child.angles[k] = ways.angle[k][way];
        child.links = branch.links + 1;
    }
    return ways.count;
}

// Solutions for the first bone, the cheaper one last. All postures with the same first joint centre share them.
struct FirstLinkSolutions {
    Branch ways[2];
    int count = 0;

    FirstLinkSolutions() = default;
    FirstLinkSolutions(const Linkage& arm, const Vector& point, const double* near, double size) {
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

// Finds the angles in range whose joint centres are nearest to the points. Depth-first, cheaper branch first, because the
// cost of a shoulder branch depends on its elbow. Postures with a miss above `bound` may be skipped: the returned miss is
// then infinite, or that of another posture above the bound.
inline Extraction extract(const Linkage& arm, const hinges::FirstLinkSolutions& stem, const Vector* points, int count,
                          const double* near, double bound = INFINITY) {
    const double size = hinges::length_of(arm, count);
    hinges::Branch waiting[MAX_LINKS + 1];  // each level leaves at most one waiting branch
    int left = stem.count;
    std::copy_n(stem.ways, left, waiting);
    Extraction best;
    double least = INFINITY;
    while (left > 0) {
        const hinges::Branch branch = waiting[--left];
        const double most = bound + MISS_SLACK * size - branch.miss;
        if (branch.cost >= least || most < 0.0) continue;
        if (branch.links == count) {
            least = branch.cost;
            best.miss = branch.miss;
            std::copy(branch.angles, branch.angles + arm.own(), best.angles);
            continue;
        }
        hinges::Branch* children = waiting + left;
        const int ways = hinges::grown(arm, branch, points[branch.links], near, size, children, most);
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
    return extract(arm, hinges::FirstLinkSolutions(arm, points[0], near, hinges::length_of(arm, count)), points, count, near);
}

}  // namespace kinesic::arm
