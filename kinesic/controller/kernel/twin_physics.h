// Physics of a twin with a log of every step, as `sim/twin.py` runs it command by command.

#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

#include "physics_step.h"

namespace kinesic::controller {

constexpr double SAME_TIME = 1e-9;  // [s] smaller differences of times count as zero

struct Goals {
    double arrival;              // [s]
    std::vector<double> angles;  // (n,) [rad]
};

struct TwinPhysics {
    PhysicsStep step;
    double* timestep = nullptr;
    const double *positions = nullptr, *speeds = nullptr;  // MuJoCo's qpos and qvel
    double* control = nullptr;                             // its ctrl
    int size = 0;                                          // length of qpos, equal to that of qvel
    std::vector<int> hinges, play, actuators;  // (n,) indices of hinges, backlash joints (or empty) and actuators
    std::vector<double> ticks;                 // (n,) [rad] resolution of setpoints and positions; empty: not rounded
    double longest = 0.0, latency = 0.0;       // [s] longest step, and latency of setpoints

    bool begun = false;
    double time = 0.0, last = 0.0;  // [s] now, and length of the last step
    std::vector<double> goals;      // (n,) [rad] current setpoints
    std::deque<Goals> waiting;      // setpoints that have not arrived yet

    // Log since it was last taken:
    std::vector<double> angles_kept, speeds_kept, spans;  // (s, size), (s, size), (s,) of all steps
    std::vector<int64_t> aimed;                           // number of steps before each change of setpoints
    std::vector<int64_t> counts;                          // number of steps at each command
    std::vector<double> sent;                             // (m, n) [rad] setpoints of each command

    // The first command sets time zero.
    void begin(double at) {
        if (!begun) time = at;
        begun = true;
    }

    double rounded(double value, int hinge) const {
        return ticks.empty() ? value : std::nearbyint(value / ticks[hinge]) * ticks[hinge];
    }

    // Writes the servos' measured angles (n,) [rad], half a step back, as semi-implicit steps run ahead of the setpoints.
    void read(double* into) const {
        for (size_t i = 0; i < hinges.size(); ++i) {
            double angle = positions[hinges[i]] - last / 2 * speeds[hinges[i]];
            if (!play.empty()) angle += positions[play[i]] - last / 2 * speeds[play[i]];
            into[i] = rounded(angle, int(i));
        }
    }

    void aim() {
        for (size_t i = 0; i < actuators.size(); ++i) control[actuators[i]] = goals[i];
    }

    // Subtracts the backlash from the setpoints, because servos measure motor and backlash together.
    void aim_through_play() {
        for (size_t i = 0; i < actuators.size(); ++i) control[actuators[i]] = goals[i] - positions[play[i]];
    }

    void advance(double until) {
        const double span = until - time;
        if (span <= SAME_TIME) return;
        const int count = int(std::ceil(span / longest - SAME_TIME));
        *timestep = last = span / count;
        for (int k = 0; k < count; ++k) {
            if (!play.empty()) aim_through_play();
            step.advance();
            angles_kept.insert(angles_kept.end(), positions, positions + size);
            speeds_kept.insert(speeds_kept.end(), speeds, speeds + size);
        }
        spans.insert(spans.end(), count, last);
        time = until;
    }

    // Steps to a command's time, then accepts its setpoints (n,) [rad].
    void write(double until, const double* wanted) {
        while (!waiting.empty() && waiting.front().arrival <= until - SAME_TIME) {
            advance(waiting.front().arrival);
            goals = std::move(waiting.front().angles);
            waiting.pop_front();
            aimed.push_back(int64_t(spans.size()));
            aim();
        }
        advance(until);
        std::vector<double> taken(hinges.size());
        for (size_t i = 0; i < taken.size(); ++i) taken[i] = rounded(wanted[i], int(i));
        counts.push_back(int64_t(spans.size()));
        sent.insert(sent.end(), taken.begin(), taken.end());
        waiting.push_back({until + latency, std::move(taken)});
    }
};

}  // namespace kinesic::controller
