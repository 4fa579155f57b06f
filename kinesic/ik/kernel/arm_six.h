// Levenberg-Marquardt for place and orientation together, inside the ranges (kinesic/ik/box_lm.py with pose's rows).

#pragma once

#include "arm_orientation.h"

namespace kinesic::arm {

namespace six {

constexpr int ROWS = 6;
constexpr int ROUNDS = 40;
constexpr double TOLERANCE = 1e-7;  // arm lengths and rad together
constexpr double DAMPING = 0.1;     // lambda^2 = DAMPING e^2 + LEAST_DAMPING (after Sugihara)
constexpr double LEAST_DAMPING = 1e-9;
constexpr double POSTURE = 0.4;
constexpr double FADING = 0.7;
constexpr double STALL = 0.98;
constexpr int PATIENCE = 6;
constexpr double CAUTION = 8.0;

struct Misfit {  // wanted minus present: place in arm lengths, orientation in rad; and how the present moves
    double row[ROWS];
    double column[MOST_HINGES][ROWS];

    double size() const {
        double sum = 0.0;
        for (const double value : row) sum += value * value;
        return std::sqrt(sum);
    }
};

inline void measure(const Linkage& arm, const Vector& target, const Rotation& wanted, const double* angles,
                    Misfit& misfit) {
    Vector axis[MOST_HINGES], pole[MOST_HINGES], centre = arm.origin, hand;
    Rotation rotation;
    for (int j = 0; j < arm.links; ++j) {
        const Link& link = arm.link[j];
        for (int k = link.first; k < link.first + link.count; ++k) {
            axis[k] = rotated(rotation, arm.pivot[k].axis);
            pole[k] = centre;
            rotation = behind(rotation, arm.pivot[k], angles[k]);
        }
        hand = centre;
        centre = centre + rotated(rotation, link.bone);
    }
    const double scale = 1.0 / arm.farthest;
    for (int k = 0; k < arm.hinges; ++k) {
        const Vector moved = cross(axis[k], hand - pole[k]) * scale;
        const double column[ROWS] = {moved.x, moved.y, moved.z, axis[k].x, axis[k].y, axis[k].z};
        std::copy_n(column, ROWS, misfit.column[k]);
    }
    const Vector off = (target - hand) * scale, turn = shortest_turn(rotation, wanted);
    const double row[ROWS] = {off.x, off.y, off.z, turn.x, turn.y, turn.z};
    std::copy_n(row, ROWS, misfit.row);
}

// Solves the symmetric positive system by Cholesky's method, in place.
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

// One damped step dq = p + W J^T (J W J^T + lambda^2)^-1 (e - J p); solved again without what is stopped.
inline void stepped(const Linkage& arm, const double* angles, const Misfit& misfit, const double* pulls,
                    const double* mobility, double damping, double* result) {
    int free[MOST_HINGES], count = 0;
    double error[ROWS];
    std::copy_n(misfit.row, ROWS, error);
    for (int k = 0; k < arm.hinges; ++k) {
        result[k] = angles[k];
        if (mobility[k] > 0.0) free[count++] = k;
    }
    while (count > 0) {
        double matrix[ROWS][ROWS] = {}, push[ROWS], wanted[MOST_HINGES];
        std::copy_n(error, ROWS, push);
        for (int i = 0; i < count; ++i) {
            const double* c = misfit.column[free[i]];
            for (int a = 0; a < ROWS; ++a) {
                const double eased = c[a] * mobility[free[i]];
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
            wanted[k] = angles[k] + pulls[k] + mobility[k] * turn;
            stopped = stopped || arm.pivot[k].clipped(wanted[k]) != wanted[k];
        }
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const int k = free[i];
            const double held = arm.pivot[k].clipped(wanted[k]);
            if (stopped && held == wanted[k]) {
                free[kept++] = k;
                continue;
            }
            result[k] = held;
            for (int a = 0; a < ROWS; ++a) error[a] -= misfit.column[k][a] * (held - angles[k]);
        }
        count = kept;
    }
}

// Descends from the angles, in place, springs drawing to `home` what the pose leaves open; the rounds taken.
inline int descend(const Linkage& arm, const Vector& target, const Rotation& wanted, const double* home,
                   const double* mobility, double* angles) {
    Misfit buffers[2], *now = buffers, *spare = buffers + 1;
    measure(arm, target, wanted, angles, *now);
    double caution = 1.0, fading = 1.0, least = now->size();
    int rounds = 0;
    for (int stalled = 0; least > TOLERANCE && stalled < PATIENCE && rounds < ROUNDS;) {
        ++rounds;
        fading *= FADING;
        const double damping = caution * (DAMPING * least * least + LEAST_DAMPING);
        double pulls[MOST_HINGES], tried[MOST_HINGES];
        for (int k = 0; k < arm.hinges; ++k)
            pulls[k] = mobility[k] > 0.0 ? POSTURE * fading / caution * (home[k] - angles[k]) : 0.0;
        stepped(arm, angles, *now, pulls, mobility, damping, tried);
        measure(arm, target, wanted, tried, *spare);
        const double size = spare->size(), gain = size / least;
        stalled = gain > STALL ? stalled + 1 : 0;
        caution = gain >= 1.0 ? CAUTION * caution : std::max(1.0, caution / CAUTION);
        if (gain < 1.0) {
            std::copy_n(tried, arm.hinges, angles);
            std::swap(now, spare);
            least = size;
        }
    }
    return rounds;
}

}  // namespace six

}  // namespace kinesic::arm
