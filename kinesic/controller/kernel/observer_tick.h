// One tick of the observer of `controller/observer.py` for all hinges, with the arithmetic of `controller/observer_step.py`.

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinesic::controller {

enum Belief { DEVIATION, SPEED, PUSH, UNDER_WAY };  // rows; then the pending corrections, load, pace, correction, setpoints
enum Input { ANGLE, GOAL, LOWEST, HIGHEST, LOAD, NOTICED, TRUST, LEAD, NOTICED_LEAD, TRUST_LEAD, INPUTS };

struct Observer {
    int hinges = 0, late = 0;      // late: number of pending corrections
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
inline void observe(const Observer& self, const double* inputs, const double* measured, double* belief) {
    const int n = self.hinges, late = self.late;
    for (int i = 0; i < n; ++i) {
        const auto held = [&](int row) -> double& { return belief[row * n + i]; };
        const auto input = [&](int row) { return inputs[row * n + i]; };
        double &share = held(UNDER_WAY + late), &pace = held(UNDER_WAY + late + 1);
        double &correction = held(UNDER_WAY + late + 2), &goals = held(UNDER_WAY + late + 3);

        const bool answers = std::isfinite(measured[i]);
        const double innovation = answers ? measured[i] - held(DEVIATION) : 0.0;
        const double deviation = held(DEVIATION) + self.gain[i] * innovation;
        const double speed = held(SPEED) + self.gain[n + i] * innovation;
        double push = answers ? held(PUSH) + self.gain[2 * n + i] * innovation : self.fading * held(PUSH);
        const double heavier = between(share - input(TRUST) * push, self.lightest, self.heaviest);
        const double quicker = between(pace - input(TRUST_LEAD) * push, self.lightest, self.heaviest);
        push += (heavier - share) * input(NOTICED) + (quicker - pace) * input(NOTICED_LEAD);

        double arrived = 0.0;
        for (int k = 0; k < late; ++k) arrived += self.arrival[k] * held(UNDER_WAY + k);
        const double acting[3] = {deviation, speed, push + arrived};
        double motion[3], restored = 0.0;
        for (int k = 0; k < 3; ++k) {
            motion[k] = 0.0;
            for (int j = 0; j < 3; ++j) motion[k] += self.forecast[(3 * k + j) * n + i] * acting[j];
        }
        motion[2] -= arrived;
        for (int k = 0; k < 3; ++k) restored += self.restoring[k] * motion[k];

        const double led = input(GOAL), before = led + correction;
        const double foreseen = led + heavier * input(LOAD) + quicker * input(LEAD);
        const double asked = between(foreseen - restored, before - self.step[i], before + self.step[i]);
        goals = between(asked, input(LOWEST), input(HIGHEST));
        const double position = input(ANGLE) + motion[0];
        for (int k = late - 1; k > 0; --k) held(UNDER_WAY + k) = held(UNDER_WAY + k - 1);
        held(UNDER_WAY) = between(goals, position - self.full[i], position + self.full[i]) - foreseen;
        for (int k = 0; k < 3; ++k) held(k) = motion[k];
        share = heavier;
        pace = quicker;
        correction = goals - led;
    }
}

}  // namespace kinesic::controller
