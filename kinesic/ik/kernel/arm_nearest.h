// Posture nearest to a target beyond reach, by projected Newton steps (tests/reference/ik/nearest.py).

#pragma once

#include "arm_polish.h"
#include "arm_solve.h"

namespace kinesic::arm {

namespace nearing {

constexpr int MAX_ITERATIONS = 30;
constexpr double MIN_GAIN = 1e-9;           // relative decrease of the squared distance below which the search ends
constexpr double MIN_DAMPING = 1e-6;        // [arm lengths^2] added to the curvature
constexpr double MAX_DAMPING = 1e6;         // [arm lengths^2] damping above which the search ends
constexpr double MIN_IMPROVEMENT = 2.5e-3;  // [arm lengths] smallest gain for which the elbow may change its side
constexpr double DAMPING_GROWTH = 8.0;      // factor on the damping after a rejected step, divisor after an accepted one
constexpr int MAX_SWEEPS = 30;              // largest number of Jacobi sweeps

using Matrix = double[MAX_HINGES][MAX_HINGES];

struct Shape {  // half the squared distance, to second order around a posture
    double distance;            // [m]
    double slope[MAX_HINGES];  // [m^2/rad]
    Matrix curvature;           // [m^2/rad^2]
};

inline void measure(const Linkage& arm, const Vector& target, const double* angles, Shape& shape) {
    Vector axis[MAX_HINGES], pole[MAX_HINGES], column[MAX_HINGES];
    const Vector centre = walked(arm, angles, axis, pole);
    const Vector error = target - centre;
    shape.distance = norm(error);
    for (int j = 0; j < arm.own(); ++j) {
        column[j] = cross(axis[j], centre - pole[j]);
        shape.slope[j] = -dot(error, column[j]);
        for (int i = 0; i <= j; ++i)
            shape.curvature[i][j] = shape.curvature[j][i] =
                dot(column[i], column[j]) - dot(error, cross(axis[i], column[j]));
    }
}

// Lowest eigenvalue of a symmetric matrix, by Jacobi rotations.
inline double lowest(const Matrix& given, int size) {
    Matrix m;
    for (int i = 0; i < size; ++i) std::copy_n(given[i], size, m[i]);
    for (int sweep = 0; sweep < MAX_SWEEPS; ++sweep) {
        double off = 0.0, on = 0.0;
        for (int i = 0; i < size; ++i) {
            on += m[i][i] * m[i][i];
            for (int j = 0; j < i; ++j) off += m[i][j] * m[i][j];
        }
        if (off <= 1e-32 * on) break;
        for (int p = 0; p < size; ++p)
            for (int q = p + 1; q < size; ++q) {
                if (m[p][q] == 0.0) continue;
                const double theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
                const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
                for (int k = 0; k < size; ++k) {
                    const double a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - s * b, m[k][q] = s * a + c * b;
                }
                for (int k = 0; k < size; ++k) {
                    const double a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
                }
            }
    }
    double least = size > 0 ? m[0][0] : 0.0;
    for (int i = 1; i < size; ++i) least = std::min(least, m[i][i]);
    return least;
}

// Cholesky factor of a symmetric matrix with a constant added to its diagonal; false if not positive definite.
inline bool factored(const Matrix& given, int size, double raised, Matrix& lower) {
    for (int j = 0; j < size; ++j)
        for (int i = 0; i <= j; ++i) {
            double sum = given[j][i] + (i == j ? raised : 0.0);
            for (int k = 0; k < i; ++k) sum -= lower[j][k] * lower[i][k];
            if (i == j && !(sum > 0.0)) return false;
            lower[j][i] = i == j ? std::sqrt(sum) : sum / lower[i][i];
        }
    return true;
}

// Newton step to zero slope; near a saddle the curvature is increased until it is positive.
inline void newton(const double* slope, const Matrix& curvature, int size, double damping, double* step) {
    Matrix lower;
    if (!factored(curvature, size, 0.0, lower)) damping += std::max(0.0, -2.0 * lowest(curvature, size));
    factored(curvature, size, damping, lower);
    for (int j = 0; j < size; ++j) {
        step[j] = -slope[j];
        for (int k = 0; k < j; ++k) step[j] -= lower[j][k] * step[k];
        step[j] /= lower[j][j];
    }
    for (int j = size - 1; j >= 0; --j) {
        for (int k = j + 1; k < size; ++k) step[j] -= lower[k][j] * step[k];
        step[j] /= lower[j][j];
    }
}

// Moves the hinges that are not at their limits by one step; returns whether any moved.
inline bool stepped(const Linkage& arm, const double* now, const Shape& here, double damping, double* tried) {
    int free[MAX_HINGES], count = 0;
    Matrix curvature;
    double slope[MAX_HINGES], step[MAX_HINGES];
    for (int k = 0; k < arm.own(); ++k) {
        const Pivot& pivot = arm.pivot[k];
        tried[k] = now[k];
        if ((now[k] > pivot.lower || here.slope[k] < 0.0) && (now[k] < pivot.upper || here.slope[k] > 0.0))
            free[count++] = k;
    }
    for (int i = 0; i < count; ++i) {
        slope[i] = here.slope[free[i]];
        for (int j = 0; j < count; ++j) curvature[i][j] = here.curvature[free[i]][free[j]];
    }
    newton(slope, curvature, count, damping * (arm.farthest * arm.farthest), step);
    bool moved = false;
    for (int i = 0; i < count; ++i) {
        const int k = free[i];
        tried[k] = arm.pivot[k].clipped(now[k] + step[i]);
        moved = moved || tried[k] != now[k];
    }
    return moved;
}

}  // namespace nearing

// Descends from the nearer of two postures; keeps the first one unless the gain exceeds MIN_IMPROVEMENT.
inline CorrectedPosture finish(const Linkage& arm, const Vector& target, const double* kept, const double* elsewhere) {
    using namespace nearing;
    const int n = arm.own();
    Shape shapes[3], *here = shapes, *there = shapes + 1;
    measure(arm, target, kept, shapes[0]);
    measure(arm, target, elsewhere, shapes[1]);
    const double first = shapes[0].distance;
    CorrectedPosture found;
    std::copy_n(shapes[1].distance < first ? elsewhere : kept, n, found.angles);
    if (shapes[1].distance < first) std::swap(here, there);
    for (double damping = MIN_DAMPING; found.rounds < MAX_ITERATIONS && damping < MAX_DAMPING;) {
        ++found.rounds;
        double tried[MAX_HINGES];
        const bool moved = stepped(arm, found.angles, *here, damping, tried);
        measure(arm, target, tried, *there);
        const double won = here->distance * here->distance - there->distance * there->distance;
        if (won <= 0.0 && moved) {
            damping *= DAMPING_GROWTH;
            continue;
        }
        std::copy_n(tried, n, found.angles);
        std::swap(here, there);
        damping = std::max(MIN_DAMPING, damping / DAMPING_GROWTH);
        if (won <= MIN_GAIN * (here->distance * here->distance)) break;
    }
    found.miss = here->distance;
    if (first - found.miss < MIN_IMPROVEMENT * arm.farthest) {
        std::copy_n(kept, n, found.angles);
        found.miss = first;
    }
    return found;
}

// Replaces the solution of an unreached target by the nearest posture if that is closer. The elbow's side was chosen for
// the clamped target; the requested target may be nearer on the other side.
[[gnu::cold, gnu::noinline]] inline void finish(const Linkage& arm, const Question& question, const double* rest,
                                                const double* mobility, Answer& answer) {
    const CorrectedPosture elsewhere = approach(arm, question.position, answer.angles, rest, mobility);
    const CorrectedPosture best = finish(arm, question.position, answer.angles, elsewhere.angles);
    if (std::equal(best.angles, best.angles + arm.own(), answer.angles)) return;
    std::copy_n(best.angles, arm.own(), answer.angles);
    Vector points[MAX_LINKS + 1];
    const Rotation frame = walk(arm, answer.angles, arm.links - 1, points);
    turn_hand(arm, frame, question.wishes, question.wish_count, question.home, answer.angles, answer.errors);
    answer.residual = distance(points[arm.links - 1], question.position);
    answer.iterations += best.rounds;
}

// Solves a target and, if it is not reached, approaches it as closely as possible.
inline Answer answer(const Linkage& arm, const Question& question, const double* rest, const double* mobility) {
    Answer found = solve(arm, question);
    if (found.residual > REACHED_DISTANCE) finish(arm, question, rest, mobility, found);
    return found;
}

}  // namespace kinesic::arm
