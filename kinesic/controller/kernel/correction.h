// Correction of setpoints tick by tick: an observer with its estimate and the required history. The arithmetic is that of
// `Observer.inputs`.

#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "observer_tick.h"

namespace kinesic::controller {

// Settings of a correction in addition to the observer's gains: setpoint range, learning and forgetting rates.
struct CorrectionSettings {
    std::vector<double> lower, upper;  // (n,) [rad] range of setpoints
    double noticed = 0.0;              // fraction of a disturbance that is detected after one tick
    double forgotten = 0.0;            // fraction of the learned correction that is forgotten per tick
    double clear = 0.0;                // [rad^2] squared feed-forward offset at which its sign has half confidence
    double largest = 0.0;              // [rad] largest correction
};

// Feed-forward of one tick, (n,) [rad] each: planned angles, setpoints, and the load and velocity offsets in them.
struct FeedforwardTick {
    const double *angles, *goals, *loads, *leads;
};

class Correction {
  public:
    Correction(Observer made, CorrectionSettings given) : observer(std::move(made)), settings(std::move(given)) {}

    int hinges() const { return observer.hinges; }
    bool begun() const { return !earlier.empty(); }

    // Returns the setpoints (n,) [rad] of a tick, corrected by measured angles (n,) [rad]; unchanged in the first tick.
    const double* correct(const FeedforwardTick& tick, const double* measured) {
        const int n = observer.hinges;
        const bool first = !begun();
        if (first) begin(tick);
        update_inputs(tick);
        if (!first) {
            for (int i = 0; i < n; ++i) deviation[i] = measured[i] - before[i];
            observe(observer, inputs.data(), deviation.data(), estimate.data());
        }
        before.assign(tick.angles, tick.angles + n);
        return first ? tick.goals : estimate.data() + size_t(observer.rows() - 1) * n;
    }

  private:
    void begin(const FeedforwardTick& tick) {
        const int n = observer.hinges;
        estimate.assign(size_t(observer.rows()) * n, 0.0);
        inputs.resize(size_t(INPUTS) * n);
        deviation.resize(n);
        learned.assign(n, 0.0);
        for (int part = 0; part < 2; ++part) {
            const double* now = part ? tick.leads : tick.loads;
            noticed[part].assign(now, now + n);
            earlier.resize(2 * size_t(observer.late + 1) * n);
            for (int k = 0; k <= observer.late; ++k) std::copy_n(now, n, earlier_offsets(part, k));
        }
    }

    // Offsets of `ticks` + 1 ticks ago; initially those of the first tick.
    double* earlier_offsets(int part, int ticks) {
        return earlier.data() + (size_t(part) * (observer.late + 1) + ticks) * observer.hinges;
    }

    void update_inputs(const FeedforwardTick& tick) {
        const int n = observer.hinges, late = observer.late;
        const double* now[2] = {tick.loads, tick.leads};
        const double forgotten = settings.forgotten;
        for (int part = 0; part < 2; ++part) {
            for (int i = 0; i < n; ++i) {
                double acting = 0.0;
                for (int j = 0; j < late; ++j) acting += observer.arrival[j] * earlier_offsets(part, j + 1)[i];
                smooth(acting, settings.noticed, noticed[part][i]);
            }
            std::copy_backward(earlier_offsets(part, 0), earlier_offsets(part, late), earlier_offsets(part, late) + n);
            std::copy_n(now[part], n, earlier_offsets(part, 0));
        }
        const auto row = [&](int kind) { return inputs.data() + size_t(kind) * n; };
        for (int i = 0; i < n; ++i) {
            const double load = noticed[0][i], lead = noticed[1][i], goal = tick.goals[i];
            smooth(load * load + lead * lead, forgotten, learned[i]);
            const double trust = settings.clear + learned[i] / forgotten;
            row(ANGLE)[i] = tick.angles[i];
            row(SETPOINT)[i] = goal;
            row(LOWER_LIMIT)[i] = std::max(settings.lower[i], goal - settings.largest);
            row(UPPER_LIMIT)[i] = std::min(settings.upper[i], goal + settings.largest);
            row(LOAD)[i] = now[0][i];
            row(DETECTED_LOAD)[i] = load;
            row(LOAD_TRUST)[i] = load / trust;
            row(VELOCITY_OFFSET)[i] = now[1][i];
            row(DETECTED_VELOCITY_OFFSET)[i] = lead;
            row(VELOCITY_OFFSET_TRUST)[i] = lead / trust;
        }
    }

    // Moves a value by a fraction of the difference to another.
    static void smooth(double value, double fraction, double& smoothed) {
        smoothed = fraction * value + (1.0 - fraction) * smoothed;
    }

    const Observer observer;
    const CorrectionSettings settings;
    std::vector<double> estimate, inputs, deviation, before;  // rows of (n,) each
    std::vector<double> noticed[2], learned;                  // (n,)
    std::vector<double> earlier;                          // (2, late + 1, n) load and velocity offsets of the last ticks
};

}  // namespace kinesic::controller
