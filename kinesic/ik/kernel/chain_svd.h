// A general singular value decomposition of a small tall matrix, by one-sided Jacobi rotations.
//
// Algorithm (M. R. Hestenes 1958; the rotation as in J. Demmel, K. Veselic 1992): pairs of columns are rotated until
// all are orthogonal; their lengths are the singular values, the product of the rotations the right singular vectors.

#pragma once

#include <cmath>

namespace kinesic::chains {

constexpr int MAX_SWEEPS = 30;
constexpr double ORTHOGONAL_COSINE = 1e-14;  // cosine between columns that counts as zero

// A = V Sigma U^T. `a` holds A column by column and becomes V; `u` gets U column by column, columns x columns.
inline void svd(int rows, int columns, double* a, double* sigma, double* u) {
    for (int p = 0; p < columns * columns; ++p) u[p] = p % (columns + 1) == 0 ? 1.0 : 0.0;
    const auto rotate = [](int size, double c, double s, double* p, double* q) {
        for (int k = 0; k < size; ++k) {
            const double old = p[k];
            p[k] = c * old - s * q[k];
            q[k] = s * old + c * q[k];
        }
    };
    bool moved = true;
    for (int sweep = 0; moved && sweep < MAX_SWEEPS; ++sweep) {
        moved = false;
        for (int p = 0; p < columns - 1; ++p) {
            for (int q = p + 1; q < columns; ++q) {
                double *first = a + p * rows, *second = a + q * rows;
                double alpha = 0.0, beta = 0.0, gamma = 0.0;
                for (int k = 0; k < rows; ++k) {
                    alpha += first[k] * first[k];
                    beta += second[k] * second[k];
                    gamma += first[k] * second[k];
                }
                if (std::abs(gamma) <= ORTHOGONAL_COSINE * std::sqrt(alpha * beta)) continue;
                moved = true;
                const double zeta = (beta - alpha) / (2.0 * gamma);
                const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1.0 + zeta * zeta));
                const double c = 1.0 / std::sqrt(1.0 + t * t);
                rotate(rows, c, c * t, first, second);
                rotate(columns, c, c * t, u + p * columns, u + q * columns);
            }
        }
    }
    for (int p = 0; p < columns; ++p) {
        double* column = a + p * rows;
        double square = 0.0;
        for (int k = 0; k < rows; ++k) square += column[k] * column[k];
        sigma[p] = std::sqrt(square);
        for (int k = 0; k < rows && square > 0.0; ++k) column[k] /= sigma[p];
    }
}

}  // namespace kinesic::chains
