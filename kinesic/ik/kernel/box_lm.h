// Levenberg-Marquardt with bounds for six residuals (kinesic/ik/box_lm.py). A variable at its bound is fixed for the step.

#pragma once

#include <algorithm>
#include <cmath>

namespace kinesic::box {

constexpr int RESIDUAL_COUNT = 6;
constexpr int MAX_ITERATIONS = 40;
constexpr double ERROR_DAMPING = 0.1;   // lambda^2 = ERROR_DAMPING e^2 + MIN_DAMPING (after Sugihara)
constexpr double MIN_DAMPING = 1e-9;
constexpr double POSTURE_GAIN = 0.4;    // fraction of the distance to preferred values per iteration
constexpr double POSTURE_DECAY = 0.7;   // factor on `POSTURE_GAIN` per iteration, from the first on
constexpr double STALL_RATIO = 0.98;    // error ratio of successive iterations above which progress has stalled
constexpr int MAX_STALLED_STEPS = 6;    // successive stalled iterations that end the solver
constexpr double DAMPING_GROWTH = 8.0;  // factor on the damping after a rejected step, divisor after an accepted one

template <int Most>
struct Residuals {  // desired minus present value, in units of order one, and the derivative by each variable
    double row[RESIDUAL_COUNT];
    double column[Most][RESIDUAL_COUNT];

    double size() const {
        double sum = 0.0;
        for (const double value : row) sum += value * value;
        return std::sqrt(sum);
    }
};

struct Box {  // ranges and mobilities of the variables
    int count;
    const double *lower, *upper, *home, *mobility;

    double clipped(int k, double value) const {
        return value < lower[k] ? lower[k] : value > upper[k] ? upper[k] : value;
    }
};

struct Descent {
    int rounds = 0;
    double miss = 0.0;
};

// Solves a symmetric positive definite system by Cholesky's method, in place.
inline void solve_cholesky(double matrix[RESIDUAL_COUNT][RESIDUAL_COUNT], double* right) {
    for (int j = 0; j < RESIDUAL_COUNT; ++j) {
        for (int i = 0; i <= j; ++i) {
            double sum = matrix[j][i];
            for (int k = 0; k < i; ++k) sum -= matrix[j][k] * matrix[i][k];
            matrix[j][i] = i < j ? sum / matrix[i][i] : std::sqrt(sum);
        }
        for (int k = 0; k < j; ++k) right[j] -= matrix[j][k] * right[k];
        right[j] /= matrix[j][j];
    }
    for (int j = RESIDUAL_COUNT - 1; j >= 0; --j) {
        for (int k = j + 1; k < RESIDUAL_COUNT; ++k) right[j] -= matrix[k][j] * right[k];
        right[j] /= matrix[j][j];
    }
}

// Takes one damped step dq = p + W J^T (J W J^T + lambda^2)^-1 (e - J p); repeats it without variables at a bound.
template <int Most>
void step(const Box& box, const double* now, const Residuals<Most>& residuals, const double* pulls, double damping,
          double* result) {
    int free[Most], count = 0;
    double error[RESIDUAL_COUNT];
    std::copy_n(residuals.row, RESIDUAL_COUNT, error);
    for (int k = 0; k < box.count; ++k) {
        result[k] = now[k];
        if (box.mobility[k] > 0.0) free[count++] = k;
    }
    while (count > 0) {
        double matrix[RESIDUAL_COUNT][RESIDUAL_COUNT] = {}, push[RESIDUAL_COUNT], wanted[Most];
        std::copy_n(error, RESIDUAL_COUNT, push);
        for (int i = 0; i < count; ++i) {
            const double* c = residuals.column[free[i]];
            for (int a = 0; a < RESIDUAL_COUNT; ++a) {
                const double weighted = c[a] * box.mobility[free[i]];
                for (int b = 0; b <= a; ++b) matrix[a][b] += weighted * c[b];
                push[a] -= c[a] * pulls[free[i]];
            }
        }
        for (int a = 0; a < RESIDUAL_COUNT; ++a) matrix[a][a] += damping;
        solve_cholesky(matrix, push);
        bool stopped = false;
        for (int i = 0; i < count; ++i) {
            const int k = free[i];
            double turn = 0.0;
            for (int a = 0; a < RESIDUAL_COUNT; ++a) turn += residuals.column[k][a] * push[a];
            wanted[k] = now[k] + pulls[k] + box.mobility[k] * turn;
            stopped = stopped || box.clipped(k, wanted[k]) != wanted[k];
        }
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const int k = free[i];
            const double held = box.clipped(k, wanted[k]);
            if (stopped && held == wanted[k]) {
                free[kept++] = k;
                continue;
            }
            result[k] = held;
            for (int a = 0; a < RESIDUAL_COUNT; ++a) error[a] -= residuals.column[k][a] * (held - now[k]);
        }
        count = kept;
    }
}

// Minimises the residuals from the variables' values, in place; `measure(now, residuals)` computes them.
template <int Most, typename Measure>
Descent descend(const Box& box, const Measure& measure, double tolerance, double* now) {
    Residuals<Most> buffers[2], *here = buffers, *spare = buffers + 1;
    measure(now, *here);
    double damping_factor = 1.0, posture_decay = 1.0;
    Descent descent;
    descent.miss = here->size();
    for (int stalled = 0; descent.miss > tolerance && stalled < MAX_STALLED_STEPS && descent.rounds < MAX_ITERATIONS;) {
        ++descent.rounds;
        posture_decay *= POSTURE_DECAY;
        const double damping = damping_factor * (ERROR_DAMPING * descent.miss * descent.miss + MIN_DAMPING);
        double pulls[Most], tried[Most];
        for (int k = 0; k < box.count; ++k)
            pulls[k] = box.mobility[k] > 0.0 ? POSTURE_GAIN * posture_decay / damping_factor * (box.home[k] - now[k]) : 0.0;
        step(box, now, *here, pulls, damping, tried);
        measure(tried, *spare);
        const double size = spare->size(), gain = size / descent.miss;
        stalled = gain > STALL_RATIO ? stalled + 1 : 0;
        damping_factor = gain >= 1.0 ? DAMPING_GROWTH * damping_factor : std::max(1.0, damping_factor / DAMPING_GROWTH);
        if (gain < 1.0) {
            std::copy_n(tried, box.count, now);
            std::swap(here, spare);
            descent.miss = size;
        }
    }
    return descent;
}

}  // namespace kinesic::box
