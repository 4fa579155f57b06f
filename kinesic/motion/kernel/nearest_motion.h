// Motion of a segment nearest to a desired one within limits: solved near violated limits, and equal to the unlimited
// motion everywhere else.
//
// The effect of a limit decays by a constant factor per control point, like the inverse of a banded matrix (Demko,
// Moss and Smith, Decay rates for inverses of band matrices, 1984). The optimum of the whole segment is therefore that of a
// window around the violations of the free optimum, if the change vanishes at the window's ends, which is checked.

#pragma once

#include "interior_point.h"

namespace kinesic::motion {

constexpr int MARGINS[] = {40, 96};  // control points tried on both sides of the violations
constexpr double MAX_WINDOW_RATIO = 0.7;   // fraction of the segment above which a window saves nothing
constexpr int EDGE = 3;                    // control points at each end of a window that are fixed
constexpr double MAX_EDGE_CHANGE = 1e-11;  // [rad] largest change near an end of an accepted window
constexpr double EDGE_RANGE = 1.0;         // [rad] range around fixed control points
constexpr double MIN_KEY_WEIGHT = 1e-6;    // weight of free control points below which a key counts as fixed

// Computes the optimum without limits.
inline std::vector<double> free_optimum(const SplineProgram& program) {
    TiedSystem system(program);
    system.add(program.form);
    system.factorise();
    Unknowns right(program.size, program.fixed()), answer = right;
    right.points = program.pull;
    right.ties = program.values;
    system.solve(right, answer, EXACT_STEP_RESIDUAL);
    return answer.points;
}

class NearestMotion {
  public:
    explicit NearestMotion(const SplineProgram& program) : p(program), controls_(free_optimum(program)) {}

    // Solves the segment and returns whether there is a solution.
    bool solve() {
        const auto [first, last] = beyond();
        if (first > last) return true;
        for (int margin : MARGINS) {
            const int begin = first - margin <= 2 * EDGE ? 0 : first - margin;
            const int end = last + margin >= p.size - 2 * EDGE ? p.size : last + margin;
            if (end - begin > MAX_WINDOW_RATIO * p.size) break;
            const Outcome outcome = solve_window(begin, end);
            if (outcome == Outcome::whole) return true;
            if (outcome == Outcome::none) break;
        }
        return solve_whole();
    }

    const std::vector<double>& controls() const { return controls_; }

  private:
    enum class Outcome { none, part, whole };  // result of a window: no solution, too narrow, accepted

    // Returns the first and the last control point of rows that exceed a bound.
    std::pair<int, int> beyond() const {
        int first = p.size, last = -1;
        const auto note = [&](int begin, int end) {
            first = std::min(first, begin);
            last = std::max(last, end);
        };
        for (int kind = 0; kind < KINDS; ++kind)
            for (int row = 0; row + WIDTHS[kind] <= p.size; ++row) {
                double along = 0.0;
                for (int k = 0; k < WIDTHS[kind]; ++k) along += p.stencils[kind][k] * controls_[row + k];
                if (std::abs(along) > p.bound(kind, row)) note(row, row + WIDTHS[kind] - 1);
            }
        for (int j = 0; j < p.size; ++j)
            if (controls_[j] > p.upper[j] || controls_[j] < p.lower[j]) note(j, j);
        return {first, last};
    }

    bool solve_whole() {
        InteriorPoint method(p);
        if (!method.solve()) return false;
        controls_ = method.controls();
        return true;
    }

    // Solves for the control points in [begin, end).
    Outcome solve_window(int begin, int end) {
        const SplineProgram part = window(begin, end);
        InteriorPoint method(part);
        if (!method.solve()) return Outcome::none;
        const std::vector<double>& found = method.controls();
        for (int d = EDGE; d < 2 * EDGE; ++d) {
            if (begin > 0 && std::abs(found[d] - controls_[begin + d]) > MAX_EDGE_CHANGE) return Outcome::part;
            if (end < p.size && std::abs(found[end - begin - 1 - d] - controls_[end - 1 - d]) > MAX_EDGE_CHANGE)
                return Outcome::part;
        }
        std::copy(found.begin(), found.end(), controls_.begin() + begin);
        return Outcome::whole;
    }

    SplineProgram window(int begin, int end) const {
        SplineProgram part;
        part.size = end - begin;
        std::copy_n(&p.stencils[0][0], KINDS * 4, &part.stencils[0][0]);
        for (int row = 0, rows = int(p.form.size()) / p.size; row < rows; ++row)
            part.form.insert(part.form.end(), p.form.begin() + size_t(row) * p.size + begin,
                             p.form.begin() + size_t(row) * p.size + end);
        part.pull.assign(p.pull.begin() + begin, p.pull.begin() + end);
        part.lower.assign(p.lower.begin() + begin, p.lower.begin() + end);
        part.upper.assign(p.upper.begin() + begin, p.upper.begin() + end);
        for (int k = 0; k < p.fixed(); ++k) {
            const int first = p.first[k] - begin;
            if (first < 0 || first + 4 > part.size) continue;
            const double* shares = p.shares.data() + 4 * k;
            const bool given = (begin > 0 && first == 0 && std::abs(shares[3]) < MIN_KEY_WEIGHT) ||
                               (end < p.size && first + 4 == part.size && std::abs(shares[0]) < MIN_KEY_WEIGHT);
            if (!given) tie(part, first, shares, p.values[k]);
        }
        for (int d = 0; d < EDGE; ++d) {
            if (begin > 0) give(part, 0, d, controls_[begin + d]);
            if (end < p.size) give(part, part.size - 4, d + 1, controls_[end - EDGE + d]);
        }
        return part;
    }

    static void tie(SplineProgram& part, int first, const double* shares, double value) {
        part.first.push_back(first);
        part.shares.insert(part.shares.end(), shares, shares + 4);
        part.values.push_back(value);
    }

    // Fixes a control point at its value.
    static void give(SplineProgram& part, int first, int which, double value) {
        double shares[4] = {};
        shares[which] = 1.0;
        tie(part, first, shares, value);
        part.lower[first + which] = std::min(part.lower[first + which], value - EDGE_RANGE);
        part.upper[first + which] = std::max(part.upper[first + which], value + EDGE_RANGE);
    }

    const SplineProgram& p;
    std::vector<double> controls_;
};

}  // namespace kinesic::motion
