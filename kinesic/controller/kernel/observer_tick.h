// One tick of the observer of `controller/observer.py` for all hinges, with constants of `controller/observer_step.py`.

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinesic::controller {

// Rows of an estimate; behind the pending corrections follow load factor, velocity factor, correction and setpoints.
enum Estimate { DEVIATION, VELOCITY, DISTURBANCE, PENDING };
enum Input {
    ANGLE,
    SETPOINT,
    LOWER_LIMIT,
    UPPER_LIMIT,
    LOAD,
    DETECTED_LOAD,
    LOAD_TRUST,
    VELOCITY_OFFSET,
    DETECTED_VELOCITY_OFFSET,
    VELOCITY_OFFSET_TRUST,
    INPUTS
};

struct Observer {
    int hinges = 0, late = 0;      // late: number of pending corrections, one per tick of latency
    std::vector<double> forecast;  // (3, 3, n)
    std::vector<double> gain;      // (3, n)
    std::vector<double> step;      // (n,) [rad] correction step per tick
    std::vector<double> full;      // (n,) [rad] error that certainly causes full duty
    std::vector<double> arrival;   // (late,)
    double restoring[3] = {};      // gains on deviation, velocity and disturbance
    double lightest = 0.0, heaviest = 0.0;  // range of the estimated load
    double fading = 0.0;                    // decay of the disturbance while a servo is silent

    int rows() const { return 7 + late; }
};

inline double between(double value, double lower, double upper) { return std::min(std::max(value, lower), upper); }

// Advances an estimate (7 + late, n) by inputs (10, n) and measured angles (n,), minus the reference a tick before.
inline void observe(const Observer& self, const double* inputs, const double* measured, double* estimate) {
    const int n = self.hinges, late = self.late;
    for (int i = 0; i < n; ++i) {
        const auto held = [&](int row) -> double& { return estimate[row * n + i]; };
        const auto input = [&](int row) { return inputs[row * n + i]; };
        double &load_factor = held(PENDING + late), &velocity_factor = held(PENDING + late + 1);
        double &correction = held(PENDING + late + 2), &goals = held(PENDING + late + 3);

        const bool is_measured = std::isfinite(measured[i]);
        const double innovation = is_measured ? measured[i] - held(DEVIATION) : 0.0;
        const double deviation = held(DEVIATION) + self.gain[i] * innovation;
        const double velocity = held(VELOCITY) + self.gain[n + i] * innovation;
        double disturbance =
            is_measured ? held(DISTURBANCE) + self.gain[2 * n + i] * innovation : self.fading * held(DISTURBANCE);
        const double heavier = between(load_factor - input(LOAD_TRUST) * disturbance, self.lightest, self.heaviest);
        const double faster =
            between(velocity_factor - input(VELOCITY_OFFSET_TRUST) * disturbance, self.lightest, self.heaviest);
        disturbance += (heavier - load_factor) * input(DETECTED_LOAD) +
                       (faster - velocity_factor) * input(DETECTED_VELOCITY_OFFSET);

        double arrived = 0.0;
        for (int k = 0; k < late; ++k) arrived += self.arrival[k] * held(PENDING + k);
        const double acting[3] = {deviation, velocity, disturbance + arrived};
        double motion[3], restored = 0.0;
        for (int k = 0; k < 3; ++k) {
            motion[k] = 0.0;
            for (int j = 0; j < 3; ++j) motion[k] += self.forecast[(3 * k + j) * n + i] * acting[j];
        }
        motion[2] -= arrived;
        for (int k = 0; k < 3; ++k) restored += self.restoring[k] * motion[k];

        const double setpoint = input(SETPOINT), before = setpoint + correction;
        const double expected = setpoint + heavier * input(LOAD) + faster * input(VELOCITY_OFFSET);
        const double requested = between(expected - restored, before - self.step[i], before + self.step[i]);
        goals = between(requested, input(LOWER_LIMIT), input(UPPER_LIMIT));
        const double position = input(ANGLE) + motion[0];
        for (int k = late - 1; k > 0; --k) held(PENDING + k) = held(PENDING + k - 1);
        held(PENDING) = between(goals, position - self.full[i], position + self.full[i]) - expected;
        for (int k = 0; k < 3; ++k) held(k) = motion[k];
        load_factor = heavier;
        velocity_factor = faster;
        correction = goals - setpoint;
    }
}

}  // namespace kinesic::controller
