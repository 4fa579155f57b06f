// Positions of shoulder and elbow for a target (tests/reference/ik/shoulder_elbow.py, swivel.py).

#pragma once

#include "arm_hinges.h"
#include "arm_masses.h"

namespace kinesic::arm {

constexpr double STRETCH = 0.9999;
constexpr double TAUT = 0.97;
constexpr double EXACT = 1e-6;
constexpr double NATURAL_SWIVEL = 0.35;
constexpr double NATURE = 0.5;
constexpr double SLIM = 1e-3;
constexpr double TIED = 1e-9;
constexpr int STEPS = 12;
constexpr int BISECTIONS = 6;
constexpr double BACKWARD = -1.0 + 1e-9;

struct Place {  // shoulder position for a target, and the target within reach
    Vector ends[MOST_LINKS];  // [m] ends of the collar bones; elbow and target follow once the arm is bent
    Vector shoulder, target;  // [m]
    int iterations = 0;
};

struct Bend {
    double angles[MOST_HINGES];  // [rad] of the hinges before the hand
    bool exact = false;
    int iterations = 0;
};

// Direction of a hanging elbow from the shoulder-hand line.
inline Vector hanging(const Vector& line) {
    if (line.x < BACKWARD) return {0.0, 0.0, 1.0};
    const double share = line.z / (1.0 + line.x);
    return unit({share * (line.x + 1.0), share * line.y, share * line.z - 1.0});
}

// Swivel of shoulder, elbow, hand; false for a straight arm.
inline bool swivel_of(const Linkage& arm, const Vector* points, double& swivel) {
    const Vector line = unit(points[2] - points[0]);
    const Vector off = across(points[1] - points[0], line);
    if (norm(off) < 1e-6 * arm.farthest || null(line)) return false;
    const Vector zero = hanging(line);
    swivel = arm.side * arctangent(dot(off, cross(line, zero)), dot(off, zero));
    return true;
}

struct Circle {  // circle of possible elbow positions for a fixed shoulder and hand
    Vector shoulder, axial;  // [m] shoulder, and vector from it to the centre
    Vector zero, quarter;    // directions of swivel 0 and 90 degrees
    double radius;           // [m]

    Circle(const Linkage& arm, const Vector& shoulder, const Vector& hand) : shoulder(shoulder) {
        const double upper = arm.upper().length, fore = arm.fore().length;
        const Vector between = hand - shoulder;
        const double span = std::max(norm(between), 1e-9 * arm.farthest);
        const Vector line = norm(between) > 0.0 ? unit(between) : Vector{1.0, 0.0, 0.0};
        double along = (upper * upper - fore * fore + span * span) / (2.0 * span);
        along = std::max(-upper, std::min(upper, along));
        zero = hanging(line);
        quarter = cross(line, zero);
        axial = line * along;
        radius = std::sqrt(upper * upper - along * along);
    }

    Vector at(double side, double swivel) const {
        const Turn turn = turn_of(swivel);
        return shoulder + (axial + (zero * turn.cosine + quarter * (side * turn.sine)) * radius);
    }
};

namespace places {

// Aims the collar bones at given ends.
inline void girdle(const Linkage& arm, const Vector* ends, const double* near, Vector* points) {
    walk(arm, extract(arm, ends, arm.girdle(), near).angles, arm.girdle(), points);
}

// Moves the shoulder as near to a target as possible.
inline void nearest_girdle(const Linkage& arm, const Vector& target, const double* near, Vector* points) {
    const Vector line = unit(target - arm.origin);
    Vector ends[MOST_LINKS + 1] = {arm.origin};
    for (int j = 0; j < arm.girdle(); ++j) ends[j + 1] = ends[j] + line * arm.link[j].length;
    girdle(arm, ends + 1, near, points);
}

inline Place made(const Linkage& arm, const Vector* points, const Vector& target, int iterations) {
    Place place;
    for (int j = 0; j < arm.girdle(); ++j) place.ends[j] = points[j + 1];
    place.shoulder = points[arm.girdle()];
    place.target = target;
    place.iterations = iterations;
    return place;
}

}  // namespace places

// Keeps the shoulder at rest for a target in easy reach; beyond it, the taut arm pulls the shoulder along.
inline Place placed(const Linkage& arm, const Vector& target, const double* near, const double* rest) {
    const int n = arm.girdle();
    const double reach = arm.farthest;
    Vector resting[MOST_LINKS + 1], nearest[MOST_LINKS + 1];
    walk(arm, rest, n, resting);
    if (distance(resting[n], target) <= TAUT * reach) return places::made(arm, resting, target, 0);
    places::nearest_girdle(arm, target, near, nearest);
    if (distance(nearest[n], target) > STRETCH * reach)
        return places::made(arm, nearest, clamp(target, nearest[n], STRETCH * reach), 0);
    double lengths[MOST_LINKS];
    for (int j = 0; j < n; ++j) lengths[j] = arm.link[j].length;
    lengths[n] = TAUT * arm.upper().length;
    lengths[n + 1] = TAUT * arm.fore().length;
    resting[n + 1] = resting[n] + unit(target - resting[n]) * lengths[n];
    resting[n + 2] = target;
    const Settled settled = settle(resting, lengths, n + 2, target);
    Vector pulled[MOST_LINKS + 1];
    places::girdle(arm, settled.points + 1, near, pulled);
    return places::made(arm, pulled, target, settled.iterations);
}

// Shoulder position in a posture.
inline Place place_of(const Linkage& arm, const double* angles, const Vector& target) {
    Vector points[MOST_LINKS + 1];
    walk(arm, angles, arm.girdle(), points);
    return places::made(arm, points, target, 0);
}

// Distance of a target from the nearest possible shoulder position.
inline double gap(const Linkage& arm, const Vector& target, const double* rest) {
    Vector points[MOST_LINKS + 1];
    places::nearest_girdle(arm, target, rest, points);
    return distance(points[arm.girdle()], target);
}

namespace places {

// Smallest distance by which a hand this far from the shoulder is missed, over all elbow positions.
inline double least_miss(const Linkage& arm, double span) {
    const double upper = arm.upper().length, fore = arm.fore().length;
    if (!(std::abs(upper - fore) < span && span < arm.closest && arm.closest <= upper)) return 0.0;
    const auto inner = [&](double far) {
        return arccosine((upper * upper + fore * fore - far * far) / (2.0 * upper * fore));
    };
    return 2.0 * fore * turn_of(0.5 * (inner(arm.closest) - inner(span))).sine;
}

struct Scan {  // postures with the elbow at successive swivels
    const Linkage& arm;
    const Circle circle;
    const double* near;
    Vector ends[MOST_LINKS + 1];
    double wish, tolerance;
    double least = 0.0;  // [m] miss below which no other swivel is tried
    double most = INFINITY;  // [m] miss above which a posture is rejected
    hinges::Stem stem = {};  // collar bone, which no swivel moves

    // Computes a posture; its miss is exact only up to `bound`.
    Extraction at(double offset, double bound = INFINITY) {
        ends[arm.girdle()] = circle.at(arm.side, wish + offset);
        const int count = arm.links - 1;
        if (!stem.count || !arm.girdle()) stem = {arm, ends[0], near, hinges::length_of(arm, count)};
        return extract(arm, stem, ends, count, near, bound);
    }

    // Bisects to the swivel at which the ranges begin to allow the posture.
    Extraction edge(double outside, double inside, Extraction found) {
        for (int step = 0; step < BISECTIONS; ++step) {
            const double middle = 0.5 * (outside + inside);
            const Extraction tried = at(middle, tolerance);
            if (tried.miss <= tolerance) {
                inside = middle;
                found = tried;
            } else {
                outside = middle;
            }
        }
        return found;
    }

    // Searches outward from offset zero for the first posture without a miss, otherwise returns the one with the least.
    Extraction nearest(double towards, bool& exact) {
        Extraction best = at(0.0, most);
        exact = best.miss <= tolerance;
        for (int step = 1; step <= STEPS && !exact; ++step)
            for (const double side : {towards, -towards}) {
                if (best.miss <= least) return best;
                const Extraction found = at(side * step * PI / STEPS, std::min(best.miss, most));
                if (found.miss <= tolerance) {
                    exact = true;
                    return edge(side * (step - 1) * PI / STEPS, side * step * PI / STEPS, found);
                }
                if (found.miss < best.miss) best = found;
            }
        return best;
    }
};

}  // namespace places

// Chooses the elbow position nearest to the requested swivel within the ranges. `swivel` null: a mean of that from the
// masses started at `near` and the natural one. `exact`: only exact postures are useful.
inline Bend bent(const Linkage& arm, const Place& place, const double* near, const double* swivel, bool exact = false) {
    Vector points[MOST_LINKS + 1];
    walk(arm, near, arm.links - 2, points);
    const double lengths[2] = {arm.upper().length, arm.fore().length};
    const Vector begin[3] = {place.shoulder, points[arm.links - 2], place.target};
    const Circle circle(arm, place.shoulder, place.target);
    const bool point = circle.radius == 0.0;  // the arm is too short, so that all swivels are equal
    const int rounds = point ? 0 : circle.radius > SLIM * arm.farthest ? masses::SWUNG : masses::ROUNDS;
    const Settled settled = settle(begin, lengths, 2, place.target, rounds);
    double present = NATURAL_SWIVEL;
    swivel_of(arm, settled.points, present);
    const double wish = swivel ? wrapped(*swivel) : present + NATURE * wrapped(NATURAL_SWIVEL - present);
    const double towards = wrapped(present - wish) >= 0.0 ? 1.0 : -1.0;
    places::Scan scan{arm, circle, near, {}, wish, EXACT * arm.farthest};
    scan.least = point ? INFINITY : places::least_miss(arm, distance(place.shoulder, place.target)) + TIED * arm.farthest;
    if (exact) scan.most = scan.tolerance;
    std::copy(place.ends, place.ends + arm.girdle(), scan.ends);
    scan.ends[arm.girdle() + 1] = place.target;
    Bend bend;
    const Extraction found = scan.nearest(towards, bend.exact);
    std::copy(found.angles, found.angles + arm.own(), bend.angles);
    bend.iterations = settled.iterations;
    return bend;
}

}  // namespace kinesic::arm
