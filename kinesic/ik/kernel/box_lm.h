// Levenberg-Marquardt with bounds for six residuals (kinesic/ik/box_lm.py): a variable that reaches its bound stays there.

#pragma once

#include <algorithm>
#include <cmath>

namespace kinesic::box {

constexpr int ROWS = 6;
constexpr int ROUNDS = 40;
constexpr double DAMPING = 0.1;  // lambda^2 = DAMPING e^2 + LEAST_DAMPING (after Sugihara)
constexpr double LEAST_DAMPING = 1e-9;
constexpr double POSTURE = 0.4;
constexpr double FADING = 0.7;
constexpr double STALL = 0.98;
constexpr int PATIENCE = 6;
constexpr double CAUTION = 8.0;

template <int Most>
struct Misfit {  // desired minus present value, in units of order one, and the derivative by each variable
    double row[ROWS];
    double column[Most][ROWS];

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
inline void resolve(double matrix[ROWS][ROWS], double* right) {
    for (int j = 0; j < ROWS; ++j) {
        for (int i = 0; i <= j; ++i) {
            double sum = matrix[j][i];
            for (int k = 0; k < i; ++k) sum -= matrix[j][k] * matrix[i][k];
            matrix[j][i] = i < j ? sum / matrix[i][i] : std::sqrt(sum);
        }
        for (int k = 0; k < j; ++k) right[j] -= matrix[j][k] * right[k];
        right[j] /= matrix[j][j];
    }
    for (int j = ROWS - 1; j >= 0; --j) {
        for (int k = j + 1; k < ROWS; ++k) right[j] -= matrix[k][j] * right[k];
        right[j] /= matrix[j][j];
    }
}

// Takes one damped step dq = p + W J^T (J W J^T + lambda^2)^-1 (e - J p); repeats it without limited variables.
template <int Most>
void step(const Box& box, const double* now, const Misfit<Most>& misfit, const double* pulls, double damping,
          double* result) {
    int free[Most], count = 0;
    double error[ROWS];
    std::copy_n(misfit.row, ROWS, error);
    for (int k = 0; k < box.count; ++k) {
        result[k] = now[k];
        if (box.mobility[k] > 0.0) free[count++] = k;
    }
    while (count > 0) {
        double matrix[ROWS][ROWS] = {}, push[ROWS], wanted[Most];
        std::copy_n(error, ROWS, push);
        for (int i = 0; i < count; ++i) {
            const double* c = misfit.column[free[i]];
            for (int a = 0; a < ROWS; ++a) {
                const double eased = c[a] * box.mobility[free[i]];
                for (int b = 0; b <= a; ++b) matrix[a][b] += eased * c[b];
                push[a] -= c[a] * pulls[free[i]];
            }
        }
        for (int a = 0; a < ROWS; ++a) matrix[a][a] += damping;
        resolve(matrix, push);
        bool stopped = false;
        for (int i = 0; i < count; ++i) {
            const int k = free[i];
            double turn = 0.0;
            for (int a = 0; a < ROWS; ++a) turn += misfit.column[k][a] * push[a];
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
            for (int a = 0; a < ROWS; ++a) error[a] -= misfit.column[k][a] * (held - now[k]);
        }
        count = kept;
    }
}

// Minimises the residuals from the variables' values, in place; `measure(now, misfit)` computes them.
template <int Most, typename Measure>
Descent descend(const Box& box, const Measure& measure, double tolerance, double* now) {
    Misfit<Most> buffers[2], *here = buffers, *spare = buffers + 1;
    measure(now, *here);
    double caution = 1.0, fading = 1.0;
    Descent descent;
    descent.miss = here->size();
    for (int stalled = 0; descent.miss > tolerance && stalled < PATIENCE && descent.rounds < ROUNDS;) {
        ++descent.rounds;
        fading *= FADING;
        const double damping = caution * (DAMPING * descent.miss * descent.miss + LEAST_DAMPING);
        double pulls[Most], tried[Most];
        for (int k = 0; k < box.count; ++k)
            pulls[k] = box.mobility[k] > 0.0 ? POSTURE * fading / caution * (box.home[k] - now[k]) : 0.0;
        step(box, now, *here, pulls, damping, tried);
        measure(tried, *spare);
        const double size = spare->size(), gain = size / descent.miss;
        stalled = gain > STALL ? stalled + 1 : 0;
        caution = gain >= 1.0 ? CAUTION * caution : std::max(1.0, caution / CAUTION);
        if (gain < 1.0) {
            std::copy_n(tried, box.count, now);
            std::swap(here, spare);
            descent.miss = size;
        }
    }
    return descent;
}

}  // namespace kinesic::box
