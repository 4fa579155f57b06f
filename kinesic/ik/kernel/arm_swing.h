// Smallest swivel change that meets the hand's directions (kinesic/ik/pointing.py).

#pragma once

#include "arm_solve.h"

namespace kinesic::arm {

struct SwivelPosture {  // posture of one swivel, inside the ranges
    double angles[MAX_HINGES];
    double errors[MAX_DIRECTIONS];  // [rad] direction errors
    double error = 0.0;          // [rad] sum of the direction errors
    double miss = 0.0;           // [m] of the hand
};

namespace swivel_search {

constexpr double SATISFIED_ERROR = 1e-3;  // [rad] sum of direction errors below which the directions are met
constexpr int SEARCH_STEPS = 12;          // swivels tried on each side
constexpr double SWIVEL_WEIGHT = 0.03;    // pointing error [rad] traded per radian of swivel change
constexpr int BISECTION_STEPS = 8;
constexpr double MAX_HAND_OFFSET = 1e-6;  // [reach] largest displacement of the hand

struct Sweep {  // postures with the elbow at successive swivels and the wrist turned
    places::Scan scan;
    const Question& question;

    SwivelPosture at(double offset) {
        const Linkage& arm = scan.arm;
        const Extraction found = scan.at(offset);
        SwivelPosture cell;
        std::copy_n(found.angles, arm.own(), cell.angles);
        Vector points[MAX_LINKS + 1];
        const Rotation frame = walk(arm, cell.angles, arm.links - 1, points);
        turn_hand(arm, frame, question.wishes, question.wish_count, question.home, cell.angles, cell.errors);
        for (int i = 0; i < question.wish_count; ++i) cell.error += cell.errors[i];
        cell.miss = distance(points[arm.links - 1], question.position);
        return cell;
    }

    bool serves(const SwivelPosture& cell) const { return cell.miss <= scan.tolerance && cell.error <= SATISFIED_ERROR; }

    // Bisects to the smallest swivel change that meets the directions.
    SwivelPosture edge(double outside, double inside, SwivelPosture found) {
        for (int step = 0; step < BISECTION_STEPS; ++step) {
            const double middle = 0.5 * (outside + inside);
            const SwivelPosture cell = at(middle);
            if (serves(cell)) {
                inside = middle;
                found = cell;
            } else {
                outside = middle;
            }
        }
        return found;
    }

    // Returns the smallest swivel change that meets the directions; otherwise the best by error and swivel change.
    SwivelPosture smallest(double max_swivel_change) {
        SwivelPosture best = at(0.0);
        double least = INFINITY;
        for (int step = 0; step <= SEARCH_STEPS; ++step)
            for (const double side : {1.0, -1.0}) {
                const double outside = side * (step - 1) * max_swivel_change / SEARCH_STEPS;
                const double offset = side * step * max_swivel_change / SEARCH_STEPS;
                const SwivelPosture cell = at(offset);
                if (serves(cell)) return edge(outside, offset, cell);
                const double price = cell.error + SWIVEL_WEIGHT * std::abs(offset);
                if (cell.miss <= scan.tolerance && price < least) {
                    best = cell;
                    least = price;
                }
            }
        return best;
    }
};

}  // namespace swivel_search

// Changes the swivel; collar bone and hand keep their positions of `question.near`.
inline SwivelPosture change_swivel(const Linkage& arm, const Question& question, double max_swivel_change) {
    const Place place = place_of(arm, question.near, question.position);
    Vector points[MAX_LINKS + 1];
    walk(arm, question.near, arm.links - 1, points);
    double begin = NATURAL_SWIVEL;
    swivel_of(arm, points + arm.girdle(), begin);
    swivel_search::Sweep sweep{{arm, Circle(arm, place.shoulder, place.target), question.near, {}, begin,
                         swivel_search::MAX_HAND_OFFSET * arm.farthest}, question};
    std::copy(place.ends, place.ends + arm.girdle(), sweep.scan.ends);
    sweep.scan.ends[arm.girdle() + 1] = place.target;
    return sweep.smallest(max_swivel_change);
}

}  // namespace kinesic::arm
