// Postures, servo quantities and power of each physics step, for `sim/stepping/driven_motion.py`.

#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace kinesic::sim {

// Constants (n,) of the drives: control law and current.
struct DriveRows {
    const double *gain, *rate, *no_load, *stall_current, *idle_current;
};

// Content of a step log: s steps of q joints, and g setpoint rows, each valid from a certain step on.
struct LoggedSteps {
    const double *angles, *velocities, *durations, *supplies, *setpoints;
    const int64_t* begins;
    size_t count, joints, supply_count, rows;

    double supply(size_t step) const { return supplies[supply_count == 1 ? 0 : step]; }  // supply / nominal voltage
};

// Thermal model of a winding: its hinge, copper loss [W] at full load, thermal resistance [K/W], and the fraction (s,)
// of the temperature rise that remains after each step.
struct Winding {
    size_t hinge;
    double loss, resistance;
    const double* kept;
};

// Output arrays for m commands: postures (s, n) [rad] of all steps; angles, velocities, duties and loads (m, n); mean and
// largest currents (m,) [A]; temperature rises (w, m) [K].
struct DrivenRows {
    double *postures, *angles, *speeds, *duties, *loads, *mean, *peak, *warmth;
};

struct DrivenMotion {
    const LoggedSteps& log;
    const std::vector<int>& motors;  // (n,) indices of the joints that the motors drive
    const std::vector<int>& play;    // (n,) indices of the backlash joints, or empty
    const DriveRows drives;
    const std::vector<Winding>& windings;
    std::vector<double> now;  // (6, n) angles, velocities, duties, loads, currents, clipped duties

    // Measures all steps up to the last command. `ends` (m,) has the step count at each command. Steps before `first` were
    // counted earlier; the others add to the charge (n,) [As] of each drive and the temperature rise (w,) [K] of windings.
    void measure(const int64_t* ends, size_t commands, size_t first, const DrivenRows& to, double* warmth, double* charge) {
        const size_t n = motors.size();
        std::vector<double> current(log.count), counted(n);
        now.assign(6 * n, 0.0);
        size_t row = 0;
        for (size_t s = 0, k = 0; s < log.count; ++s) {
            while (row + 1 < log.rows && size_t(log.begins[row + 1]) <= s) ++row;
            current[s] = step(s, log.setpoints + row * n, to.postures + s * n, s < first ? counted.data() : charge);
            for (size_t w = 0; s >= first && w < windings.size(); ++w) {
                const Winding& winding = windings[w];
                const double load = now[3 * n + winding.hinge], steady = winding.loss * (load * load) * winding.resistance;
                warmth[w] = steady + (warmth[w] - steady) * winding.kept[s];
            }
            for (; k < commands && size_t(ends[k]) == s + 1; ++k) {
                double* rows[4] = {to.angles, to.speeds, to.duties, to.loads};
                for (int part = 0; part < 4; ++part) std::copy_n(&now[part * n], n, rows[part] + k * n);
                for (size_t w = 0; w < windings.size(); ++w) to.warmth[w * commands + k] = warmth[w];
                measure_current(std::min<size_t>(k ? ends[k - 1] : first, s), s + 1, current.data(), to.mean[k], to.peak[k]);
            }
        }
    }

  private:
    // Measures one step and returns the total current [A] of all drives.
    double step(size_t s, const double* __restrict setpoints, double* __restrict posture, double* __restrict charge) {
        const size_t n = motors.size();
        const double *angles = log.angles + s * log.joints, *speeds = log.velocities + s * log.joints;
        const double half = log.durations[s] / 2, supply = log.supply(s), duration = log.durations[s] * supply;
        double *__restrict angle = now.data(), *__restrict speed = angle + n, *__restrict duty = speed + n;
        double *__restrict load = duty + n, *__restrict drawn = load + n, *__restrict applied = drawn + n;
        for (size_t i = 0; i < n; ++i) {
            angle[i] = angles[motors[i]] - half * speeds[motors[i]];
            speed[i] = speeds[motors[i]];
        }
        for (size_t i = 0; i < play.size(); ++i) {
            angle[i] += angles[play[i]] - half * speeds[play[i]];
            speed[i] += speeds[play[i]];
        }
        for (size_t i = 0; i < n; ++i) {
            posture[i] = angle[i];
            duty[i] = drives.gain[i] * (setpoints[i] - angle[i]) - drives.rate[i] * speed[i];
        }
        for (size_t i = 0; i < n; ++i) applied[i] = duty[i] < -1.0 ? -1.0 : duty[i];  // branchless, so vectorised
        for (size_t i = 0; i < n; ++i) applied[i] = applied[i] > 1.0 ? 1.0 : applied[i];
        for (size_t i = 0; i < n; ++i) {
            load[i] = supply * applied[i] - speed[i] / drives.no_load[i];
            drawn[i] = applied[i] * load[i];
        }
        for (size_t i = 0; i < n; ++i) drawn[i] = drawn[i] < 0.0 ? 0.0 : drawn[i];
        for (size_t i = 0; i < n; ++i) {
            drawn[i] = drawn[i] * drives.stall_current[i] + drives.idle_current[i];
            charge[i] += duration * drawn[i];
        }
        double current = 0.0;
        for (size_t i = 0; i < n; ++i) current += drawn[i];
        return current;
    }

    // Computes the mean and largest current of an interval; the mean of a zero-length interval is that of its last step.
    void measure_current(size_t begin, size_t end, const double* current, double& mean, double& peak) const {
        double duration = 0.0, sum = 0.0;
        peak = current[begin];
        for (size_t s = begin; s < end; ++s) {
            duration += log.durations[s];
            sum += current[s] * log.durations[s];
            peak = std::max(peak, current[s]);
        }
        mean = duration > 0.0 ? sum / duration : current[end - 1];
    }
};

}  // namespace kinesic::sim
