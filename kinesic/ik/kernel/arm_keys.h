// Arm postures at successive keys (kinesic/ik/keys.py): each is solved from the previous one.

#pragma once

#include "arm_nearest.h"
#include "arm_swing.h"

namespace kinesic::arm {

enum class Mode { rest, still, reach };  // values as in kinesic.ik.keys.Mode

struct ReachLimits {
    double max_swivel_change;  // [rad] largest swivel change that serves palm and pointing directions
    double max_hinge_step;     // [rad] largest hinge rotation between keys; beyond it, the elbow keeps its swivel
    double open_swivel;        // [rad] swivel at openness 1
};

struct Key {
    Question question;     // input of the solver, completed with start and swivel
    bool passing;          // whether the key is on a path
    double openness;
    const double* swivel;  // [rad] or null
};

struct KeySolver {  // state of an arm between its keys
    const Linkage& arm;
    const double *rest, *mobility;
    const ReachLimits limits;

    Answer solved(Question question, const double* start, const double* swivel) const {
        for (int k = 0; k < arm.hinges; ++k) question.near[k] = arm.pivot[k].clipped(start[k]);
        question.swivel = swivel;
        return answer(arm, question, rest, mobility);
    }

    bool swivel(const double* angles, double& turn) const {
        Vector points[MAX_LINKS + 1];
        walk(arm, angles, arm.links - 1, points);
        return swivel_of(arm, points + arm.girdle(), turn);
    }

    static double sum_of_errors(const double* errors, int count) {
        double sum = 0.0;
        for (int i = 0; i < count; ++i) sum += errors[i];
        return sum;
    }

    // Solves a key; changes the swivel if the wrist alone cannot meet the hand's directions.
    Answer solve_with_swivel_change(const Key& key, const double* start) const {
        Answer first = solved(key.question, start, key.swivel);
        const int count = key.question.wish_count;
        if (key.swivel || first.residual > REACHED_DISTANCE) return first;
        if (sum_of_errors(first.errors, count) <= swivel_search::SATISFIED_ERROR) return first;
        Question again = key.question;
        std::copy_n(first.angles, arm.hinges, again.near);
        const SwivelPosture cell = change_swivel(arm, again, limits.max_swivel_change);
        if (sum_of_errors(cell.errors, count) < sum_of_errors(first.errors, count)) {
            std::copy_n(cell.angles, arm.hinges, first.angles);
            std::copy_n(cell.errors, count, first.errors);
            first.residual = cell.miss;
        }
        return first;
    }

    bool exceeds_hinge_step(const double* from, const double* to) const {
        for (int k = 0; k < arm.hinges; ++k)
            if (!(std::abs(to[k] - from[k]) <= limits.max_hinge_step)) return true;
        return false;
    }

    // Changes the swivel for palm and pointing, unless a hinge would exceed the largest step.
    Answer solve_key(const Key& key, const double* start) const {
        const Answer found = solve_with_swivel_change(key, start);
        double kept;
        if (!exceeds_hinge_step(start, found.angles) || !swivel(start, kept)) return found;
        const Answer plain = solved(key.question, start, &kept);
        return plain.residual <= REACHED_DISTANCE && !exceeds_hinge_step(start, plain.angles) ? plain : found;
    }

    // Solves a key from `now`, or on a path from its start posture `began`; returns the requested swivel, or NaN.
    double pose(const Key& key, const double* now, const double* began, double* angles) const {
        if (key.passing) {
            double kept;
            const bool bent = swivel(began, kept);
            std::copy_n(solved(key.question, began, bent ? &kept : nullptr).angles, arm.hinges, angles);
            return bent ? kept : NAN;
        }
        std::copy_n(solve_key(key, now).angles, arm.hinges, angles);
        double present;
        if (key.openness <= 0.0 || !swivel(angles, present) || present >= limits.open_swivel) return NAN;
        const double opened = present + key.openness * (limits.open_swivel - present);
        std::copy_n(solved(key.question, angles, &opened).angles, arm.hinges, angles);
        return opened;
    }
};

}  // namespace kinesic::arm
