// Joint positions from masses and springs (tests/reference/ik/masses.py; thesis 7.3.1, method 2).

#pragma once

#include "arm_linkage.h"

namespace kinesic::arm {

struct RelaxedMasses {
    Vector points[MAX_LINKS + 1];  // [m] mass positions, one more than bones
    int iterations = 0;
    double energy = 0.0;  // [stiffness x chain length] total spring force
};

// Moves a target towards the base until its distance d is within reach: factor D_max / d (thesis eq. 7.3.7, which is
// printed upside down).
inline Vector clamp_to_reach(const Vector& target, const Vector& base, double reach) {
    const double d = distance(target, base);
    return d <= reach ? target : base + (target - base) * (reach / d);
}

namespace masses {

constexpr double TOLERANCE = 1e-6;          // [stiffness x chain length] total spring force at rest
constexpr int MAX_ITERATIONS = 300;
constexpr int SWIVEL_ITERATIONS = 16;       // iterations after which a single free mass no longer changes its side
constexpr double DAMPING_FRACTION = 0.75;   // damping / theoretical optimum, because bends add slower modes
constexpr double PARALLEL_SINE = 1e-4;      // sine of the angle below which bones count as collinear
constexpr double NUDGE_DISTANCE = 0.02;     // [chain lengths] sideways displacement that bends a straight chain

struct SpringSettings {
    double stiffness, momentum;
};

// Optimal heavy-ball parameter for the springs' Laplacian: k = 4 / (sqrt L + sqrt m)^2, a function of the bone count.
inline SpringSettings spring_settings(int bones) {
    const double slow = std::sqrt(2.0 - 2.0 * turn_of(PI / bones).cosine);
    const double fast = std::sqrt(2.0 - 2.0 * turn_of(PI * (bones - 1) / bones).cosine);
    const double ratio = (fast - slow) / (fast + slow);
    return {4.0 / ((fast + slow) * (fast + slow)), 1.0 - DAMPING_FRACTION * (1.0 - ratio * ratio)};
}

inline Vector pull(const Vector& near, const Vector& far, double rest) {  // Hooke's law, per stiffness
    const Vector stretch = far - near;
    const double length = norm(stretch);
    return length > 0.0 ? stretch * (1.0 - rest / length) : Vector{0.0, 0.0, -rest};
}

// Displaces the inner masses of a straight chain sideways, because the springs would never bend it.
inline void bend(Vector* mass, int bones) {
    Vector line = unit(mass[bones] - mass[0]);
    if (null(line)) line = unit(mass[1] - mass[0]);
    for (int i = 1; i < bones; ++i)
        if (norm(cross(line, mass[i] - mass[0])) > PARALLEL_SINE) return;
    const Vector sag = across({0.0, 0.0, -1.0}, line);
    const Vector aside = unit(norm(sag) > PARALLEL_SINE ? sag : across({-1.0, 0.0, 0.0}, line));
    for (int i = 1; i < bones; ++i) mass[i] = mass[i] + aside * NUDGE_DISTANCE;
}

}  // namespace masses

// Relaxes unit masses between base and target (Stoermer-Verlet, eq. 7.3.6), in units of the chain's length.
// `BONES`: number of bones if constant at compile time, which keeps the masses in registers; otherwise 0.
template <int BONES>
RelaxedMasses relax_masses(const Vector* points, const double* lengths, int number, const Vector& target, int rounds) {
    const int bones = BONES ? BONES : number;
    constexpr int MAX_MASSES = BONES ? BONES : MAX_LINKS;
    double size = 0.0, rest[MAX_MASSES];
    for (int i = 0; i < bones; ++i) size += lengths[i];
    for (int i = 0; i < bones; ++i) rest[i] = lengths[i] / size;
    const Vector base = points[0], pinned = clamp_to_reach(target, base, size);
    Vector mass[MAX_MASSES + 1], before[MAX_MASSES + 1];
    for (int i = 0; i < bones; ++i) mass[i] = (points[i] - base) * (1.0 / size);
    mass[bones] = (pinned - base) * (1.0 / size);
    masses::bend(mass, bones);
    for (int i = 0; i <= bones; ++i) before[i] = mass[i];
    const auto [stiffness, momentum] = masses::spring_settings(bones);
    RelaxedMasses relaxed;
    for (int round = 0; round <= rounds; ++round) {
        Vector force[MAX_MASSES + 1];
        double energy = 0.0;
        Vector behind = masses::pull(mass[0], mass[1], rest[0]);
        for (int i = 1; i < bones; ++i) {
            const Vector ahead = masses::pull(mass[i], mass[i + 1], rest[i]);
            force[i] = ahead - behind;
            energy += norm(force[i]);
            behind = ahead;
        }
        relaxed.iterations = round;
        relaxed.energy = energy;
        if (energy < masses::TOLERANCE || round == rounds) break;
        for (int i = 1; i < bones; ++i) {
            const Vector now = mass[i];
            mass[i] = now + ((now - before[i]) * momentum + force[i] * stiffness);
            before[i] = now;
        }
    }
    relaxed.points[0] = base;
    for (int i = 1; i < bones; ++i) relaxed.points[i] = base + mass[i] * size;
    relaxed.points[bones] = pinned;
    return relaxed;
}

inline RelaxedMasses settle(const Vector* points, const double* lengths, int bones, const Vector& target,
                      int rounds = masses::MAX_ITERATIONS) {
    if (bones == 2) return relax_masses<2>(points, lengths, bones, target, rounds);
    if (bones == 3) return relax_masses<3>(points, lengths, bones, target, rounds);
    return relax_masses<0>(points, lengths, bones, target, rounds);
}

}  // namespace kinesic::arm
