// Arm postures at successive keys (kinesic/ik/keys.py): each is solved from the previous one.

#pragma once

#include "arm_nearest.h"
#include "arm_swing.h"

namespace kinesic::arm {

enum class Mode { rest, still, reach };  // values as in kinesic.ik.keys.Mode

struct Manner {
    double widest;  // [rad] largest elbow swing for the hand's directions
    double leap;    // [rad] largest hinge rotation between keys without an elbow swing
    double open;    // [rad] swivel at openness 1
};

struct Key {
    Question question;  // input of the solver, completed with start and swivel
    bool passing;  // whether the key is on a path
    double openness;
    const double* swivel;  // [rad] or null
};

struct Walk {  // state of an arm between its keys
    const Linkage& arm;
    const double *rest, *mobility;
    const Manner manner;

    Answer solved(Question question, const double* start, const double* swivel) const {
        for (int k = 0; k < arm.hinges; ++k) question.near[k] = arm.pivot[k].clipped(start[k]);
        question.swivel = swivel;
        return answer(arm, question, rest, mobility);
    }

    bool swivel(const double* angles, double& turn) const {
        Vector points[MOST_LINKS + 1];
        walk(arm, angles, arm.links - 1, points);
        return swivel_of(arm, points + arm.girdle(), turn);
    }

    static double left(const double* errors, int count) {
        double sum = 0.0;
        for (int i = 0; i < count; ++i) sum += errors[i];
        return sum;
    }

    // Solves a key; swings the elbow if the wrist alone cannot meet the hand's directions.
    Answer swung(const Key& key, const double* start, double widest) const {
        Answer first = solved(key.question, start, key.swivel);
        const int count = key.question.wish_count;
        if (key.swivel || first.residual > REACHED || left(first.errors, count) <= swings::SATISFIED) return first;
        Question again = key.question;
        std::copy_n(first.angles, arm.hinges, again.near);
        const Cell cell = swing(arm, again, widest);
        if (left(cell.errors, count) < left(first.errors, count)) {
            std::copy_n(cell.angles, arm.hinges, first.angles);
            std::copy_n(cell.errors, count, first.errors);
            first.residual = cell.miss;
        }
        return first;
    }

    bool leaps(const double* from, const double* to) const {
        for (int k = 0; k < arm.hinges; ++k)
            if (!(std::abs(to[k] - from[k]) <= manner.leap)) return true;
        return false;
    }

    // Swings the elbow for palm and pointing, unless the arm would turn over for them.
    Answer free(const Key& key, const double* start) const {
        const Answer found = swung(key, start, manner.widest);
        double kept;
        if (!leaps(start, found.angles) || !swivel(start, kept)) return found;
        const Answer plain = solved(key.question, start, &kept);
        return plain.residual <= REACHED && !leaps(start, plain.angles) ? plain : found;
    }

    // Solves a key from `now`, or on a path from the path's start; returns the requested swivel, or NaN.
    double pose(const Key& key, const double* now, const double* began, double* angles) const {
        if (key.passing) {
            double kept;
            const bool bent = swivel(began, kept);
            std::copy_n(solved(key.question, began, bent ? &kept : nullptr).angles, arm.hinges, angles);
            return bent ? kept : NAN;
        }
        std::copy_n(free(key, now).angles, arm.hinges, angles);
        double present;
        if (key.openness <= 0.0 || !swivel(angles, present) || present >= manner.open) return NAN;
        const double opened = present + key.openness * (manner.open - present);
        std::copy_n(solved(key.question, angles, &opened).angles, arm.hinges, angles);
        return opened;
    }
};

}  // namespace kinesic::arm
