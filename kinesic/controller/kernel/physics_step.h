// One physics step of MuJoCo: mj_step, or its stages without those that build constraints and their matrix, which take a
// sixth of the step. MuJoCo is used through addresses only: no version of its headers is compiled in.
//
// Constraints are coupled by J M^-1 J^T + R (MuJoCo's documentation, chapter Computation). While only friction constrains
// the hinges, its rows and their softness R are constant, and the Jacobian J is the identity.

#pragma once

#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

namespace kinesic::controller {

using Stage = void (*)(void* model, void* data);
using Clock = double (*)();

inline std::atomic<double> moment = 0.0;  // time at which the clock is stopped

inline double stand_still() { return moment.load(std::memory_order_relaxed); }

// Factor M = L^T D L of n hinges, as MuJoCo computes it in each step: a row of L has entries only for the ancestors of its
// hinge (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 6.5).
struct FactoredInertia {
    const double *entries = nullptr, *inverse_d = nullptr;  // (c,) of L, row by row; (n,) 1 / D
    std::vector<int> begins, ends, columns;  // (n,) begin and diagonal position of each row; (c,) columns

    // Writes M^-1 (n, n). L M^-1 = D^-1 L^-T is zero left of its diagonal, which is D^-1: up to the diagonal, this gives
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
    std::vector<Stage> before, after;  // stages of mj_step up to and after the factorisation of the inertia
    FactoredInertia inertia;
    std::vector<double> lower, upper;   // (n,) [rad] range without contact with a stop
    const double* positions = nullptr;  // (n,) [rad] qpos
    const double* softness = nullptr;   // (n,) efc_R
    double* matrix = nullptr;           // (n, n) efc_AR
    bool ready = false;                 // whether the last constraint rows of MuJoCo are those of friction alone

    bool stops_act() const {
        for (size_t i = 0; i < lower.size(); ++i)
            if (!(positions[i] >= lower[i] && positions[i] <= upper[i])) return true;
        return false;
    }

    // Writes M^-1 + R, the coupling of the rows.
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
    Clock* clock = nullptr;  // clock by which MuJoCo times its stages, which takes a twentieth of a step; null: none
    std::optional<FrictionStep> friction;

    // Runs one step with MuJoCo's clock stopped.
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
