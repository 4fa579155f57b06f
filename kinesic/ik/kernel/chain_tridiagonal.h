// The same springs, all relaxed at once: their equations couple only neighbours, so one solve costs O(n).
//
// Algorithm, after the position-based dynamics of Macklin, Mueller, Chentanez, "XPBD" (2016), solved directly:
//   with d_j the direction of bone j and C_j its stretch, repeat
//     (A A^T + c I) lambda = C          A A^T: diagonal = number of free bone ends, off-diagonal -d_j . d_{j+1}
//     x_i <- x_i + lambda_i d_i - lambda_{i-1} d_{i-1}
// by the elimination of L. H. Thomas (1949).

#pragma once

#include "chain_state.h"

namespace kinesic::chains {

constexpr double COMPLIANCE = 1e-3;  // c: keeps a chain on one line solvable

// Solves the symmetric tridiagonal system in place; `right` becomes the solution.
inline void thomas(int size, double* diagonal, const double* beside, double* right) {
    for (int j = 1; j < size; ++j) {
        const double share = beside[j - 1] / diagonal[j - 1];
        diagonal[j] -= share * beside[j - 1];
        right[j] -= share * right[j - 1];
    }
    right[size - 1] /= diagonal[size - 1];
    for (int j = size - 2; j >= 0; --j) right[j] = (right[j] - beside[j] * right[j + 1]) / diagonal[j];
}

inline int tridiagonal(const Chain& chain, const Goal& goal, Posture& posture) {
    const int n = chain.bones;
    Vector along[MAX_BONES];
    double diagonal[MAX_BONES], beside[MAX_BONES], stretches[MAX_BONES];
    Vector* points = posture.points;
    points[n] = goal.target;
    int k = 0;
    for (;; ++k) {
        Vector tip;
        for (int j = 0; j < n; ++j) {
            const Vector bone = points[j + 1] - points[j];
            const double length = norm(bone);
            along[j] = length > 0.0 ? bone * (1.0 / length) : chain.along[j];
            stretches[j] = length - chain.lengths[j];
            tip = tip + along[j] * chain.lengths[j];
            diagonal[j] = COMPLIANCE + (j > 0) + (j < n - 1);
            if (j > 0) beside[j - 1] = -dot(along[j - 1], along[j]);
        }
        if (distance(tip, goal.target) <= goal.tolerance || k >= goal.max_iterations) break;
        thomas(n, diagonal, beside, stretches);
        for (int i = 1; i < n; ++i) points[i] = points[i] + along[i] * stretches[i] - along[i - 1] * stretches[i - 1];
    }
    aim(chain, posture);
    return k;
}

}  // namespace kinesic::chains
