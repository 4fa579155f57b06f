// Elbow swing needed for the hand's directions (kinesic/ik/pointing.py).

#pragma once

#include "arm_solve.h"

namespace kinesic::arm {

struct Cell {  // posture of one swivel, inside the ranges
    double angles[MOST_HINGES];
    double errors[MOST_WISHES];  // [rad] direction errors
    double error = 0.0;          // [rad] sum of the direction errors
    double miss = 0.0;           // [m] of the hand
};

namespace swings {

constexpr double SATISFIED = 1e-3;
constexpr int STEPS = 12;
constexpr double PRICE = 0.03;
constexpr int BISECTIONS = 8;
constexpr double OFF = 1e-6;

struct Sweep {  // postures with the elbow at successive swivels and the wrist turned
    places::Scan scan;
    const Question& question;

    Cell at(double offset) {
        const Linkage& arm = scan.arm;
        const Extraction found = scan.at(offset);
        Cell cell;
        std::copy_n(found.angles, arm.own(), cell.angles);
        Vector points[MOST_LINKS + 1];
        const Rotation frame = walk(arm, cell.angles, arm.links - 1, points);
        turn_hand(arm, frame, question.wishes, question.wish_count, question.home, cell.angles, cell.errors);
        for (int i = 0; i < question.wish_count; ++i) cell.error += cell.errors[i];
        cell.miss = distance(points[arm.links - 1], question.position);
        return cell;
    }

    bool serves(const Cell& cell) const { return cell.miss <= scan.tolerance && cell.error <= SATISFIED; }

    // Bisects to the swivel at which the directions begin to be met.
    Cell edge(double outside, double inside, Cell found) {
        for (int step = 0; step < BISECTIONS; ++step) {
            const double middle = 0.5 * (outside + inside);
            const Cell cell = at(middle);
            if (serves(cell)) {
                inside = middle;
                found = cell;
            } else {
                outside = middle;
            }
        }
        return found;
    }

    // Returns the smallest swing that meets the directions, searched outward; otherwise the best by error and width.
    Cell smallest(double widest) {
        Cell best = at(0.0);
        double least = INFINITY;
        for (int step = 0; step <= STEPS; ++step)
            for (const double side : {1.0, -1.0}) {
                const double outside = side * (step - 1) * widest / STEPS, offset = side * step * widest / STEPS;
                const Cell cell = at(offset);
                if (serves(cell)) return edge(outside, offset, cell);
                const double price = cell.error + PRICE * std::abs(offset);
                if (cell.miss <= scan.tolerance && price < least) {
                    best = cell;
                    least = price;
                }
            }
        return best;
    }
};

}  // namespace swings

// Swings the elbow; collar bone and hand keep their positions of `question.near`.
inline Cell swing(const Linkage& arm, const Question& question, double widest) {
    const Place place = place_of(arm, question.near, question.position);
    Vector points[MOST_LINKS + 1];
    walk(arm, question.near, arm.links - 1, points);
    double begin = NATURAL_SWIVEL;
    swivel_of(arm, points + arm.girdle(), begin);
    swings::Sweep sweep{{arm, Circle(arm, place.shoulder, place.target), question.near, {}, begin,
                         swings::OFF * arm.farthest}, question};
    std::copy(place.ends, place.ends + arm.girdle(), sweep.scan.ends);
    sweep.scan.ends[arm.girdle() + 1] = place.target;
    return sweep.smallest(widest);
}

}  // namespace kinesic::arm
