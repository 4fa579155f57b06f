// Newton's system of a spline program: control points, and beside them the rows that are fixed.
//
//   [K  A'] [x]   [right]     K: a band of definite entries
//   [A  0 ] [y] = [fixed]     A: four shares a row, of control points that follow one another

#pragma once

#include <cmath>

#include "banded_system.h"
#include "spline_program.h"

namespace kinesic::motion {

constexpr double NUDGE = 1e-12;  // of the scaled diagonal, keeps pivots from 0; what it changes is refined away
constexpr double SMALLEST = 1e-300;  // diagonal and row
constexpr int REFINED = 3;  // times at most
constexpr double EXACT = 1e-13;  // share of the right side that may be left

class TiedSystem {
  public:
    explicit TiedSystem(const SplineProgram& program)
        : p(program), n(p.size), m(p.fixed()), width_(arrange()), system_(n + m, width_), factor_(n + m, width_),
          scales_(n + m) {}

    int size() const { return n + m; }
    int place(int control) const { return places_[control]; }  // of a control point in the band
    int tie(int row) const { return ties_[row]; }  // of a row that is fixed

    void clear() { system_.clear(); }

    // Row of a control point, to be indexed by the places of those before it and its own.
    double* line(int control) { return system_.line(places_[control]); }

    // Adds a form (half width + 1, n) whose last row is the diagonal.
    void add(const std::vector<double>& form) {
        const int half = int(form.size()) / n - 1;
        for (int j = 0; j < n; ++j)
            for (int d = 0; d <= std::min(j, half); ++d) line(j)[places_[j - d]] += form[size_t(half - d) * n + j];
    }

    // Scaled so that the diagonal is 1, and of what is fixed about -1 once its control points are eliminated: weights of
    // limits that are met grow beyond all others.
    void factorise() {
        for (int j = 0; j < n; ++j) scales_[places_[j]] = 1.0 / std::sqrt(line(j)[places_[j]] + SMALLEST);
        for (int k = 0; k < m; ++k) {
            double sum = SMALLEST;
            for (int d = 0; d < 4; ++d) {
                const int place = places_[p.first[k] + d];
                system_.at(ties_[k], place) += p.shares[4 * k + d];
                sum += std::pow(p.shares[4 * k + d] * scales_[place], 2);
            }
            scales_[ties_[k]] = 1.0 / std::sqrt(sum);
        }
        factor_ = system_;
        factor_.scale(scales_);
        for (int place : places_) factor_.at(place, place) += NUDGE;
        for (int tie : ties_) factor_.at(tie, tie) -= NUDGE;
        factor_.factorise();
    }

    // Solves for a right side; then again for what is left of it.
    void solve(const std::vector<double>& right, std::vector<double>& answer) {
        answer = right;
        solve_scaled(answer);
        double last = HUGE_VAL, enough = 0.0;
        for (double value : right) enough = std::max(enough, EXACT * std::abs(value));
        for (int k = 0; k < REFINED; ++k) {
            left_.assign(size(), 0.0);
            system_.multiply(answer, left_);
            double most = 0.0;
            for (int i = 0; i < size(); ++i) {
                left_[i] = right[i] - left_[i];
                most = std::max(most, std::abs(left_[i]));
            }
            if (most <= enough || most > last / 2) break;
            last = most;
            solve_scaled(left_);
            for (int i = 0; i < size(); ++i) answer[i] += left_[i];
        }
    }

  private:
    void solve_scaled(std::vector<double>& right) const {
        for (int i = 0; i < size(); ++i) right[i] *= scales_[i];
        factor_.solve(right);
        for (int i = 0; i < size(); ++i) right[i] *= scales_[i];
    }

    // Gives each row of what is fixed the place after its last control point, and returns the width of the band.
    int arrange() {
        std::vector<std::vector<int>> after(n);
        for (int k = 0; k < m; ++k) after[p.first[k] + 3].push_back(k);
        places_.resize(n);
        ties_.resize(m);
        int place = 0, widest = 3;
        for (int j = 0; j < n; ++j) {
            places_[j] = place++;
            for (int k : after[j]) ties_[k] = place++;
        }
        for (int k = 0; k < m; ++k) widest = std::max(widest, ties_[k] - places_[p.first[k]]);
        for (int j = 0; j + 3 < n; ++j) widest = std::max(widest, places_[j + 3] - places_[j]);
        return widest;
    }

    const SplineProgram& p;
    const int n, m;  // control points, rows that are fixed
    std::vector<int> places_, ties_;
    const int width_;
    BandedSystem system_, factor_;
    std::vector<double> scales_, left_;
};

}  // namespace kinesic::motion
