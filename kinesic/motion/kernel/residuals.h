// Residuals of the optimality conditions at slacks t > 0 and multipliers z > 0 of the inequalities G (x, s) + t = h:
//
//   H x - pull + A' y + G' z = 0,   A x = values,   G (x, s) + t = h

#pragma once

#include "inequalities.h"
#include "lanes.h"

namespace kinesic::motion {

struct Residuals {
    explicit Residuals(const SplineProgram& program, const Inequalities& limits)
        : conditions(program.size, program.fixed()), inequalities(limits.count()), p(program), limits(limits) {}

    void measure(const Unknowns& at, double s, const std::vector<double>& t, const std::vector<double>& z) {
        conditions.clear();
        relaxation = limits.transpose(z, conditions.points) + (p.relaxing ? 1.0 : 0.0);
        largest_tie_multiplier = primal = 0.0;
        for (int k = 0; k < p.fixed(); ++k) {
            double lacking = -p.values[k];
            for (int d = 0; d < 4; ++d) {
                conditions.points[p.first[k] + d] += p.shares[4 * k + d] * at.ties[k];
                lacking += p.shares[4 * k + d] * at.points[p.first[k] + d];
            }
            conditions.ties[k] = lacking;
            primal = std::max(primal, std::abs(lacking));
            largest_tie_multiplier = std::max(largest_tie_multiplier, std::abs(at.ties[k]));
        }
        if (!p.relaxing) {
            impossible = contradicts(at.ties, z);
            add_form(at.points);
        }
        limits.apply(at.points, s, inequalities);
        double* left = inequalities.data();
        const double *slacks = t.data(), *bounds = limits.bounds().data(), *points = conditions.points.data();
        const int count = limits.count();
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) left[q] += slacks[q] - bounds[q];
        primal = std::max(primal, largest_of(count, [=](int q) { return std::abs(left[q]); }));
        dual = std::max(std::abs(relaxation), largest_of(p.size, [=](int j) { return std::abs(points[j]); }));
    }

    Unknowns conditions;  // residuals of x and y
    std::vector<double> inequalities;
    double relaxation = 0.0;  // residual of s
    double primal = 0.0, dual = 0.0;  // largest residuals of equations and inequalities, and of x and s
    double largest_tie_multiplier = 0.0;
    bool impossible = false;  // whether the multipliers prove that no motion is within all limits

  private:
    // Farkas' lemma (1902): for every x within all limits,
    // 0 <= z' (h - G x) + y' (values - A x) = z' h + y' values - (G' z + A' y)' x, and x lies between lower and upper.
    bool contradicts(const std::vector<double>& y, const std::vector<double>& z) const {
        const double *bounds = limits.bounds().data(), *multipliers = z.data();
        double most = sum_of(limits.count(), [=](int q) { return bounds[q] * multipliers[q]; });
        for (int k = 0; k < p.fixed(); ++k) most += p.values[k] * y[k];
        for (int j = 0; j < p.size; ++j)
            most += std::abs(conditions.points[j]) * std::max(std::abs(p.lower[j]), std::abs(p.upper[j]));
        return most < 0.0;
    }

    // Adds H x - pull to the residual.
    void add_form(const std::vector<double>& points) {
        const int n = p.size, half = int(p.form.size()) / n - 1;
        const double *x = points.data(), *diagonal = p.form.data() + size_t(half) * n;
        double* sums = conditions.points.data();
        for (int j = 0; j < n; ++j) sums[j] += diagonal[j] * x[j] - p.pull[j];
        for (int d = 1; d <= half; ++d) {
            const double* beside = diagonal - size_t(d) * n;
            for (int j = d; j < n; ++j) sums[j] += beside[j] * x[j - d];
            for (int j = d; j < n; ++j) sums[j - d] += beside[j] * x[j];
        }
    }

    const SplineProgram& p;
    const Inequalities& limits;
};

}  // namespace kinesic::motion
