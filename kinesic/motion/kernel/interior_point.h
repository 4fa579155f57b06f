// Solves spline programs by a primal-dual interior point method; an iteration costs O(n), as all that couples is a band.
//
// Algorithm: Mehrotra, On the implementation of a primal-dual interior point method (1992). With all inequalities as
// G (x, s) + t = h, t > 0, and multipliers z > 0, Newton's step of all conditions becomes, after t and z are eliminated,
//   [H + G' D G  A'] [dx]     D = z / t, A: what is fixed, y: its multipliers
//   [A           0 ] [dy]
// The relaxation s, which enters every row of a limit, is a border of this system. Towards the end D grows without bounds, and
// rounding with it; an optimum is therefore found exactly from the limits that are met (Stellato et al., OSQP, 2020).

#pragma once

#include "residuals.h"
#include "tied_system.h"

namespace kinesic::motion {

constexpr int MOST = 60;  // iterations; feasible programs take 10 to 25
constexpr double CLOSE = 1e-8;  // [rad], shares of limits: by which a solution may miss them
constexpr double ROUNDED = 1e-7;  // by which multipliers may be out of balance, which rounding increases towards the end
constexpr double SMALL = 1e-10;  // mean product t z at a solution
constexpr double ACCEPTED = 1e-7;  // the same where it gets no smaller
constexpr double LEAST = 1e-15;  // the same where it tells no more
constexpr double SMALL_RELAXING = 1e-9;  // the same for a relaxation, known to so much times the inequalities
constexpr double ACTIVE_RATIO = 1e-5;  // multiplier to slack of a limit that is met
constexpr double ACTIVE_WEIGHT = 1e8;  // of such a limit
constexpr int POLISHED = 20;  // times at most
constexpr double POLISH = 1e-12;  // residuals of an exact optimum
constexpr double STUCK = 0.99;  // of the residuals before, above which some of the limits contradict one another
constexpr double SHORT = 0.999;  // of the way to the nearest bound
constexpr double STALLED = 1e-7;  // step that leads nowhere
constexpr double LIGHT = 0.01;  // weight D of all limits in a start, so that it is near to the desired motion
constexpr double ROOM = 0.1;  // least slack of such a start [rad], shares of limits
constexpr double LIFT_BELOW = 1e-3;  // slack or multiplier of a start below which all of them are lifted
constexpr double EASED = 0.1;  // by which the start of a relaxation is easier than it must be
constexpr double AWAY = 0.01;  // [rad] slack of control points in such a start
constexpr double DIRECTED = 1e-12;  // share of its right side that a step may leave; with 1e-9 one program in a thousand stalls
constexpr double ROUGH = 1.0;  // the same of a step that is only looked at
constexpr double EXACT = 1e-13;  // the same on the way to an exact optimum

class InteriorPoint {
  public:
    explicit InteriorPoint(const SplineProgram& program)
        : p(program), n(p.size), m(p.fixed()), limits(p), rows(limits.rows()), inequality_count(limits.count()),
          residuals(p, limits), system(p), at(n, m), step(n, m), right(n, m), border(n, m), border_solution(n, m),
          form(4 * size_t(n)) {
        for (auto* values : {&t, &z, &dt, &dz, &weights, &inverse_slacks, &inverse_multipliers, &change, &eliminated})
            values->resize(inequality_count);
    }

    // Whether there is a solution.
    bool solve() {
        begin();
        double mean = mean_product({0.0, 0.0});
        for (int k = 0; k < MOST; ++k) {
            residuals.measure(at, s, t, z);
            if (p.relaxing && residuals.primal <= CLOSE && s <= p.target) return true;
            if (residuals.primal <= CLOSE && residuals.dual <= ROUNDED * (1.0 + residuals.largest_tie_multiplier)) {
                if (p.relaxing ? mean <= SMALL_RELAXING : mean <= SMALL && polish()) return true;
                if (mean <= ACCEPTED) best = {at, z, s};
            }
            if (mean <= LEAST || residuals.impossible) break;
            weigh();
            assemble();
            find_direction(0.0, false, p.relaxing ? ROUGH : DIRECTED);
            const double share = mean_product(reach(1.0)) / mean;
            find_direction(share * share * mean, true, DIRECTED);  // Mehrotra takes the cube, which centres less
            const Steps steps = reach(SHORT);
            mean = mean_product(steps);
            if (!(std::max(steps.primal, steps.dual) > STALLED && std::isfinite(mean))) break;
            move(steps);
        }
        if (best.z.empty()) return false;
        at = best.at;
        z = best.z;
        s = best.s;
        return true;
    }

    const std::vector<double>& controls() const { return at.points; }
    double relaxation() const { return s; }
    const std::vector<double>& ties() const { return at.ties; }  // multipliers of what is fixed
    double multiplier(int row) const { return std::max(z[row], z[rows + row]); }  // of a row of a limit

  private:
    struct Solution {
        Unknowns at;
        std::vector<double> z;
        double s;
    };

    struct Steps {
        double primal, dual;
    };

    // The solution of all conditions with the same weights D of all limits; slacks and multipliers are moved to be positive.
    void begin() {
        const double weight = p.relaxing ? 1.0 : LIGHT;
        std::fill(weights.begin(), weights.end(), weight);
        assemble();
        right.clear();
        const double part = limits.transpose(limits.bounds(), right.points) - (p.relaxing ? 1.0 : 0.0);
        for (int j = 0; j < n && !p.relaxing; ++j) right.points[j] = weight * right.points[j] + p.pull[j];
        right.ties = p.values;
        s = solve_system(part, DIRECTED);
        at = step;
        limits.apply(at.points, s, t);
        for (int q = 0; q < inequality_count; ++q) {
            t[q] = limits.bounds()[q] - t[q];
            z[q] = -weight * t[q];
        }
        if (p.relaxing) {
            ease();
        } else {
            lift(t, ROOM);
            lift(z, weight);
        }
    }

    // Relaxes the limits of a start until all of them are kept; multipliers have products t z of one size, and the sum that an
    // optimum of the relaxation asks for.
    void ease() {
        const std::vector<double>& powers = limits.powers();
        double more = 0.0, sum = 0.0;
        for (int q = 0; q < inequality_count; ++q)
            if (powers[q] > 0.0) more = std::max(more, -t[q] / powers[q]);
        more += EASED;
        s += more;
        for (int q = 0; q < inequality_count; ++q) {
            t[q] = std::max(t[q] + powers[q] * more, AWAY);
            sum += powers[q] / t[q];
        }
        for (int q = 0; q < inequality_count; ++q) z[q] = 1.0 / (sum * t[q]);
    }

    // Adds the same to all values where some are hardly positive, so that none is below `least` then.
    static void lift(std::vector<double>& values, double least) {
        const double lowest = *std::min_element(values.begin(), values.end());
        if (lowest < LIFT_BELOW)
            for (double& value : values) value += least - std::min(lowest, 0.0);
    }

    // Moves on to the exact optimum on the limits that are met; false where these cannot be told yet.
    bool polish() {
        const Solution before = {at, z, s};
        for (int q = 0; q < inequality_count; ++q) {
            const bool active = z[q] > ACTIVE_RATIO * t[q];
            weights[q] = active ? ACTIVE_WEIGHT / limits.norm(q) : 0.0;
            if (!active) z[q] = 0.0;
        }
        assemble();
        std::vector<double>& left = residuals.inequalities;
        double last = HUGE_VAL;
        for (int k = 0; k < POLISHED; ++k) {
            residuals.measure(at, s, t, z);
            double off = residuals.dual;
            for (int q = 0; q < inequality_count; ++q) {
                left[q] -= t[q];
                eliminated[q] = weights[q] * left[q];
                if (weights[q] > 0.0) off = std::max(off, std::abs(left[q]));
            }
            for (double lacking : residuals.conditions.ties) off = std::max(off, std::abs(lacking));
            if (off <= POLISH || (k > 1 && off > STUCK * last)) break;
            last = off;
            set_right();
            system.solve(right, step, EXACT);
            limits.apply(step.points, 0.0, change);
            add(step, 1.0, 1.0);
            for (int q = 0; q < inequality_count; ++q) z[q] += weights[q] * (left[q] + change[q]);
        }
        limits.apply(at.points, 0.0, change);
        bool good = true;
        for (int q = 0; q < inequality_count && good; ++q)
            good = change[q] <= limits.bounds()[q] + CLOSE && z[q] >= -CLOSE;
        if (!good) {
            at = before.at;
            z = before.z;
            residuals.measure(at, s, t, z);
        }
        return good;
    }

    void weigh() {
        const int count = inequality_count;  // beside arrays that are written, compilers read a member again and again
        const double *slacks = t.data(), *multipliers = z.data();
        double *weight = weights.data(), *by_slack = inverse_slacks.data(), *by_multiplier = inverse_multipliers.data();
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) by_slack[q] = 1.0 / slacks[q];
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) by_multiplier[q] = 1.0 / multipliers[q];
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) weight[q] = multipliers[q] * by_slack[q];
    }

    // The system of these weights, its factor and the border of s.
    void assemble() {
        std::fill(form.begin(), form.end(), 0.0);
        border.clear();
        corner = limits.square(weights, form, border.points);
        system.clear();
        system.add(form);
        if (!p.relaxing) system.add(p.form);
        system.factorise();
        if (p.relaxing) system.solve(border, border_solution, DIRECTED);
    }

    // The right side that what is eliminated and the residuals leave; returns its part of s.
    double set_right() {
        right.clear();
        const double part = limits.transpose(eliminated, right.points);
        for (int j = 0; j < n; ++j) right.points[j] = -right.points[j] - residuals.conditions.points[j];
        for (int k = 0; k < m; ++k) right.ties[k] = -residuals.conditions.ties[k];
        return -part - residuals.relaxation;
    }

    // Solves for `right` into `step`; returns the part of s, whose right side is given.
    double solve_system(double wanted, double exact) {
        system.solve(right, step, exact);
        if (!p.relaxing) return 0.0;
        double above = wanted, below = corner;
        for (int j = 0; j < n; ++j) {
            above -= border.points[j] * step.points[j];
            below -= border.points[j] * border_solution.points[j];
        }
        const double part = above / below;
        for (int j = 0; j < n; ++j) step.points[j] -= part * border_solution.points[j];
        for (int k = 0; k < m; ++k) step.ties[k] -= part * border_solution.ties[k];
        return part;
    }

    // Newton's step towards products t z of `target`; with what the last step left out, where that is known.
    void find_direction(double target, bool corrected, double exact) {
        const double *slacks = t.data(), *multipliers = z.data(), *residual = residuals.inequalities.data();
        const double *by_slack = inverse_slacks.data(), *weight = weights.data(), *along = change.data();
        double *slack_step = dt.data(), *multiplier_step = dz.data(), *rest = eliminated.data();
        const double before = corrected ? 1.0 : 0.0;
        const int count = inequality_count;
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) {
            const double product = slacks[q] * multipliers[q] + before * (slack_step[q] * multiplier_step[q]) - target;
            rest[q] = (multipliers[q] * residual[q] - product) * by_slack[q];
        }
        ds = solve_system(set_right(), exact);
        limits.apply(step.points, ds, change);
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) {
            slack_step[q] = -residual[q] - along[q];
            multiplier_step[q] = rest[q] + weight[q] * along[q];
        }
    }

    // How far the step may go with slacks and multipliers above 0, by a share of the way to the nearest bound.
    Steps reach(double share) const {
        const double *slack_step = dt.data(), *multiplier_step = dz.data();
        const double *by_slack = inverse_slacks.data(), *by_multiplier = inverse_multipliers.data();
        const double slack = largest_of(inequality_count, [=](int q) { return -slack_step[q] * by_slack[q]; });
        const double other = largest_of(inequality_count, [=](int q) { return -multiplier_step[q] * by_multiplier[q]; });
        const Steps steps = {std::min(1.0, share / slack), std::min(1.0, share / other)};
        const double both = std::min(steps.primal, steps.dual);
        return p.relaxing ? steps : Steps{both, both};
    }

    // The mean product t z after a step.
    double mean_product(Steps steps) const {
        const double *slacks = t.data(), *multipliers = z.data(), *slack_step = dt.data(), *multiplier_step = dz.data();
        const double total = sum_of(inequality_count, [=](int q) {
            return (slacks[q] + steps.primal * slack_step[q]) * (multipliers[q] + steps.dual * multiplier_step[q]);
        });
        return total / inequality_count;
    }

    void add(const Unknowns& step, double primal_share, double dual_share) {
        for (int j = 0; j < n; ++j) at.points[j] += primal_share * step.points[j];
        for (int k = 0; k < m; ++k) at.ties[k] += dual_share * step.ties[k];
    }

    void move(Steps steps) {
        add(step, steps.primal, steps.dual);
        s += steps.primal * ds;
        const int count = inequality_count;
        double *slacks = t.data(), *multipliers = z.data();
        const double *slack_step = dt.data(), *multiplier_step = dz.data();
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) slacks[q] += steps.primal * slack_step[q];
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) multipliers[q] += steps.dual * multiplier_step[q];
    }

    const SplineProgram& p;
    const int n, m;  // control points, rows that are fixed
    const Inequalities limits;
    const int rows, inequality_count;  // rows of limits, inequalities
    Residuals residuals;
    TiedSystem system;
    Unknowns at, step, right, border, border_solution;
    std::vector<double> form;  // (4, n) of G' D G
    Solution best = {{0, 0}, {}, 0.0};  // the last one that is good enough
    std::vector<double> t, z, dt, dz, weights, inverse_slacks, inverse_multipliers;  // (inequality_count,)
    std::vector<double> change, eliminated;  // (inequality_count,)
    double s = 0.0, ds = 0.0, corner = 1.0;
};

}  // namespace kinesic::motion
