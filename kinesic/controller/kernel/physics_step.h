// One step of MuJoCo: its own mj_step, or the same stages without those that make constraints and their matrix, which are a
// sixth of it. MuJoCo is known by addresses alone: no version of its headers is built in.
//
// Constraints are coupled by J M^-1 J^T + R (MuJoCo's documentation, chapter Computation). Where only friction constrains
// the hinges, its rows and their softness R stay as they are, and the Jacobian J is the identity.

#pragma once

#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

namespace kinesic::controller {

using Stage = void (*)(void* model, void* data);
using Clock = double (*)();

inline std::atomic<double> moment = 0.0;  // at which the clock stands

inline double stand_still() { return moment.load(std::memory_order_relaxed); }

// M = L^T D L of n hinges, as MuJoCo factors it anew in each step: a row of L has entries only for the hinges that carry its
// own (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 6.5).
struct FactoredInertia {
    const double *entries = nullptr, *inverse_d = nullptr;  // (c,) of L, row by row; (n,) 1 / D
    std::vector<int> begins, ends, columns;  // (n,) where the entries of a row begin, and its diagonal; (c,) of the entries

    // Writes M^-1 (n, n). L M^-1 = D^-1 L^-T has nothing left of its diagonal, which is D^-1: up to the diagonal, this gives
    // each row of M^-1 from the rows above it (as Takahashi, Fagan and Chin, Formation of a sparse bus impedance matrix, 1973).
    void invert(double* inverse) const {
        const size_t n = begins.size();
        for (size_t i = 0; i < n; ++i) {
            double* row = inverse + i * n;
            std::fill_n(row, i, 0.0);
            for (int e = begins[i]; e < ends[i]; ++e) {
                const double *above = inverse + columns[e] * n, l = entries[e];
                for (size_t j = 0; j < i; ++j) row[j] -= l * above[j];
            }
            row[i] = inverse_d[i];
            for (int e = begins[i]; e < ends[i]; ++e) row[i] -= entries[e] * row[columns[e]];
            for (size_t j = 0; j < i; ++j) inverse[j * n + i] = row[j];
        }
    }
};

struct FrictionStep {
    std::vector<Stage> before, after;  // stages of mj_step, up to the factors of the inertia and from then on
    FactoredInertia inertia;
    std::vector<double> lower, upper;   // (n,) [rad] between which no stop acts
    const double* positions = nullptr;  // (n,) [rad] qpos
    const double* softness = nullptr;   // (n,) efc_R
    double* matrix = nullptr;           // (n, n) efc_AR
    bool ready = false;                 // whether the last rows that MuJoCo made are those of friction alone

    bool stops_act() const {
        for (size_t i = 0; i < lower.size(); ++i)
            if (!(positions[i] >= lower[i] && positions[i] <= upper[i])) return true;
        return false;
    }

    // Writes M^-1 + R, which couples the rows.
    void couple() const {
        inertia.invert(matrix);
        for (size_t i = 0, n = lower.size(); i < n; ++i) matrix[i * n + i] += softness[i];
    }

    void advance(void* model, void* data) const {
        for (const Stage stage : before) stage(model, data);
        couple();
        for (const Stage stage : after) stage(model, data);
    }
};

struct PhysicsStep {
    Stage whole = nullptr;  // mj_step
    void *model = nullptr, *data = nullptr;
    Clock* clock = nullptr;  // by which MuJoCo times its stages, which takes a twentieth of a step; null: there is none
    std::optional<FrictionStep> friction;

    // Does one step; MuJoCo's clock stands meanwhile.
    void advance() {
        const Clock ticking = clock ? *clock : nullptr;
        if (ticking) {
            moment.store(ticking(), std::memory_order_relaxed);  // for other threads, which measure their own steps
            *clock = stand_still;
        }
        const bool free = friction && !friction->stops_act();
        if (free && friction->ready)
            friction->advance(model, data);
        else
            whole(model, data);
        if (friction) friction->ready = free;
        if (ticking) *clock = ticking;
    }
};

}  // namespace kinesic::controller
