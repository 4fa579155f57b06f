// Newton's system of a spline program: control points and multipliers of equations.
//
//   [K  A'] [x]   [right]     K: positive definite banded matrix
//   [A  0 ] [y] = [fixed]     A: four coefficients per row, of successive control points

#pragma once

#include <cmath>

#include "banded_system.h"
#include "lanes.h"
#include "spline_program.h"

namespace kinesic::motion {

constexpr double PIVOT_OFFSET = 1e-12;  // added to the scaled diagonal against zero pivots; refinement removes its effect
constexpr double MIN_SCALE = 1e-300;  // smallest scale of diagonal and rows
constexpr int MAX_REFINEMENTS = 3;  // largest number of refinements

class TiedSystem {
  public:
    explicit TiedSystem(const SplineProgram& program)
        : p(program), n(p.size), m(p.fixed()), system_(arrange()), factor_(system_), scales_(n + m), right_(n + m),
          answer_(n + m), left_(n + m) {}

    void clear() { system_.clear(); }

    // Adds a quadratic form (half width + 1, n), whose last row is the diagonal.
    void add(const std::vector<double>& form) {
        const int half = int(form.size()) / n - 1;
        for (int j = 0; j < n; ++j) {
            double* line = system_.line(places_[j]);
            for (int d = 0; d <= std::min(j, half); ++d) line[places_[j - d]] += form[size_t(half - d) * n + j];
        }
    }

    // Scales the diagonal to 1, and that of the equations to about -1 after elimination of their control points, because
    // weights of active limits grow beyond all others.
    void factorise() {
        for (int place : places_) scales_[place] = 1.0 / std::sqrt(system_.line(place)[place] + MIN_SCALE);
        for (int k = 0; k < m; ++k) {
            double sum = MIN_SCALE;
            double* line = system_.line(ties_[k]);
            for (int d = 0; d < 4; ++d) {
                const int place = places_[p.first[k] + d];
                line[place] = p.shares[4 * k + d];
                sum += std::pow(p.shares[4 * k + d] * scales_[place], 2);
            }
            scales_[ties_[k]] = 1.0 / std::sqrt(sum);
        }
        factor_.scale(system_, scales_);
        for (int place : places_) factor_.line(place)[place] += PIVOT_OFFSET;
        for (int tie : ties_) factor_.line(tie)[tie] -= PIVOT_OFFSET;
        factor_.factorise();
    }

    // Solves for a right side, then refines until the residual is at most a given fraction of it.
    void solve(const Unknowns& right, Unknowns& answer, double exact) {
        for (int j = 0; j < n; ++j) right_[places_[j]] = right.points[j];
        for (int k = 0; k < m; ++k) right_[ties_[k]] = right.ties[k];
        answer_ = right_;
        solve_scaled(answer_);
        const double* wanted = right_.data();
        double* left = left_.data();
        const double tolerance = exact * largest_of(n + m, [=](int i) { return std::abs(wanted[i]); });
        double last = HUGE_VAL;
        for (int k = 0; k < MAX_REFINEMENTS && exact < 1.0; ++k) {
            system_.multiply(answer_, left_);
            for (int i = 0; i < n + m; ++i) left[i] = wanted[i] - left[i];
            const double most = largest_of(n + m, [=](int i) { return std::abs(left[i]); });
            if (most <= tolerance || most > last / 2) break;
            last = most;
            solve_scaled(left_);
            for (int i = 0; i < n + m; ++i) answer_[i] += left_[i];
        }
        for (int j = 0; j < n; ++j) answer.points[j] = answer_[places_[j]];
        for (int k = 0; k < m; ++k) answer.ties[k] = answer_[ties_[k]];
    }

  private:
    void solve_scaled(std::vector<double>& right) const {
        for (int i = 0; i < n + m; ++i) right[i] *= scales_[i];
        factor_.solve(right);
        for (int i = 0; i < n + m; ++i) right[i] *= scales_[i];
    }

    // Places each equation after its last control point, and returns the first column of each row.
    std::vector<int> arrange() {
        std::vector<std::vector<int>> after(n);
        for (int k = 0; k < m; ++k) after[p.first[k] + 3].push_back(k);
        places_.resize(n);
        ties_.resize(m);
        std::vector<int> first;
        for (int j = 0; j < n; ++j) {
            places_[j] = int(first.size());
            first.push_back(places_[std::max(j - 3, 0)]);
            for (int k : after[j]) {
                ties_[k] = int(first.size());
                first.push_back(places_[p.first[k]]);
            }
        }
        return first;
    }

    const SplineProgram& p;
    const int n, m;  // numbers of control points and of equations
    std::vector<int> places_, ties_;  // positions of control points and of equations in the band
    BandedSystem system_, factor_;
    std::vector<double> scales_, right_, answer_, left_;  // (n + m,) in band order
};

}  // namespace kinesic::motion
