// Inequalities G (x, s) <= h of a spline program: both signs of each limit row, both bounds of each control point, and the
// lower bound of the relaxation s.

#pragma once

#include "spline_program.h"

namespace kinesic::motion {

class Inequalities {
  public:
    explicit Inequalities(const SplineProgram& program)
        : p(program), n(p.size), rows_(p.rows()), bounds_(2 * rows_ + 2 * n + (p.relaxing ? 1 : 0)), norms_(rows_),
          powers_(bounds_.size()) {
        p.each_kind([&](auto kind, int number) {
            double norm = 0.0;
            for (double share : p.stencils[kind]) norm += share * share;
            for (int row = p.begin(kind); row < p.end(kind); ++row, ++number) {
                bounds_[number] = bounds_[rows_ + number] = p.bound(kind, row);
                norms_[number] = norm;
                powers_[number] = powers_[rows_ + number] = POWERS[kind];
            }
        });
        for (int j = 0; j < n; ++j) {
            bounds_[2 * rows_ + j] = p.upper[j];
            bounds_[2 * rows_ + n + j] = -p.lower[j];
        }
        if (p.relaxing) {
            bounds_.back() = -p.easy;
            powers_.back() = 1.0;
        }
    }

    int rows() const { return rows_; }  // number of limit rows
    int count() const { return int(bounds_.size()); }
    const std::vector<double>& bounds() const { return bounds_; }  // h
    const std::vector<double>& powers() const { return powers_; }  // coefficient of s in each limit row
    double norm(int q) const { return q < 2 * rows_ ? norms_[q % rows_] : 1.0; }  // squared length of a row of G

    // Computes G (x, s).
    void apply(const std::vector<double>& points, double relaxation, std::vector<double>& into) const {
        p.each_kind([&](auto kind, int number) {
            const Stencil<kind> by(p);
            const double eased = p.relaxing ? POWERS[kind] * relaxation : 0.0;
            const double* __restrict x = points.data() + p.begin(kind);
            double* __restrict up = into.data() + number;
            double* __restrict down = up + rows_;
            for (int row = 0, count = p.count(kind); row < count; ++row) {
                const double along = by.along(x + row);
                up[row] = along - eased;
                down[row] = -along - eased;
            }
        });
        for (int j = 0; j < n; ++j) {
            into[2 * rows_ + j] = points[j];
            into[2 * rows_ + n + j] = -points[j];
        }
        if (p.relaxing) into.back() = -relaxation;
    }

    // Adds G' v to the control points, and returns its component of s.
    double transpose(const std::vector<double>& v, std::vector<double>& into) const {
        double part = p.relaxing ? -v.back() : 0.0;
        std::vector<double> differences(n);
        p.each_kind([&](auto kind, int number) {
            const int count = p.count(kind);
            const double* __restrict up = v.data() + number;
            const double* __restrict down = up + rows_;
            double* __restrict both = differences.data();
            for (int row = 0; row < count; ++row) both[row] = up[row] - down[row];
            Stencil<kind>(p).spread(both, count, into.data() + p.begin(kind));
            if (p.relaxing) part -= POWERS[kind] * (sum(up, count) + sum(down, count));
        });
        const double* __restrict above = v.data() + 2 * rows_;
        const double* __restrict below = above + n;
        double* __restrict x = into.data();
        for (int j = 0; j < n; ++j) x[j] += above[j] - below[j];
        return part;
    }

    // Adds G' D G to a form (4, n) of control points and its coupling with s to a border; returns its element of s.
    double square(const std::vector<double>& weights, std::vector<double>& form, std::vector<double>& border) const {
        double corner = p.relaxing ? weights.back() : 0.0;
        std::vector<double> sums(n), differences(n);
        p.each_kind([&](auto kind, int number) {
            const Stencil<kind> by(p);
            const int count = p.count(kind), begin = p.begin(kind);
            const double* __restrict up = weights.data() + number;
            const double* __restrict down = up + rows_;
            double* __restrict both = sums.data();
            for (int row = 0; row < count; ++row) both[row] = up[row] + down[row];
            for (int i = 0; i < WIDTHS[kind]; ++i)
                for (int k = 0; k <= i; ++k)
                    add(both, count, by[i] * by[k], form.data() + (3 - i + k) * size_t(n) + begin + i);
            if (!p.relaxing) return;
            double* __restrict uneven = differences.data();
            for (int row = 0; row < count; ++row) uneven[row] = POWERS[kind] * (down[row] - up[row]);
            by.spread(uneven, count, border.data() + begin);
            corner += POWERS[kind] * POWERS[kind] * sum(both, count);
        });
        const double* __restrict above = weights.data() + 2 * rows_;
        const double* __restrict below = above + n;
        double* __restrict diagonal = form.data() + 3 * size_t(n);
        for (int j = 0; j < n; ++j) diagonal[j] += above[j] + below[j];
        return corner;
    }

  private:
    static void add(const double* __restrict from, int count, double scale, double* __restrict into) {
        for (int i = 0; i < count; ++i) into[i] += scale * from[i];
    }

    static double sum(const double* from, int count) {
        double lanes[4] = {};
        int i = 0;
        for (; i + 4 <= count; i += 4)
            for (int k = 0; k < 4; ++k) lanes[k] += from[i + k];
        for (; i < count; ++i) lanes[0] += from[i];
        return lanes[0] + lanes[1] + lanes[2] + lanes[3];
    }

    // Coefficients of control points in each row of one kind of limit.
    template <int KIND>
    struct Stencil {
        explicit Stencil(const SplineProgram& program) { std::copy_n(program.stencils[KIND], WIDTHS[KIND], shares); }

        double operator[](int k) const { return shares[k]; }

        double along(const double* x) const {
            double sum = 0.0;
            for (int k = 0; k < WIDTHS[KIND]; ++k) sum += shares[k] * x[k];
            return sum;
        }

        // Adds the values of successive rows to their control points.
        void spread(const double* values, int count, double* into) const {
            for (int k = 0; k < WIDTHS[KIND]; ++k) add(values, count, shares[k], into + k);
        }

        double shares[WIDTHS[KIND]];
    };

    const SplineProgram& p;
    const int n, rows_;
    std::vector<double> bounds_, norms_, powers_;
};

}  // namespace kinesic::motion
