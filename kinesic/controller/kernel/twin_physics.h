// A twin's physics, and every step of it kept: what `sim/twin.py` does command by command.

#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <vector>

#include "physics_step.h"

namespace kinesic::controller {

constexpr double SAME_TIME = 1e-9;  // [s] below which two times are one

struct Goals {
    double arrival;              // [s]
    std::vector<double> angles;  // (n,) [rad]
};

struct TwinPhysics {
    PhysicsStep step;
    double* timestep = nullptr;
    const double *positions = nullptr, *speeds = nullptr;  // MuJoCo's qpos and qvel
    double* control = nullptr;                             // its ctrl
    int size = 0;                                          // of qpos, which is that of qvel
    std::vector<int> hinges, play, actuators;  // (n,) where the hinges are in them; play is empty where there is none
    std::vector<double> ticks;                 // (n,) [rad] of goals and positions; empty: they are not rounded
    double longest = 0.0, latency = 0.0;       // [s] of a step, and of goals

    bool begun = false;
    double time = 0.0, last = 0.0;  // [s] now, and length of the last step
    std::vector<double> goals;      // (n,) [rad] in force
    std::deque<Goals> waiting;      // under way

    // What was kept since somebody took it away:
    std::vector<double> angles_kept, speeds_kept, spans;  // (s, size), (s, size), (s,) of all steps
    std::vector<int64_t> aimed;                           // steps before new goals came into force
    std::vector<int64_t> counts;                          // steps so far at each command
    std::vector<double> sent;                             // (m, n) [rad] goals of each command

    // Time begins with the first command.
    void begin(double at) {
        if (!begun) time = at;
        begun = true;
    }

    double rounded(double value, int hinge) const {
        return ticks.empty() ? value : std::nearbyint(value / ticks[hinge]) * ticks[hinge];
    }

    // What the servos' registers hold (n,) [rad]; semi-implicit steps run half a step ahead of the held goals.
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

    // Motors stand where play does not add: servos measure both together.
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

    // Steps up to a command's time, then takes its goals (n,) [rad].
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
