// Quadratic program for one hinge's motion: control points x of a uniform cubic B-spline with equations and limits.
//
//   minimise  1/2 x' H x - pull' x + s     H: banded; s: relaxation of the limits (0 without relaxation)
//   subject to  shares . x[first .. first + 3] = value                  for each key, entry and exit
//               |stencil . x[j ...]| <= bound + power s                 for velocity, acceleration, jerk and duty
//               lower <= x <= upper,  s >= easy

#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

namespace kinesic::motion {

constexpr int KINDS = 4;  // velocity, acceleration, jerk, duty
constexpr int WIDTHS[KINDS] = {2, 3, 4, 3};
constexpr int ENDS[KINDS] = {2, 1, 0, 1};  // rows at each end that three fixed control points determine
constexpr double POWERS[KINDS] = {1.0, 2.0, 3.0, 2.0};
constexpr double INACTIVE_BOUND = 2.0;  // bound of such a row, which relaxations ignore

struct Unknowns {
    Unknowns(int size, int fixed) : points(size), ties(fixed) {}

    void clear() {
        std::fill(points.begin(), points.end(), 0.0);
        std::fill(ties.begin(), ties.end(), 0.0);
    }

    std::vector<double> points, ties;  // control points and multipliers of equations, or residuals of their conditions
};

struct SplineProgram {
    int size = 0;  // n, the number of control points
    bool relaxing = false;
    double easy = 0.0;
    double target = -HUGE_VAL;  // relaxation s at which the search may end
    double stencils[KINDS][4] = {};
    std::vector<double> form;  // (3, n) bands of H, the diagonal last; empty for a relaxation
    std::vector<double> pull, lower, upper;  // (n,)
    std::vector<int> first;  // (m,)
    std::vector<double> shares, values;  // (m, 4), (m,)

    int fixed() const { return int(values.size()); }

    // Rows of one kind of limit, with the position of the first row and one past the last.
    int begin(int kind) const { return relaxing ? ENDS[kind] : 0; }
    int end(int kind) const { return size - WIDTHS[kind] + 1 - (relaxing ? ENDS[kind] : 0); }
    int count(int kind) const { return std::max(0, end(kind) - begin(kind)); }
    int rows() const { return count(0) + count(1) + count(2) + count(3); }

    double bound(int kind, int row) const {
        const bool decided = row < ENDS[kind] || row >= size - WIDTHS[kind] + 1 - ENDS[kind];
        return decided ? INACTIVE_BOUND : 1.0;
    }

    // Calls visit(kind, number) for every kind of limit with the number of its first row; the kind is a constant, so that
    // loops over its stencil are unrolled.
    template <typename Visit>
    void each_kind(Visit visit) const {
        int number = 0;
        each_of<0>(visit, number);
        each_of<1>(visit, number);
        each_of<2>(visit, number);
        each_of<3>(visit, number);
    }

  private:
    template <int KIND, typename Visit>
    void each_of(Visit& visit, int& number) const {
        visit(std::integral_constant<int, KIND>(), number);
        number += count(KIND);
    }
};

}  // namespace kinesic::motion
