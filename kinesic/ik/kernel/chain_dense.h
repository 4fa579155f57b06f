// Jacobian methods with general dense algebra, as Table 7.1 of the thesis compares them.

#pragma once

#include "chain_jacobian.h"
#include "chain_svd.h"

namespace kinesic::chains {

constexpr int MAX_COLUMNS = 3 * MAX_BONES;
constexpr double MIN_SINGULAR_RATIO = 1e-6;  // smallest used singular value / largest one

// J^T, column by column: row 3 i + a of column b is the tip's velocity along axis b per rotation of joint i about axis a.
inline void transposed_jacobian(const Chain& chain, const Posture& posture, double* columns) {
    const int rows = 3 * chain.bones;
    const Vector tip = posture.points[chain.bones];
    for (int i = 0; i < chain.bones; ++i) {
        const Vector r = tip - posture.points[i];
        const Vector moved[3] = {cross(r, {1.0, 0.0, 0.0}), cross(r, {0.0, 1.0, 0.0}), cross(r, {0.0, 0.0, 1.0})};
        for (int b = 0; b < 3; ++b) {
            columns[b * rows + 3 * i] = moved[b].x;
            columns[b * rows + 3 * i + 1] = moved[b].y;
            columns[b * rows + 3 * i + 2] = moved[b].z;
        }
    }
}

// Rotates the joints by (3n,) rotation vectors [rad].
inline void step(const Chain& chain, const double* thetas, Posture& posture) {
    Vector omegas[MAX_BONES];
    for (int i = 0; i < chain.bones; ++i) omegas[i] = {thetas[3 * i], thetas[3 * i + 1], thetas[3 * i + 2]};
    step(chain, omegas, posture);
}

// Repeats `find(J^T, e, dtheta)` and steps until the tip reaches the target.
template <typename Find>
int descend_dense(const Chain& chain, const Goal& goal, Posture& posture, Find find) {
    double columns[3 * MAX_COLUMNS], thetas[MAX_COLUMNS];
    int k = 0;
    while (residual(chain, goal, posture) > goal.tolerance && k < goal.max_iterations) {
        const Vector e = error(chain, goal, posture);
        transposed_jacobian(chain, posture, columns);
        find(columns, e, thetas);
        step(chain, thetas, posture);
        ++k;
    }
    return k;
}

// Solves the symmetric positive system in place by Cholesky's method; `right` becomes the solution.
inline void cholesky(int size, double* matrix, double* right) {
    for (int j = 0; j < size; ++j) {
        double* row = matrix + j * size;
        for (int i = 0; i < j; ++i) {
            const double* above = matrix + i * size;
            double sum = row[i];
            for (int k = 0; k < i; ++k) sum -= row[k] * above[k];
            row[i] = sum / above[i];
        }
        double sum = row[j];
        for (int k = 0; k < j; ++k) sum -= row[k] * row[k];
        row[j] = std::sqrt(sum);
        for (int k = 0; k < j; ++k) right[j] -= row[k] * right[k];
        right[j] /= row[j];
    }
    for (int j = size - 1; j >= 0; --j) {
        right[j] /= matrix[j * size + j];
        for (int k = 0; k < j; ++k) right[k] -= matrix[j * size + k] * right[j];
    }
}

// (J^T J + lambda^2 I)^-1 J^T e with the 3n x 3n matrix.
inline int damped_dense(const Chain& chain, const Goal& goal, Posture& posture) {
    const int size = 3 * chain.bones;
    double matrix[MAX_COLUMNS * MAX_COLUMNS];
    return descend_dense(chain, goal, posture, [&](const double* columns, const Vector& e, double* thetas) {
        const double *x = columns, *y = columns + size, *z = columns + 2 * size;
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i <= j; ++i) matrix[j * size + i] = x[i] * x[j] + y[i] * y[j] + z[i] * z[j];
            matrix[j * size + j] += DAMPING_LAMBDA * DAMPING_LAMBDA;
            thetas[j] = x[j] * e.x + y[j] * e.y + z[j] * e.z;
        }
        cholesky(size, matrix, thetas);
    });
}

// V Sigma^+ U^T e with J^T = V Sigma U^T from a general singular value decomposition.
inline int pseudo_inverse_svd(const Chain& chain, const Goal& goal, Posture& posture) {
    const int size = 3 * chain.bones;
    return descend_dense(chain, goal, posture, [&](double* columns, const Vector& e, double* thetas) {
        double u[9], sigma[3];
        svd(size, 3, columns, sigma, u);
        const double least = MIN_SINGULAR_RATIO * std::fmax(sigma[0], std::fmax(sigma[1], sigma[2]));
        for (int j = 0; j < size; ++j) thetas[j] = 0.0;
        for (int s = 0; s < 3; ++s) {
            if (sigma[s] <= least) continue;
            const double gain = (u[3 * s] * e.x + u[3 * s + 1] * e.y + u[3 * s + 2] * e.z) / sigma[s];
            for (int j = 0; j < size; ++j) thetas[j] += gain * columns[s * size + j];
        }
    });
}

// Scales the values so that no magnitude exceeds a bound.
inline void clamp_largest(int size, double bound, double* values) {
    double most = 0.0;
    for (int j = 0; j < size; ++j) most = std::fmax(most, std::abs(values[j]));
    if (most <= bound) return;
    for (int j = 0; j < size; ++j) values[j] *= bound / most;
}

// Selectively damped least squares (S. R. Buss, J.-S. Kim 2005): each singular direction has a bound of its own,
//   alpha = u . e;  N = |u| = 1;  M = (1 / sigma) sum_j |v_j| rho_j, rho_j = tip displacement per radian of joint j
//   gamma = min(1, N / M) gamma_max;  phi = clamp(alpha / sigma v, gamma);  dtheta = clamp(sum phi, gamma_max).
inline int selectively_damped(const Chain& chain, const Goal& goal, Posture& posture) {
    const int size = 3 * chain.bones;
    return descend_dense(chain, goal, posture, [&](double* columns, const Vector&, double* thetas) {
        const Vector e = goal.target - posture.points[chain.bones];
        double u[9], sigma[3], rho[MAX_COLUMNS], phi[MAX_COLUMNS];
        for (int j = 0; j < size; ++j) {
            rho[j] = norm(Vector{columns[j], columns[size + j], columns[2 * size + j]});
            thetas[j] = 0.0;
        }
        svd(size, 3, columns, sigma, u);
        const double least = MIN_SINGULAR_RATIO * std::fmax(sigma[0], std::fmax(sigma[1], sigma[2]));
        for (int s = 0; s < 3; ++s) {
            if (sigma[s] <= least) continue;
            const double* v = columns + s * size;
            const double gain = (u[3 * s] * e.x + u[3 * s + 1] * e.y + u[3 * s + 2] * e.z) / sigma[s];
            double m = 0.0;
            for (int j = 0; j < size; ++j) {
                m += std::abs(v[j]) * rho[j];
                phi[j] = gain * v[j];
            }
            clamp_largest(size, std::fmin(1.0, sigma[s] / m) * MAX_ROTATION, phi);
            for (int j = 0; j < size; ++j) thetas[j] += phi[j];
        }
        clamp_largest(size, MAX_ROTATION, thetas);
    });
}

}  // namespace kinesic::chains
