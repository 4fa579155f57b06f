// The inequalities G (x, s) <= h of a spline program: every row of a limit from above and from below, the same of every
// control point, and the least relaxation.

#pragma once

#include "tied_system.h"

namespace kinesic::motion {

class Inequalities {
  public:
    explicit Inequalities(const SplineProgram& program)
        : p(program), n(p.size), rows_(p.rows()), bounds_(2 * rows_ + 2 * n + (p.relaxing ? 1 : 0)), norms_(rows_) {
        p.each_row([&](int number, auto kind, int row) {
            bounds_[number] = bounds_[rows_ + number] = p.bound(kind, row);
            for (double share : p.stencils[kind]) norms_[number] += share * share;
        });
        for (int j = 0; j < n; ++j) {
            bounds_[2 * rows_ + j] = p.upper[j];
            bounds_[2 * rows_ + n + j] = -p.lower[j];
        }
        if (p.relaxing) bounds_.back() = -p.easy;
    }

    int rows() const { return rows_; }  // of limits
    int count() const { return int(bounds_.size()); }
    const std::vector<double>& bounds() const { return bounds_; }  // h
    double bound(int q) const { return bounds_[q]; }
    double norm(int q) const { return q < 2 * rows_ ? norms_[q % rows_] : 1.0; }  // square of the length of a row of G

    // G (x, s)
    void apply(const std::vector<double>& points, double relaxation, std::vector<double>& into) const {
        p.each_row([&](int number, auto kind, int row) {
            const double along = p.along(kind, row, points.data()), eased = p.relaxing ? POWERS[kind] * relaxation : 0.0;
            into[number] = along - eased;
            into[rows_ + number] = -along - eased;
        });
        for (int j = 0; j < n; ++j) {
            into[2 * rows_ + j] = points[j];
            into[2 * rows_ + n + j] = -points[j];
        }
        if (p.relaxing) into.back() = -relaxation;
    }

    // Adds G' v to the places of control points in a band; returns its part of s.
    double transpose(const TiedSystem& system, const std::vector<double>& v, std::vector<double>& into) const {
        double part = p.relaxing ? -v.back() : 0.0;
        p.each_row([&](int number, auto kind, int row) {
            const double both = v[number] - v[rows_ + number];
            for (int k = 0; k < WIDTHS[kind]; ++k) into[system.place(row + k)] += p.stencils[kind][k] * both;
            if (p.relaxing) part -= POWERS[kind] * (v[number] + v[rows_ + number]);
        });
        for (int j = 0; j < n; ++j) into[system.place(j)] += v[2 * rows_ + j] - v[2 * rows_ + n + j];
        return part;
    }

  private:
    const SplineProgram& p;
    const int n, rows_;
    std::vector<double> bounds_, norms_;
};

}  // namespace kinesic::motion
