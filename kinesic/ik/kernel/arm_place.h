// Positions of shoulder and elbow for a target (tests/reference/ik/shoulder_elbow.py, swivel.py).

#pragma once

#include "arm_hinges.h"
#include "arm_masses.h"

namespace kinesic::arm {

constexpr double MAX_STRETCH_RATIO = 0.9999;     // [reach] distance to which targets beyond reach are clamped
constexpr double TAUT_RATIO = 0.97;              // [reach] distance beyond which the arm pulls the shoulder along
constexpr double EXACT_MISS = 1e-6;              // [reach] largest miss of an exact posture
constexpr double NATURAL_SWIVEL = 0.35;          // [rad] swivel of a relaxed elbow, slightly away from the body
constexpr double NATURAL_SWIVEL_WEIGHT = 0.5;    // fraction of the swivel change towards the natural one if none is requested
constexpr double MIN_CIRCLE_RATIO = 1e-3;        // [reach] radius of the elbow's circle below which it has no side
constexpr double EQUAL_MISS = 1e-9;              // [reach] misses that differ by less are equal
constexpr int SEARCH_STEPS = 12;                 // swivels tried on each side of the desired one
constexpr int BISECTION_STEPS = 6;
constexpr double BACKWARD_COSINE = -1.0 + 1e-9;  // cosine below which an arm line points backward

struct Place {  // shoulder position for a target, and the target within reach
    Vector ends[MAX_LINKS];  // [m] ends of the collar bones; elbow and target follow once the arm is bent
    Vector shoulder, target;  // [m]
    int iterations = 0;
};

struct Bend {
    double angles[MAX_HINGES];  // [rad] of the hinges before the hand
    bool exact = false;
    int iterations = 0;
};

// Direction from the shoulder-hand line to a hanging elbow.
inline Vector hanging(const Vector& line) {
    if (line.x < BACKWARD_COSINE) return {0.0, 0.0, 1.0};
    const double scale = line.z / (1.0 + line.x);
    return unit({scale * (line.x + 1.0), scale * line.y, scale * line.z - 1.0});
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
    Vector ends[MAX_LINKS + 1] = {arm.origin};
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

// Keeps the shoulder at rest for a near target; for a far one, the nearly straight arm pulls the shoulder along.
inline Place placed(const Linkage& arm, const Vector& target, const double* near, const double* rest) {
    const int n = arm.girdle();
    const double reach = arm.farthest;
    Vector resting[MAX_LINKS + 1], nearest[MAX_LINKS + 1];
    walk(arm, rest, n, resting);
    if (distance(resting[n], target) <= TAUT_RATIO * reach) return places::made(arm, resting, target, 0);
    places::nearest_girdle(arm, target, near, nearest);
    if (distance(nearest[n], target) > MAX_STRETCH_RATIO * reach)
        return places::made(arm, nearest, clamp_to_reach(target, nearest[n], MAX_STRETCH_RATIO * reach), 0);
    double lengths[MAX_LINKS];
    for (int j = 0; j < n; ++j) lengths[j] = arm.link[j].length;
    lengths[n] = TAUT_RATIO * arm.upper().length;
    lengths[n + 1] = TAUT_RATIO * arm.fore().length;
    resting[n + 1] = resting[n] + unit(target - resting[n]) * lengths[n];
    resting[n + 2] = target;
    const RelaxedMasses relaxed = settle(resting, lengths, n + 2, target);
    Vector pulled[MAX_LINKS + 1];
    places::girdle(arm, relaxed.points + 1, near, pulled);
    return places::made(arm, pulled, target, relaxed.iterations);
}

// Shoulder position in a posture.
inline Place place_of(const Linkage& arm, const double* angles, const Vector& target) {
    Vector points[MAX_LINKS + 1];
    walk(arm, angles, arm.girdle(), points);
    return places::made(arm, points, target, 0);
}

// Distance of a target from the nearest possible shoulder position.
inline double gap(const Linkage& arm, const Vector& target, const double* rest) {
    Vector points[MAX_LINKS + 1];
    places::nearest_girdle(arm, target, rest, points);
    return distance(points[arm.girdle()], target);
}

namespace places {

// Smallest miss of a hand at distance `span` from the shoulder, over all elbow positions.
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
    Vector ends[MAX_LINKS + 1];
    double wish, tolerance;
    double least = 0.0;  // [m] miss below which no other swivel is tried
    double most = INFINITY;  // [m] miss above which a posture is rejected
    hinges::FirstLinkSolutions stem = {};  // collar bone, which no swivel moves

    // Computes a posture; its miss is exact only up to `bound`.
    Extraction at(double offset, double bound = INFINITY) {
        ends[arm.girdle()] = circle.at(arm.side, wish + offset);
        const int count = arm.links - 1;
        if (!stem.count || !arm.girdle()) stem = {arm, ends[0], near, hinges::length_of(arm, count)};
        return extract(arm, stem, ends, count, near, bound);
    }

    // Bisects to the swivel at the boundary of the hinge ranges.
    Extraction edge(double outside, double inside, Extraction found) {
        for (int step = 0; step < BISECTION_STEPS; ++step) {
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

    // Searches outward from offset zero for the first exact posture; otherwise returns the one with the smallest miss.
    Extraction nearest(double towards, bool& exact) {
        Extraction best = at(0.0, most);
        exact = best.miss <= tolerance;
        for (int step = 1; step <= SEARCH_STEPS && !exact; ++step)
            for (const double side : {towards, -towards}) {
                if (best.miss <= least) return best;
                const Extraction found = at(side * step * PI / SEARCH_STEPS, std::min(best.miss, most));
                if (found.miss <= tolerance) {
                    exact = true;
                    return edge(side * (step - 1) * PI / SEARCH_STEPS, side * step * PI / SEARCH_STEPS, found);
                }
                if (found.miss < best.miss) best = found;
            }
        return best;
    }
};

}  // namespace places

// Chooses the elbow position in range that is nearest to the requested swivel. Without one (null), the desired swivel
// is a mean of the natural one and that of the masses started at `near`. `exact`: reject postures that are not exact.
inline Bend bent(const Linkage& arm, const Place& place, const double* near, const double* swivel, bool exact = false) {
    Vector points[MAX_LINKS + 1];
    walk(arm, near, arm.links - 2, points);
    const double lengths[2] = {arm.upper().length, arm.fore().length};
    const Vector begin[3] = {place.shoulder, points[arm.links - 2], place.target};
    const Circle circle(arm, place.shoulder, place.target);
    const bool point = circle.radius == 0.0;  // the arm is straight, so that all swivels are equal
    const bool has_sides = circle.radius > MIN_CIRCLE_RATIO * arm.farthest;
    const int rounds = point ? 0 : has_sides ? masses::SWIVEL_ITERATIONS : masses::MAX_ITERATIONS;
    const RelaxedMasses relaxed = settle(begin, lengths, 2, place.target, rounds);
    double present = NATURAL_SWIVEL;
    swivel_of(arm, relaxed.points, present);
    const double wish = swivel ? wrapped(*swivel) : present + NATURAL_SWIVEL_WEIGHT * wrapped(NATURAL_SWIVEL - present);
    const double towards = wrapped(present - wish) >= 0.0 ? 1.0 : -1.0;
    places::Scan scan{arm, circle, near, {}, wish, EXACT_MISS * arm.farthest};
    scan.least = point ? INFINITY : places::least_miss(arm, distance(place.shoulder, place.target)) + EQUAL_MISS * arm.farthest;
    if (exact) scan.most = scan.tolerance;
    std::copy(place.ends, place.ends + arm.girdle(), scan.ends);
    scan.ends[arm.girdle() + 1] = place.target;
    Bend bend;
    const Extraction found = scan.nearest(towards, bend.exact);
    std::copy(found.angles, found.angles + arm.own(), bend.angles);
    bend.iterations = relaxed.iterations;
    return bend;
}

}  // namespace kinesic::arm
