// Heuristic methods, which move one joint or one point at a time without any matrix.

#pragma once

#include "chain_state.h"

namespace kinesic::chains {

// Cyclic coordinate descent (L.-C. Wang, C. C. Chen 1991; C. Welman 1993):
//   from the last joint to the first: rotate the joint so that the tip points at the target.
// Joints nearer to the base keep their positions during the sweep, so that only the tip's position has to be updated.
inline int ccd(const Chain& chain, const Goal& goal, Posture& posture) {
    Quaternion turns[MAX_BONES];
    int k = 0;
    while (residual(chain, goal, posture) > goal.tolerance && k < goal.max_iterations) {
        Vector tip = posture.points[chain.bones];
        for (int i = chain.bones - 1; i >= 0; --i) {
            const Vector from = tip - posture.points[i];
            const Vector to = goal.target - posture.points[i];
            const double reach = norm(from), far = norm(to);
            const bool aimable = reach > 1e-12 && far > 1e-12;
            turns[i] = aimable ? arc(from * (1.0 / reach), to * (1.0 / far)) : NO_ROTATION;
            if (aimable) tip = posture.points[i] + to * (reach / far);
        }
        turn_joints(chain, turns, posture);
        ++k;
    }
    return k;
}

// Moves a point along the line to another point, until their distance is `length`.
inline Vector pulled(const Vector& point, const Vector& to, double length) {
    const Vector between = point - to;
    const double now = norm(between);
    return to + (now > 0.0 ? between * (length / now) : Vector{0.0, 0.0, length});
}

// FABRIK (A. Aristidou, J. Lasenby 2011): the chain points straight at a target out of reach; otherwise repeat
//   move the tip to the target, then each point to its bone's length from the next one, down to the base;
//   move the base back, then each point to its bone's length from the previous one, up to the tip.
inline int fabrik(const Chain& chain, const Goal& goal, Posture& posture) {
    const int n = chain.bones;
    Vector* points = posture.points;
    int k = 0;
    if (norm(goal.target) >= 1.0 - 1e-12) {
        for (int i = 0; i < n; ++i) points[i + 1] = points[i] + unit(goal.target) * chain.lengths[i];
        k = 1;
    }
    while (distance(points[n], goal.target) > goal.tolerance && k < goal.max_iterations) {
        points[n] = goal.target;
        for (int i = n - 1; i > 0; --i) points[i] = pulled(points[i], points[i + 1], chain.lengths[i]);
        for (int i = 0; i < n; ++i) points[i + 1] = pulled(points[i + 1], points[i], chain.lengths[i]);
        ++k;
    }
    aim(chain, posture);
    return k;
}

// Triangulation (R. Mueller-Cajar, R. Mukundan 2007): from the first joint to the last, with a = this bone, b = the sum
// of all later bones, c = the distance to the target, rotate the bone in the plane of a and c so that
//   cos(angle between a and c) = (a^2 + c^2 - b^2) / (2 a c),
// clamped to +-1 if there is no such triangle. One pass is exact.
inline int triangulation(const Chain& chain, const Goal& goal, Posture& posture) {
    if (residual(chain, goal, posture) <= goal.tolerance || goal.max_iterations == 0) return 0;
    Quaternion parent = NO_ROTATION;
    double b = 1.0;
    for (int i = 0; i < chain.bones; ++i) {
        const double a = chain.lengths[i];
        b -= a;
        const Vector carried = rotated(parent, chain.along[i]);
        const Vector way = goal.target - posture.points[i];
        const double c = norm(way);
        if (c > 1e-12) {
            const Vector ahead = way * (1.0 / c);
            const Vector off = across(carried, ahead);
            const Vector bend = norm(off) > 1e-9 ? unit(off) : aside(ahead);
            const double cosine = std::fmax(-1.0, std::fmin(1.0, (a * a + c * c - b * b) / (2.0 * a * c)));
            const Vector wanted = unit(ahead * cosine + bend * std::sqrt(1.0 - cosine * cosine));
            parent = normalised(arc(carried, wanted) * parent);
        }
        posture.frames[i] = parent;
        posture.points[i + 1] = posture.points[i] + rotated(parent, chain.along[i]) * a;
    }
    return 1;
}

}  // namespace kinesic::chains
