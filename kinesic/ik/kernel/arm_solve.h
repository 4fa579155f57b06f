// Joint angles for a hand target: reach, springs, hinges, numerical correction, wrist (kinesic/ik/solve.py; thesis 7.3).

#pragma once

#include "arm_place.h"
#include "arm_polish.h"
#include "arm_wrist.h"

namespace kinesic::arm {

constexpr double STALL_DISTANCE = 2e-5;    // [m] distance left to the target above which other start postures are tried
constexpr int MAX_RESTARTS = 8;            // largest number of other start postures
constexpr double REACHED_DISTANCE = 1e-3;  // [m] largest distance at which a target counts as reached

struct Question {
    Vector position;                   // [m] in the base
    const double* swivel = nullptr;    // [rad] or null
    Wish wishes[MAX_DIRECTIONS];          // desired pointing and palm directions
    int wish_count = 0;
    double near[MAX_HINGES];          // [rad] start posture, inside the ranges
    double home[MAX_HINGES];          // [rad] preferred posture, inside the ranges
    double mobility[MAX_HINGES];
};

struct Answer {
    double angles[MAX_HINGES] = {};   // [rad] inside the ranges
    double errors[MAX_DIRECTIONS] = {};   // [rad] direction errors in the order of `wishes`
    double residual = 0.0;             // [m]
    int iterations = 0;
    Vector target;                     // [m] after clamping to the reach
};

// Returns the start postures whose hands are nearest to a target, best first.
inline void nearest(const Linkage& arm, const Vector& target, int count, int* chosen) {
    double near[MAX_SEEDS];
    int kept = 0;
    for (int n = 0; n < arm.seeds; ++n) {
        const double away = distance(arm.seed[n].hand, target);
        if (kept == count && away >= near[kept - 1]) continue;
        int place = kept < count ? kept++ : kept - 1;
        for (; place > 0 && away < near[place - 1]; --place) {
            near[place] = near[place - 1];
            chosen[place] = chosen[place - 1];
        }
        near[place] = away;
        chosen[place] = n;
    }
}

// Corrects the angles numerically, also from other start postures until the hand arrives; returns the best result.
inline CorrectedPosture approach(const Linkage& arm, const Vector& target, const double* angles, const double* posture,
                         const double* mobility) {
    CorrectedPosture best = polish(arm, target, angles, posture, mobility);
    int rounds = best.rounds, chosen[MAX_RESTARTS];
    if (best.miss >= STALL_DISTANCE) nearest(arm, target, MAX_RESTARTS, chosen);
    for (int restart = 0; restart < std::min(MAX_RESTARTS, arm.seeds) && best.miss >= STALL_DISTANCE; ++restart) {
        const CorrectedPosture tried = polish(arm, target, arm.seed[chosen[restart]].angles, posture, mobility);
        rounds += tried.rounds;
        if (tried.miss < best.miss) best = tried;
    }
    best.rounds = rounds;
    return best;
}

// Solves in closed form; if that misses, corrects numerically, also from other postures.
inline Bend found(const Linkage& arm, const Place& place, const Question& question) {
    Bend first = bent(arm, place, question.near, question.swivel);
    if (first.exact) return first;
    const CorrectedPosture best = approach(arm, place.target, first.angles, question.home, question.mobility);
    std::copy(best.angles, best.angles + arm.own(), first.angles);
    first.iterations += best.rounds;
    if (best.miss >= STALL_DISTANCE) return first;
    const Place again = place_of(arm, best.angles, hand(arm, best.angles));
    Bend second = bent(arm, again, best.angles, question.swivel, true);
    if (!second.exact) std::copy(best.angles, best.angles + arm.own(), second.angles);
    second.iterations += first.iterations;
    return second;
}

inline Answer solve(const Linkage& arm, const Question& question) {
    const Place place = placed(arm, question.position, question.near, question.home);
    const Bend bend = found(arm, place, question);
    Vector points[MAX_LINKS + 1];
    const Rotation frame = walk(arm, bend.angles, arm.links - 1, points);
    Answer answer;
    std::copy(bend.angles, bend.angles + arm.own(), answer.angles);
    turn_hand(arm, frame, question.wishes, question.wish_count, question.home, answer.angles, answer.errors);
    answer.residual = distance(points[arm.links - 1], question.position);
    answer.iterations = place.iterations + bend.iterations;
    answer.target = place.target;
    return answer;
}

}  // namespace kinesic::arm
