// Posture for a full hand pose (kinesic/ik/pose.py): search over the elbow's circle, the rest in closed form.

#pragma once

#include "arm_place.h"
#include "arm_six.h"

namespace kinesic::arm {

struct Pose {  // requested pose
    Vector position;  // [m] in the base
    Rotation wanted;
    double near[MAX_HINGES];  // [rad] inside the ranges
};

struct PoseSolution {  // solution of a pose
    double angles[MAX_HINGES];
    double residual = INFINITY;  // [m]
    double turn = INFINITY;      // [rad]
    bool reached = false;
    int cells = 0, rounds = 0;
};

namespace poses {

constexpr double POSITION_TOLERANCE = 1e-4;  // [m] largest position error of a solved pose
constexpr double ROTATION_TOLERANCE = 1e-3;  // [rad] largest rotation error of a solved pose
constexpr double PERFECT_COST = 1e-6;           // cost of a cell at which the search ends
constexpr double SAME_POSTURE_DISTANCE = 0.05;  // [rad] distance below which postures count as equal
constexpr int MAX_CANDIDATES = 12;              // largest number of refined cells
constexpr int SWIVEL_STEPS = 24;                // swivels on the elbow's circle
constexpr int GIRDLE_STEPS = 5;                 // values over the range of each collar-bone hinge
constexpr double MISS_COST = 10.0;              // [rad / arm length] cost of the hand's distance from its target
constexpr int MAX_GIRDLE_HINGES = 3;                 // largest number of collar-bone hinges in the search
constexpr int VALUES_PER_HINGE = GIRDLE_STEPS + 1;   // the present value is the first
constexpr int MAX_GIRDLE_POSTURES = VALUES_PER_HINGE * VALUES_PER_HINGE * VALUES_PER_HINGE;

// Swivel offsets around the circle [rad]: 0, then alternating sides.
inline double outward(int k) {
    const double step = TAU / SWIVEL_STEPS;
    return ((k + 1) / 2) * (k % 2 ? step : -step);
}

inline void judge(const Linkage& arm, const Pose& pose, PoseSolution& held) {
    Vector points[MAX_LINKS + 1];
    const Rotation frame = walk(arm, held.angles, arm.links, points);
    held.residual = distance(points[arm.links - 1], pose.position);
    held.turn = norm(shortest_turn(frame, pose.wanted));
    held.reached = held.residual <= POSITION_TOLERANCE && held.turn <= ROTATION_TOLERANCE;
}

// Search over cells: collar-bone postures in the order of their distance, each with a full circle of elbow positions.
struct Search {
    const Linkage& arm;
    const Pose& pose;
    double begin = NATURAL_SWIVEL;
    int girdle, ways = 1, order[MAX_GIRDLE_POSTURES];
    double cost[MAX_GIRDLE_POSTURES * SWIVEL_STEPS];
    int seen = 0;

    Search(const Linkage& arm, const Pose& pose) : arm(arm), pose(pose), girdle(arm.upper().first) {
        Vector points[MAX_LINKS + 1];
        walk(arm, pose.near, arm.links - 1, points);
        swivel_of(arm, points + arm.girdle(), begin);
        for (int k = 0; k < girdle; ++k) ways *= VALUES_PER_HINGE;
        order[0] = 0;
    }

    // Collar-bone posture of a combination. Each digit selects the value of a hinge; the first hinge has the highest digit.
    void carry(int way, double* angles) const {
        std::copy_n(pose.near, arm.hinges, angles);
        for (int k = girdle - 1; k >= 0; --k, way /= VALUES_PER_HINGE) {
            const Pivot& pivot = arm.pivot[k];
            const int step = way % VALUES_PER_HINGE;
            if (step > 0) angles[k] = pivot.lower + (step - 1) * ((pivot.upper - pivot.lower) / (GIRDLE_STEPS - 1));
        }
    }

    // Sorts the collar-bone combinations by rotation; the first one, without rotation, stays first.
    void arrange() {
        double away[MAX_GIRDLE_POSTURES];
        for (int way = 0; way < ways; ++way) {
            double angles[MAX_HINGES], sum = 0.0;
            carry(way, angles);
            for (int k = 0; k < girdle; ++k) sum += (angles[k] - pose.near[k]) * (angles[k] - pose.near[k]);
            away[way] = std::sqrt(sum);
            int place = way;
            for (; place > 0 && away[way] < away[order[place - 1]]; --place) order[place] = order[place - 1];
            order[place] = way;
        }
    }

    // Computes the posture of one swivel with a collar-bone posture, and its cost.
    double at(const double* near, const Place& place, const Circle& circle, int swivel, double* angles) const {
        Vector ends[MAX_LINKS + 1], points[MAX_LINKS + 1];
        std::copy(place.ends, place.ends + arm.girdle(), ends);
        ends[arm.girdle()] = circle.at(arm.side, begin + outward(swivel));
        ends[arm.girdle() + 1] = place.target;
        const Extraction found = extract(arm, ends, arm.links - 1, near);
        std::copy_n(found.angles, arm.own(), angles);
        const Rotation frame = walk(arm, angles, arm.links - 1, points);
        const double error = face(arm, frame, pose.wanted, pose.near, angles + arm.own());
        return error + MISS_COST * distance(points[arm.links - 1], place.target) / arm.farthest;
    }

    // Computes a cell by its number.
    void again(int cell, double* angles) const {
        double near[MAX_HINGES];
        carry(order[cell / SWIVEL_STEPS], near);
        const Place place = place_of(arm, near, pose.position);
        at(near, place, Circle(arm, place.shoulder, place.target), cell % SWIVEL_STEPS, angles);
    }

    // Evaluates cells until the cost of one is below PERFECT_COST; returns number and angles of the cheapest.
    int cheapest(double* best) {
        int least = 0;
        for (int way = 0; way < ways; ++way) {
            if (way == 1) arrange();
            double near[MAX_HINGES], angles[MAX_HINGES];
            carry(order[way], near);
            const Place place = place_of(arm, near, pose.position);
            const Circle circle(arm, place.shoulder, place.target);
            for (int swivel = 0; swivel < SWIVEL_STEPS; ++swivel) {
                cost[seen] = at(near, place, circle, swivel, angles);
                if (seen == 0 || cost[seen] < cost[least]) {
                    least = seen;
                    std::copy_n(angles, arm.hinges, best);
                }
                if (cost[seen++] < PERFECT_COST) return least;
            }
        }
        return least;
    }
};

inline bool alike(const double* one, const double* other, int count) {
    double sum = 0.0;
    for (int k = 0; k < count; ++k) sum += (one[k] - other[k]) * (one[k] - other[k]);
    return std::sqrt(sum) <= SAME_POSTURE_DISTANCE;
}

// Descends from a posture, and keeps the result if it is better than the best.
inline void improve(const Linkage& arm, const Pose& pose, const double* mobility, const double* from, PoseSolution& best) {
    PoseSolution found;
    std::copy_n(from, arm.hinges, found.angles);
    best.rounds += six::descend(arm, pose.position, pose.wanted, pose.near, mobility, found.angles);
    judge(arm, pose, found);
    if (found.residual / arm.farthest + found.turn >= best.residual / arm.farthest + best.turn) return;
    std::copy_n(found.angles, arm.hinges, best.angles);
    best.residual = found.residual, best.turn = found.turn, best.reached = found.reached;
}

// Returns indices sorted by cost, the cheapest first.
inline void rank(const double* cost, int count, int* order) {
    for (int k = 0; k < count; ++k) order[k] = k;
    std::sort(order, order + count, [cost](int a, int b) { return cost[a] < cost[b] || (cost[a] == cost[b] && a < b); });
}

// Descends from the cheapest distinct cells until one solves the pose.
inline void refine(const Search& search, const double* mobility, PoseSolution& best) {
    const Linkage& arm = search.arm;
    double kept[MAX_CANDIDATES][MAX_HINGES];
    int order[MAX_GIRDLE_POSTURES * SWIVEL_STEPS], count = 0;
    rank(search.cost, search.seen, order);
    for (int cell = 0; cell < search.seen && count < MAX_CANDIDATES; ++cell) {
        double* angles = kept[count];
        search.again(order[cell], angles);
        if (std::any_of(kept, kept + count, [&](const double* known) { return alike(angles, known, arm.hinges); }))
            continue;
        ++count;
        improve(arm, search.pose, mobility, angles, best);
        if (best.reached) return;
    }
}

// Descends from the start postures, which cover the ranges, in the order of their distance from the pose.
inline void reseed(const Linkage& arm, const Pose& pose, const double* mobility, PoseSolution& best) {
    double cost[MAX_SEEDS], postures[MAX_SEEDS][MAX_HINGES];
    int order[MAX_SEEDS];
    for (int n = 0; n < arm.seeds; ++n) {
        double* angles = postures[n];
        Vector points[MAX_LINKS + 1];
        std::copy_n(arm.seed[n].angles, arm.own(), angles);
        const Rotation frame = walk(arm, angles, arm.links - 1, points);
        const double error = face(arm, frame, pose.wanted, pose.near, angles + arm.own());
        cost[n] = error + MISS_COST * distance(points[arm.links - 1], pose.position) / arm.farthest;
    }
    rank(cost, arm.seeds, order);
    for (int n = 0; n < arm.seeds && !best.reached; ++n) improve(arm, pose, mobility, postures[order[n]], best);
}

}  // namespace poses

// Whether an arm has few enough collar-bone hinges for this search.
inline bool searched(const Linkage& arm) { return arm.upper().first <= poses::MAX_GIRDLE_HINGES; }

inline PoseSolution hold(const Linkage& arm, const Pose& pose, const double* mobility) {
    poses::Search search(arm, pose);
    PoseSolution held;
    const int least = search.cheapest(held.angles);
    poses::judge(arm, pose, held);
    if (search.cost[least] >= poses::PERFECT_COST) poses::refine(search, mobility, held);
    if (!held.reached) poses::reseed(arm, pose, mobility, held);
    held.cells = search.seen;
    return held;
}

}  // namespace kinesic::arm
