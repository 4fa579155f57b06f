// Joint positions from masses and springs (tests/reference/ik/masses.py; thesis 7.3.1, method 2).

#pragma once

#include "arm_linkage.h"

namespace kinesic::arm {

struct Settled {
    Vector points[MOST_LINKS + 1];  // [m] mass positions, one more than bones
    int iterations = 0;
    double energy = 0.0;  // in units of stiffness x chain length
};

// Target, or the point at the reach in its direction: factor D_max / d (thesis eq. 7.3.7, printed upside down).
inline Vector clamp(const Vector& target, const Vector& base, double reach) {
    const double d = distance(target, base);
    return d <= reach ? target : base + (target - base) * (reach / d);
}

namespace masses {

constexpr double TOLERANCE = 1e-6;
constexpr int ROUNDS = 300;
constexpr int SWUNG = 16;
constexpr double DAMPING_SHARE = 0.75;
constexpr double STRAIGHT = 1e-4;
constexpr double NUDGE = 0.02;

struct Tuned {
    double stiffness, momentum;
};

// Optimal heavy-ball parameter for the springs' Laplacian: k = 4 / (sqrt L + sqrt m)^2, a function of the bone count.
inline Tuned tuned(int bones) {
    const double slow = std::sqrt(2.0 - 2.0 * turn_of(PI / bones).cosine);
    const double fast = std::sqrt(2.0 - 2.0 * turn_of(PI * (bones - 1) / bones).cosine);
    const double share = (fast - slow) / (fast + slow);
    return {4.0 / ((fast + slow) * (fast + slow)), 1.0 - DAMPING_SHARE * (1.0 - share * share)};
}

inline Vector pull(const Vector& near, const Vector& far, double rest) {  // Hooke's law, per stiffness
    const Vector stretch = far - near;
    const double length = norm(stretch);
    return length > 0.0 ? stretch * (1.0 - rest / length) : Vector{0.0, 0.0, -rest};
}

// Moves the inner masses of a straight chain slightly aside, because it would never leave its line.
inline void bend(Vector* mass, int bones) {
    Vector line = unit(mass[bones] - mass[0]);
    if (null(line)) line = unit(mass[1] - mass[0]);
    for (int i = 1; i < bones; ++i)
        if (norm(cross(line, mass[i] - mass[0])) > STRAIGHT) return;
    const Vector sag = across({0.0, 0.0, -1.0}, line);
    const Vector aside = unit(norm(sag) > STRAIGHT ? sag : across({-1.0, 0.0, 0.0}, line));
    for (int i = 1; i < bones; ++i) mass[i] = mass[i] + aside * NUDGE;
}

}  // namespace masses

// Relaxes unit masses between base and target (Stoermer-Verlet, eq. 7.3.6), in units of the chain's length.
// `BONES`: their number if known at compile time, so that the masses stay in registers; otherwise 0.
template <int BONES>
Settled swing_masses(const Vector* points, const double* lengths, int number, const Vector& target, int rounds) {
    const int bones = BONES ? BONES : number;
    constexpr int MOST = BONES ? BONES : MOST_LINKS;
    double size = 0.0, rest[MOST];
    for (int i = 0; i < bones; ++i) size += lengths[i];
    for (int i = 0; i < bones; ++i) rest[i] = lengths[i] / size;
    const Vector base = points[0], pinned = clamp(target, base, size);
    Vector mass[MOST + 1], before[MOST + 1];
    for (int i = 0; i < bones; ++i) mass[i] = (points[i] - base) * (1.0 / size);
    mass[bones] = (pinned - base) * (1.0 / size);
    masses::bend(mass, bones);
    for (int i = 0; i <= bones; ++i) before[i] = mass[i];
    const auto [stiffness, momentum] = masses::tuned(bones);
    Settled settled;
    for (int round = 0; round <= rounds; ++round) {
        Vector force[MOST + 1];
        double energy = 0.0;
        Vector behind = masses::pull(mass[0], mass[1], rest[0]);
        for (int i = 1; i < bones; ++i) {
            const Vector ahead = masses::pull(mass[i], mass[i + 1], rest[i]);
            force[i] = ahead - behind;
            energy += norm(force[i]);
            behind = ahead;
        }
        settled.iterations = round;
        settled.energy = energy;
        if (energy < masses::TOLERANCE || round == rounds) break;
        for (int i = 1; i < bones; ++i) {
            const Vector now = mass[i];
            mass[i] = now + ((now - before[i]) * momentum + force[i] * stiffness);
            before[i] = now;
        }
    }
    settled.points[0] = base;
    for (int i = 1; i < bones; ++i) settled.points[i] = base + mass[i] * size;
    settled.points[bones] = pinned;
    return settled;
}

inline Settled settle(const Vector* points, const double* lengths, int bones, const Vector& target,
                      int rounds = masses::ROUNDS) {
    if (bones == 2) return swing_masses<2>(points, lengths, bones, target, rounds);
    if (bones == 3) return swing_masses<3>(points, lengths, bones, target, rounds);
    return swing_masses<0>(points, lengths, bones, target, rounds);
}

}  // namespace kinesic::arm
