// A posture that holds the hand in a pose (kinesic/ik/pose.py): the elbow's circle is searched, the rest closed form.

#pragma once

#include "arm_place.h"
#include "arm_six.h"

namespace kinesic::arm {

struct Pose {  // what is asked
    Vector position;  // [m] in the base
    Rotation wanted;
    double near[MOST_HINGES];  // [rad] inside the ranges
};

struct Held {  // what is found
    double angles[MOST_HINGES];
    double residual = INFINITY;  // [m]
    double turn = INFINITY;      // [rad]
    bool reached = false;
    int cells = 0, rounds = 0;
};

namespace poses {

constexpr double NEAR_ENOUGH = 1e-4;  // [m]
constexpr double LIKE_ENOUGH = 1e-3;  // [rad]
constexpr double PERFECT = 1e-6;
constexpr double ALIKE = 0.05;
constexpr int CANDIDATES = 12;
constexpr int SWIVELS = 24;
constexpr int GIRDLE_STEPS = 5;
constexpr double MISS_COST = 10.0;
constexpr int MOST_GIRDLE = 3;                    // hinges of a girdle that is searched
constexpr int WAYS = GIRDLE_STEPS + 1;            // places of each of them, the present one first
constexpr int MOST_WAYS = WAYS * WAYS * WAYS;     // of the whole girdle

// 0, then both sides in turn, once round the circle [rad].
inline double outward(int k) {
    const double step = TAU / SWIVELS;
    return ((k + 1) / 2) * (k % 2 ? step : -step);
}

inline void judge(const Linkage& arm, const Pose& pose, Held& held) {
    Vector points[MOST_LINKS + 1];
    const Rotation frame = walk(arm, held.angles, arm.links, points);
    held.residual = distance(points[arm.links - 1], pose.position);
    held.turn = norm(shortest_turn(frame, pose.wanted));
    held.reached = held.residual <= NEAR_ENOUGH && held.turn <= LIKE_ENOUGH;
}

struct Search {  // the cells: girdle after girdle, the nearest first, and round the elbow's circle with each
    const Linkage& arm;
    const Pose& pose;
    double begin = NATURAL_SWIVEL;
    int girdle, ways = 1, order[MOST_WAYS];
    double cost[MOST_WAYS * SWIVELS];
    int seen = 0;

    Search(const Linkage& arm, const Pose& pose) : arm(arm), pose(pose), girdle(arm.upper().first) {
        Vector points[MOST_LINKS + 1];
        walk(arm, pose.near, arm.links - 1, points);
        swivel_of(arm, points + arm.girdle(), begin);
        for (int k = 0; k < girdle; ++k) ways *= WAYS;
        order[0] = 0;
    }

    // The posture whose girdle goes one of the ways: its digits say where each hinge goes, the first hinge's leads.
    void carry(int way, double* angles) const {
        std::copy_n(pose.near, arm.hinges, angles);
        for (int k = girdle - 1; k >= 0; --k, way /= WAYS) {
            const Pivot& pivot = arm.pivot[k];
            const int step = way % WAYS;
            if (step > 0) angles[k] = pivot.lower + (step - 1) * ((pivot.upper - pivot.lower) / (GIRDLE_STEPS - 1));
        }
    }

    // Sorts the girdle's ways by how far they turn it; the first one, which turns it not at all, stays first.
    void arrange() {
        double away[MOST_WAYS];
        for (int way = 0; way < ways; ++way) {
            double angles[MOST_HINGES], sum = 0.0;
            carry(way, angles);
            for (int k = 0; k < girdle; ++k) sum += (angles[k] - pose.near[k]) * (angles[k] - pose.near[k]);
            away[way] = std::sqrt(sum);
            int place = way;
            for (; place > 0 && away[way] < away[order[place - 1]]; --place) order[place] = order[place - 1];
            order[place] = way;
        }
    }

    // The posture of one swivel with a girdle; what it costs.
    double at(const double* near, const Place& place, const Circle& circle, int swivel, double* angles) const {
        Vector ends[MOST_LINKS + 1], points[MOST_LINKS + 1];
        std::copy(place.ends, place.ends + arm.girdle(), ends);
        ends[arm.girdle()] = circle.at(arm.side, begin + outward(swivel));
        ends[arm.girdle() + 1] = place.target;
        const Extraction found = extract(arm, ends, arm.links - 1, near);
        std::copy_n(found.angles, arm.own(), angles);
        const Rotation frame = walk(arm, angles, arm.links - 1, points);
        const double error = face(arm, frame, pose.wanted, pose.near, angles + arm.own());
        return error + MISS_COST * distance(points[arm.links - 1], place.target) / arm.farthest;
    }

    // A cell by its number.
    void again(int cell, double* angles) const {
        double near[MOST_HINGES];
        carry(order[cell / SWIVELS], near);
        const Place place = place_of(arm, near, pose.position);
        at(near, place, Circle(arm, place.shoulder, place.target), cell % SWIVELS, angles);
    }

    // Looks at cells until one is perfect; the cheapest one's number, and its angles.
    int cheapest(double* best) {
        int least = 0;
        for (int way = 0; way < ways; ++way) {
            if (way == 1) arrange();
            double near[MOST_HINGES], angles[MOST_HINGES];
            carry(order[way], near);
            const Place place = place_of(arm, near, pose.position);
            const Circle circle(arm, place.shoulder, place.target);
            for (int swivel = 0; swivel < SWIVELS; ++swivel) {
                cost[seen] = at(near, place, circle, swivel, angles);
                if (seen == 0 || cost[seen] < cost[least]) {
                    least = seen;
                    std::copy_n(angles, arm.hinges, best);
                }
                if (cost[seen++] < PERFECT) return least;
            }
        }
        return least;
    }
};

inline bool alike(const double* one, const double* other, int count) {
    double sum = 0.0;
    for (int k = 0; k < count; ++k) sum += (one[k] - other[k]) * (one[k] - other[k]);
    return std::sqrt(sum) <= ALIKE;
}

// Descends from a posture; keeps what comes nearer to the pose than the best so far.
inline void improve(const Linkage& arm, const Pose& pose, const double* mobility, const double* from, Held& best) {
    Held found;
    std::copy_n(from, arm.hinges, found.angles);
    best.rounds += six::descend(arm, pose.position, pose.wanted, pose.near, mobility, found.angles);
    judge(arm, pose, found);
    if (found.residual / arm.farthest + found.turn >= best.residual / arm.farthest + best.turn) return;
    std::copy_n(found.angles, arm.hinges, best.angles);
    best.residual = found.residual, best.turn = found.turn, best.reached = found.reached;
}

// Numbers in the order of what they cost, the cheapest first.
inline void rank(const double* cost, int count, int* order) {
    for (int k = 0; k < count; ++k) order[k] = k;
    std::sort(order, order + count, [cost](int a, int b) { return cost[a] < cost[b] || (cost[a] == cost[b] && a < b); });
}

// Descends from the cheapest cells that differ, until one of them holds the pose.
inline void refine(const Search& search, const double* mobility, Held& best) {
    const Linkage& arm = search.arm;
    double kept[CANDIDATES][MOST_HINGES];
    int order[MOST_WAYS * SWIVELS], count = 0;
    rank(search.cost, search.seen, order);
    for (int cell = 0; cell < search.seen && count < CANDIDATES; ++cell) {
        double* angles = kept[count];
        search.again(order[cell], angles);
        if (std::any_of(kept, kept + count, [&](const double* known) { return alike(angles, known, arm.hinges); }))
            continue;
        ++count;
        improve(arm, search.pose, mobility, angles, best);
        if (best.reached) return;
    }
}

// Descends from postures all over the ranges, the nearest to the pose first.
inline void reseed(const Linkage& arm, const Pose& pose, const double* mobility, Held& best) {
    double cost[MOST_SEEDS], postures[MOST_SEEDS][MOST_HINGES];
    int order[MOST_SEEDS];
    for (int n = 0; n < arm.seeds; ++n) {
        double* angles = postures[n];
        Vector points[MOST_LINKS + 1];
        std::copy_n(arm.seed[n].angles, arm.own(), angles);
        const Rotation frame = walk(arm, angles, arm.links - 1, points);
        const double error = face(arm, frame, pose.wanted, pose.near, angles + arm.own());
        cost[n] = error + MISS_COST * distance(points[arm.links - 1], pose.position) / arm.farthest;
    }
    rank(cost, arm.seeds, order);
    for (int n = 0; n < arm.seeds && !best.reached; ++n) improve(arm, pose, mobility, postures[order[n]], best);
}

}  // namespace poses

// Whether an arm's girdle is small enough to be searched here.
inline bool searched(const Linkage& arm) { return arm.upper().first <= poses::MOST_GIRDLE; }

inline Held hold(const Linkage& arm, const Pose& pose, const double* mobility) {
    poses::Search search(arm, pose);
    Held held;
    const int least = search.cheapest(held.angles);
    poses::judge(arm, pose, held);
    if (search.cost[least] >= poses::PERFECT) poses::refine(search, mobility, held);
    if (!held.reached) poses::reseed(arm, pose, mobility, held);
    held.cells = search.seen;
    return held;
}

}  // namespace kinesic::arm
