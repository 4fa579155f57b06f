// Primal-dual interior-point method for spline programs; an iteration costs O(n), because the system is banded.
//
// Algorithm: Mehrotra, On the implementation of a primal-dual interior point method (1992). With all inequalities as
// G (x, s) + t = h, t > 0, and multipliers z > 0, elimination of t and z turns Newton's step into
//   [H + G' D G  A'] [dx]     D = z / t, A: equations, y: their multipliers
//   [A           0 ] [dy]
// The relaxation s, which occurs in every limit row, is a border of this system. Towards the end D and rounding errors grow
// without bounds; the optimum is therefore computed from the active limits (Stellato et al., OSQP, 2020).

#pragma once

#include "residuals.h"
#include "tied_system.h"

namespace kinesic::motion {

constexpr int MAX_ITERATIONS = 60;  // largest number of iterations; feasible programs take 10 to 25
constexpr double MAX_VIOLATION = 1e-8;  // [rad], limit ratios: largest violation in a solution
constexpr double MAX_IMBALANCE = 1e-7;  // largest imbalance of multipliers, which rounding increases towards the end
constexpr double TARGET_PRODUCT = 1e-10;  // mean product t z of a solution
constexpr double ACCEPTED_PRODUCT = 1e-7;  // mean product t z of a solution if it no longer decreases
constexpr double MIN_PRODUCT = 1e-15;  // mean product t z below which rounding errors dominate
constexpr double RELAXATION_PRODUCT = 1e-9;  // mean product t z of a relaxation; error / number of inequalities
constexpr double ACTIVE_RATIO = 1e-5;  // multiplier / slack of an active limit
constexpr double ACTIVE_WEIGHT = 1e8;  // weight of an active limit
constexpr int MAX_POLISH_STEPS = 20;  // largest number of polishing steps
constexpr double POLISH_RESIDUAL = 1e-12;  // residuals of an exact optimum
constexpr double STUCK_RATIO = 0.99;  // ratio of successive residuals above which limits contradict each other
constexpr double STEP_FRACTION = 0.999;  // fraction of the step to the nearest bound
constexpr double MIN_STEP = 1e-7;  // step length without progress
constexpr double START_WEIGHT = 0.01;  // weight D of all limits at the start, which keeps it near to the desired motion
constexpr double MIN_START_SLACK = 0.1;  // smallest slack at the start [rad], limit ratios
constexpr double MIN_START_VALUE = 1e-3;  // slack or multiplier at the start below which all are raised
constexpr double START_RELAXATION = 0.1;  // extra relaxation at the start of a relaxation
constexpr double START_CONTROL_SLACK = 0.01;  // [rad] slack of control points at such a start
constexpr double STEP_RESIDUAL = 1e-12;  // relative residual of a step; with 1e-9 one program in a thousand stalls
constexpr double PROBE_RESIDUAL = 1.0;  // relative residual of a step that is only probed
constexpr double EXACT_STEP_RESIDUAL = 1e-13;  // relative residual of a step to the exact optimum

class InteriorPoint {
  public:
    explicit InteriorPoint(const SplineProgram& program)
        : p(program), n(p.size), m(p.fixed()), limits(p), rows(limits.rows()), inequality_count(limits.count()),
          residuals(p, limits), system(p), at(n, m), step(n, m), right(n, m), border(n, m), border_solution(n, m),
          form(4 * size_t(n)) {
        for (auto* values : {&t, &z, &dt, &dz, &weights, &inverse_slacks, &inverse_multipliers, &change, &eliminated})
            values->resize(inequality_count);
    }

    // Solves the program and returns whether there is a solution.
    bool solve() {
        begin();
        double mean = mean_product({0.0, 0.0});
        for (int k = 0; k < MAX_ITERATIONS; ++k) {
            residuals.measure(at, s, t, z);
            if (p.relaxing && residuals.primal <= MAX_VIOLATION && s <= p.target) return true;
            if (residuals.primal <= MAX_VIOLATION &&
                residuals.dual <= MAX_IMBALANCE * (1.0 + residuals.largest_tie_multiplier)) {
                if (p.relaxing ? mean <= RELAXATION_PRODUCT : mean <= TARGET_PRODUCT && polish()) return true;
                if (mean <= ACCEPTED_PRODUCT) best = {at, z, s};
            }
            if (mean <= MIN_PRODUCT || residuals.impossible) break;
            weigh();
            assemble();
            find_direction(0.0, false, p.relaxing ? PROBE_RESIDUAL : STEP_RESIDUAL);
            const double share = mean_product(reach(1.0)) / mean;
            find_direction(share * share * mean, true, STEP_RESIDUAL);  // Mehrotra uses the cube, which centres less
            const Steps steps = reach(STEP_FRACTION);
            mean = mean_product(steps);
            if (!(std::max(steps.primal, steps.dual) > MIN_STEP && std::isfinite(mean))) break;
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
    const std::vector<double>& ties() const { return at.ties; }  // multipliers of the equations
    double multiplier(int row) const { return std::max(z[row], z[rows + row]); }  // of a limit row

  private:
    struct Solution {
        Unknowns at;
        std::vector<double> z;
        double s;
    };

    struct Steps {
        double primal, dual;
    };

    // Solves all conditions with equal weights D, then moves slacks and multipliers to positive values.
    void begin() {
        const double weight = p.relaxing ? 1.0 : START_WEIGHT;
        std::fill(weights.begin(), weights.end(), weight);
        assemble();
        right.clear();
        const double part = limits.transpose(limits.bounds(), right.points) - (p.relaxing ? 1.0 : 0.0);
        for (int j = 0; j < n && !p.relaxing; ++j) right.points[j] = weight * right.points[j] + p.pull[j];
        right.ties = p.values;
        s = solve_system(part, STEP_RESIDUAL);
        at = step;
        limits.apply(at.points, s, t);
        for (int q = 0; q < inequality_count; ++q) {
            t[q] = limits.bounds()[q] - t[q];
            z[q] = -weight * t[q];
        }
        if (p.relaxing) {
            ease();
        } else {
            lift(t, MIN_START_SLACK);
            lift(z, weight);
        }
    }

    // Relaxes the limits at the start until all hold. Multipliers get equal products t z, and the sum that optimality of the
    // relaxation requires.
    void ease() {
        const std::vector<double>& powers = limits.powers();
        double more = 0.0, sum = 0.0;
        for (int q = 0; q < inequality_count; ++q)
            if (powers[q] > 0.0) more = std::max(more, -t[q] / powers[q]);
        more += START_RELAXATION;
        s += more;
        for (int q = 0; q < inequality_count; ++q) {
            t[q] = std::max(t[q] + powers[q] * more, START_CONTROL_SLACK);
            sum += powers[q] / t[q];
        }
        for (int q = 0; q < inequality_count; ++q) z[q] = 1.0 / (sum * t[q]);
    }

    // Adds a constant to all values if some are hardly positive, so that all are at least `least`.
    static void lift(std::vector<double>& values, double least) {
        const double lowest = *std::min_element(values.begin(), values.end());
        if (lowest < MIN_START_VALUE)
            for (double& value : values) value += least - std::min(lowest, 0.0);
    }

    // Moves to the exact optimum on the active limits; false if these are not certain yet.
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
        for (int k = 0; k < MAX_POLISH_STEPS; ++k) {
            residuals.measure(at, s, t, z);
            double off = residuals.dual;
            for (int q = 0; q < inequality_count; ++q) {
                left[q] -= t[q];
                eliminated[q] = weights[q] * left[q];
                if (weights[q] > 0.0) off = std::max(off, std::abs(left[q]));
            }
            for (double lacking : residuals.conditions.ties) off = std::max(off, std::abs(lacking));
            if (off <= POLISH_RESIDUAL || (k > 1 && off > STUCK_RATIO * last)) break;
            last = off;
            set_right();
            system.solve(right, step, EXACT_STEP_RESIDUAL);
            limits.apply(step.points, 0.0, change);
            add(step, 1.0, 1.0);
            for (int q = 0; q < inequality_count; ++q) z[q] += weights[q] * (left[q] + change[q]);
        }
        limits.apply(at.points, 0.0, change);
        bool good = true;
        for (int q = 0; q < inequality_count && good; ++q)
            good = change[q] <= limits.bounds()[q] + MAX_VIOLATION && z[q] >= -MAX_VIOLATION;
        if (!good) {
            at = before.at;
            z = before.z;
            residuals.measure(at, s, t, z);
        }
        return good;
    }

    void weigh() {
        const int count = inequality_count;  // a local, because compilers reload members next to written arrays
        const double *slacks = t.data(), *multipliers = z.data();
        double *weight = weights.data(), *by_slack = inverse_slacks.data(), *by_multiplier = inverse_multipliers.data();
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) by_slack[q] = 1.0 / slacks[q];
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) by_multiplier[q] = 1.0 / multipliers[q];
#pragma GCC ivdep
        for (int q = 0; q < count; ++q) weight[q] = multipliers[q] * by_slack[q];
    }

    // Assembles and factorises the system for the current weights, with the border of s.
    void assemble() {
        std::fill(form.begin(), form.end(), 0.0);
        border.clear();
        corner = limits.square(weights, form, border.points);
        system.clear();
        system.add(form);
        if (!p.relaxing) system.add(p.form);
        system.factorise();
        if (p.relaxing) system.solve(border, border_solution, STEP_RESIDUAL);
    }

    // Computes the right side after elimination of t and z, and returns its component of s.
    double set_right() {
        right.clear();
        const double part = limits.transpose(eliminated, right.points);
        for (int j = 0; j < n; ++j) right.points[j] = -right.points[j] - residuals.conditions.points[j];
        for (int k = 0; k < m; ++k) right.ties[k] = -residuals.conditions.ties[k];
        return -part - residuals.relaxation;
    }

    // Solves for `right` into `step`, and returns the component of s for its given right side.
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

    // Computes Newton's step to products t z of `target`, with the second-order term of the previous step if available.
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

    // Returns the step length that keeps slacks and multipliers positive, as a fraction of that to the nearest bound.
    Steps reach(double share) const {
        const double *slack_step = dt.data(), *multiplier_step = dz.data();
        const double *by_slack = inverse_slacks.data(), *by_multiplier = inverse_multipliers.data();
        const double slack = largest_of(inequality_count, [=](int q) { return -slack_step[q] * by_slack[q]; });
        const double other = largest_of(inequality_count, [=](int q) { return -multiplier_step[q] * by_multiplier[q]; });
        const Steps steps = {std::min(1.0, share / slack), std::min(1.0, share / other)};
        const double both = std::min(steps.primal, steps.dual);
        return p.relaxing ? steps : Steps{both, both};
    }

    // Returns the mean product t z after a step.
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
    const int n, m;  // numbers of control points and of equations
    const Inequalities limits;
    const int rows, inequality_count;  // numbers of limit rows and of inequalities
    Residuals residuals;
    TiedSystem system;
    Unknowns at, step, right, border, border_solution;
    std::vector<double> form;  // (4, n) form G' D G
    Solution best = {{0, 0}, {}, 0.0};  // last solution that was accurate enough
    std::vector<double> t, z, dt, dz, weights, inverse_slacks, inverse_multipliers;  // (inequality_count,)
    std::vector<double> change, eliminated;  // (inequality_count,)
    double s = 0.0, ds = 0.0, corner = 1.0;
};

}  // namespace kinesic::motion
