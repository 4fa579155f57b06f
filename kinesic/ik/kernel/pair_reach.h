// One posture of torso and arms for both hands (kinesic/ik/two_hands.py): six residuals with common torso hinges.

#pragma once

#include "arm_nearest.h"
#include "box_lm.h"
#include "pair_strand.h"

namespace kinesic::pair {

constexpr int MAX_JOINTS = 128;
constexpr int MAX_TORSO_HINGES = 6;
constexpr double TOLERANCE = 1e-6;  // [arm lengths] error at which an attempt ends
constexpr double TORSO_FRACTIONS[2] = {0.25, 0.75};      // start values over the range of each torso hinge
constexpr double YIELD_WEIGHTS[3] = {0.1, 0.01, 0.001};  // successive weights of the hand without priority
constexpr int NO_PRIORITY = -1;

using Residuals = box::Residuals<MAX_JOINTS>;

struct Limb {  // arm with its position in the robot
    const arm::Linkage* linkage;
    const double *rest, *mobility;
    bool mirrored;
    int joint[arm::MAX_HINGES];  // joint index of each hinge of the arm
    Strand base, hand;            // chains to the segment that carries the arm, and to the wrist
};

struct Body {
    int joints = 0, torso_joints = 0;
    double lower[MAX_JOINTS], upper[MAX_JOINTS];  // [rad]
    int torso[MAX_TORSO_HINGES];
    double length = 0.0;  // [m] of an arm
    Limb limb[2];         // left, right
};

struct TwoHandSolution {  // solution for both hands
    double angles[MAX_JOINTS];
    double residual[2];  // [m]
    double travel = 0.0;  // [rad] of the torso
    int rounds = 0;
};

struct TwoHandTargets {  // targets of both hands, and the present posture
    Vector target[2];             // [m] of each wrist's centre, in the world
    double present[MAX_JOINTS];  // [rad] inside the ranges
    double torso_weight = 0.0;    // mobility of the torso: 0 fixed, 1 like an arm
    int first = NO_PRIORITY;  // hand with priority if not both can be reached
};

// Three residuals per hand, in arm lengths; those of the hand without priority are weighted.
inline void measure(const Body& body, const TwoHandTargets& wanted, double weight, const double* angles, Residuals& residuals) {
    for (int k = 0; k < body.joints; ++k) std::fill_n(residuals.column[k], box::RESIDUAL_COUNT, 0.0);
    for (int side = 0; side < 2; ++side) {
        const Strand& strand = body.limb[side].hand;
        const double scale = (wanted.first == NO_PRIORITY || wanted.first == side ? 1.0 : weight) / body.length;
        Lines lines;
        Rotation frame;
        const Vector hand = walk(strand, angles, lines, frame), off = (wanted.target[side] - hand) * scale;
        double* row = residuals.row + 3 * side;
        row[0] = off.x, row[1] = off.y, row[2] = off.z;
        for (int k = 0; k < strand.hinges; ++k) {
            const Vector moved = cross(lines.axis[k], hand - lines.pole[k]) * scale;
            double* column = residuals.column[strand.hinge[k].joint] + 3 * side;
            column[0] = moved.x, column[1] = moved.y, column[2] = moved.z;
        }
    }
}

// Brings each arm as near to its target as possible with a fixed torso; changes the angles.
inline void reach_with_fixed_torso(const Body& body, const TwoHandTargets& wanted, double* angles) {
    double posture[MAX_JOINTS];
    std::copy_n(angles, body.joints, posture);
    for (int side = 0; side < 2; ++side) {
        const Limb& limb = body.limb[side];
        Lines lines;
        Rotation frame;
        const Vector base = walk(limb.base, posture, lines, frame);
        const Vector target = within(frame, wanted.target[side] - base);
        arm::Question question;
        question.position = {target.x, limb.mirrored ? 0.0 - target.y : target.y, target.z};
        for (int k = 0; k < limb.linkage->hinges; ++k)
            question.near[k] = limb.linkage->pivot[k].clipped(posture[limb.joint[k]]);
        std::copy_n(limb.rest, limb.linkage->hinges, question.home);
        std::copy_n(limb.mobility, limb.linkage->hinges, question.mobility);
        const arm::Answer found = answer(*limb.linkage, question, limb.rest, limb.mobility);
        for (int k = 0; k < limb.linkage->own(); ++k) angles[limb.joint[k]] = found.angles[k];
    }
}

// Writes the n-th start posture: the present one, then all combinations of TORSO_FRACTIONS, the last hinge varying
// fastest.
inline void write_start_posture(const Body& body, const TwoHandTargets& wanted, int n, double* angles) {
    std::copy_n(wanted.present, body.joints, angles);
    if (n == 0) return;
    for (int k = body.torso_joints - 1, left = n - 1; k >= 0; --k, left /= 2) {
        const int joint = body.torso[k];
        angles[joint] = body.lower[joint] + (body.upper[joint] - body.lower[joint]) * TORSO_FRACTIONS[left % 2];
    }
}

// Writes the mobility of each hinge of torso and arms; hinges that only turn the hand are fixed.
inline void fill_mobilities(const Body& body, double torso_weight, double* mobility) {
    std::fill_n(mobility, body.joints, 0.0);
    for (int k = 0; k < body.torso_joints; ++k) mobility[body.torso[k]] = torso_weight;
    for (const Limb& limb : body.limb)
        for (int k = 0; k < limb.linkage->own(); ++k) mobility[limb.joint[k]] = limb.mobility[k];
}

// Returns the first posture that reaches both hands; otherwise the best, in which the hand without priority yields.
inline TwoHandSolution reach(const Body& body, const TwoHandTargets& wanted) {
    double mobility[MAX_JOINTS];
    fill_mobilities(body, wanted.torso_weight, mobility);
    const box::Box ranges{body.joints, body.lower, body.upper, wanted.present, mobility};
    const auto descend = [&](double weight, double* angles) {
        const auto residuals = [&](const double* now, Residuals& into) { measure(body, wanted, weight, now, into); };
        return box::descend<MAX_JOINTS>(ranges, residuals, TOLERANCE, angles);
    };
    const int start_count = body.torso_joints > 0 && wanted.torso_weight > 0.0 ? 1 + (1 << body.torso_joints) : 1;
    TwoHandSolution both;
    double least = INFINITY;
    for (int n = 0; n < start_count && least > TOLERANCE; ++n) {
        double angles[MAX_JOINTS];
        write_start_posture(body, wanted, n, angles);
        reach_with_fixed_torso(body, wanted, angles);
        const box::Descent descent = descend(1.0, angles);
        both.rounds += descent.rounds;
        if (descent.miss >= least) continue;
        least = descent.miss;
        std::copy_n(angles, body.joints, both.angles);
    }
    if (wanted.first != NO_PRIORITY && least > TOLERANCE)
        for (const double weight : YIELD_WEIGHTS) both.rounds += descend(weight, both.angles).rounds;
    for (int side = 0; side < 2; ++side) {
        Lines lines;
        Rotation frame;
        both.residual[side] = distance(walk(body.limb[side].hand, both.angles, lines, frame), wanted.target[side]);
    }
    for (int k = 0; k < body.torso_joints; ++k)
        both.travel += std::abs(both.angles[body.torso[k]] - wanted.present[body.torso[k]]);
    return both;
}

}  // namespace kinesic::pair
