// Solves spline programs by a primal-dual interior point method; an iteration costs O(n), as all that couples is a band.
//
// Algorithm: Mehrotra, On the implementation of a primal-dual interior point method (1992). With all inequalities as
// G (x, s) + t = h, t > 0, and multipliers z > 0, Newton's step of all conditions becomes, after t and z are eliminated,
//   [H + G' D G  A'] [dx]     D = z / t, A: what is fixed, y: its multipliers
//   [A           0 ] [dy]
// The relaxation s, which enters every row of a limit, is a border of this system. Towards the end D grows without bounds, and
// rounding with it; an optimum is therefore found exactly from the limits that are met (Stellato et al., OSQP, 2020).

#pragma once

#include "inequalities.h"
#include "tied_system.h"

namespace kinesic::motion {

constexpr int MOST = 60;  // iterations; feasible programs take 10 to 25
constexpr double CLOSE = 1e-8;  // [rad], shares of limits: by which a solution may miss them
constexpr double ROUNDED = 1e-7;  // by which multipliers may be out of balance, which rounding increases towards the end
constexpr double SMALL = 1e-10;  // mean product t z at a solution
constexpr double ENOUGH = 1e-7;  // the same where it gets no smaller
constexpr double LEAST = 1e-15;  // the same where it tells no more
constexpr double MET = 1e-5;  // multiplier to slack of a limit that is met
constexpr double FIRM = 1e8;  // weight of such a limit
constexpr int POLISHED = 20;  // times at most
constexpr double POLISH = 1e-12;  // residuals of an exact optimum
constexpr double SHORT = 0.995;  // of the way to the nearest bound
constexpr double STALLED = 1e-7;  // step that leads nowhere
constexpr double POSITIVE = 1e-3;  // least slack and multiplier of a start

class InteriorPoint {
  public:
    explicit InteriorPoint(const SplineProgram& program)
        : p(program), n(p.size), m(p.fixed()), limits(p), rows(limits.rows()), many(limits.count()), system(p),
          x(n), y(m), dx(n), dy(m) {
        for (auto* values : {&t, &z, &gap, &dt, &dz, &away, &across, &inverse, &weights}) values->resize(many);
        for (auto* values : {&right, &step, &border, &border_solution, &residuals}) values->resize(system.size());
    }

    // Whether there is a solution.
    bool solve() {
        begin();
        for (int k = 0; k < MOST; ++k) {
            measure();
            const double mean = product() / many;
            if (primal <= CLOSE && dual <= ROUNDED * (1.0 + largest)) {
                if (mean <= SMALL && (p.relaxing || polish())) return true;
                if (mean <= ENOUGH) keep();
            }
            if (mean <= LEAST || impossible) break;
            weigh();
            assemble();
            find_direction(0.0, false);
            const double share = advance_by(1.0).mean / mean;
            find_direction(share * share * share * mean, true);
            const Steps steps = advance_by(SHORT);
            if (!(std::max(steps.primal, steps.dual) > STALLED && std::isfinite(steps.mean))) break;
            move(steps);
        }
        if (best.x.empty()) return false;
        x = best.x;
        y = best.y;
        z = best.z;
        s = best.s;
        return true;
    }

    const std::vector<double>& controls() const { return x; }
    double relaxation() const { return s; }
    const std::vector<double>& ties() const { return y; }  // multipliers of what is fixed
    double pull(int row) const { return std::max(z[row], z[rows + row]); }  // multiplier of a row of a limit

  private:
    struct Point {
        std::vector<double> x, y, z;
        double s = 0.0;
    };

    void keep() {
        best.x = x;
        best.y = y;
        best.z = z;
        best.s = s;
    }

    struct Steps {
        double primal, dual, mean;  // the mean product after them
    };

    // The solution of all conditions with D = 1, with slacks and multipliers moved to be positive.
    void begin() {
        std::fill(weights.begin(), weights.end(), 1.0);
        assemble();
        std::fill(right.begin(), right.end(), 0.0);
        const double part = limits.transpose(system, limits.bounds(), right) - (p.relaxing ? 1.0 : 0.0);
        for (int j = 0; j < n && !p.relaxing; ++j) right[system.place(j)] += p.pull[j];
        for (int k = 0; k < m; ++k) right[system.tie(k)] = p.values[k];
        s = solve_system(part);
        unpack(x, y);
        limits.apply(x, s, t);
        for (int q = 0; q < many; ++q) {
            t[q] = limits.bound(q) - t[q];
            z[q] = -t[q];
        }
        lift(t);
        lift(z);
    }

    static void lift(std::vector<double>& values) {
        const double lowest = *std::min_element(values.begin(), values.end());
        if (lowest < POSITIVE)
            for (double& value : values) value += 1.0 - std::min(lowest, 0.0);
    }

    void unpack(std::vector<double>& points, std::vector<double>& multipliers) const {
        for (int j = 0; j < n; ++j) points[j] = step[system.place(j)];
        for (int k = 0; k < m; ++k) multipliers[k] = step[system.tie(k)];
    }

    // Residuals: of x and y in `residuals`, of s in `relaxation_residual`, of inequalities in `gap`.
    void measure() {
        std::fill(residuals.begin(), residuals.end(), 0.0);
        relaxation_residual = limits.transpose(system, z, residuals) + (p.relaxing ? 1.0 : 0.0);
        largest = 0.0;
        for (int k = 0; k < m; ++k) {
            double lacking = -p.values[k];
            for (int d = 0; d < 4; ++d) {
                residuals[system.place(p.first[k] + d)] += p.shares[4 * k + d] * y[k];
                lacking += p.shares[4 * k + d] * x[p.first[k] + d];
            }
            residuals[system.tie(k)] = lacking;
            largest = std::max(largest, std::abs(y[k]));
        }
        if (!p.relaxing) {
            impossible = contradicts();
            add_form();
        }
        limits.apply(x, s, gap);
        primal = dual = 0.0;
        for (int q = 0; q < many; ++q) {
            gap[q] += t[q] - limits.bound(q);
            primal = std::max(primal, std::abs(gap[q]));
        }
        for (int k = 0; k < m; ++k) primal = std::max(primal, std::abs(residuals[system.tie(k)]));
        for (int j = 0; j < n; ++j) dual = std::max(dual, std::abs(residuals[system.place(j)]));
        dual = std::max(dual, std::abs(relaxation_residual));
    }

    // Whether multipliers prove that nothing keeps all limits (Farkas, 1902): for whatever does,
    // 0 <= z' (h - G x) + y' (values - A x) = z' h + y' values - (G' z + A' y)' x, and x lies between lower and upper.
    bool contradicts() const {
        double most = 0.0;
        for (int q = 0; q < many; ++q) most += limits.bound(q) * z[q];
        for (int k = 0; k < m; ++k) most += p.values[k] * y[k];
        for (int j = 0; j < n; ++j)
            most += std::abs(residuals[system.place(j)]) * std::max(std::abs(p.lower[j]), std::abs(p.upper[j]));
        return most < 0.0;
    }

    // Adds H x - pull to the residuals of x.
    void add_form() {
        const int half = int(p.form.size()) / n - 1;
        const double* diagonal = p.form.data() + size_t(half) * n;
        for (int j = 0; j < n; ++j) {
            double sum = diagonal[j] * x[j] - p.pull[j];
            for (int d = 1; d <= half; ++d) {
                if (j >= d) sum += diagonal[j - d * n] * x[j - d];
                if (j + d < n) sum += diagonal[j + d - d * n] * x[j + d];
            }
            residuals[system.place(j)] += sum;
        }
    }

    // Moves on to the exact optimum on the limits that are met; false where these cannot be told yet.
    bool polish() {
        const std::vector<double> before = x, ties = y, multipliers = z;
        for (int q = 0; q < many; ++q) {
            const bool met = z[q] > MET * t[q];
            weights[q] = met ? FIRM / limits.norm(q) : 0.0;
            if (!met) z[q] = 0.0;
        }
        assemble();
        for (int k = 0; k < POLISHED; ++k) {
            measure();
            double off = dual;
            for (int q = 0; q < many; ++q) {
                gap[q] -= t[q];
                across[q] = weights[q] * gap[q];
                if (weights[q] > 0.0) off = std::max(off, std::abs(gap[q]));
            }
            for (int i = 0; i < m; ++i) off = std::max(off, std::abs(residuals[system.tie(i)]));
            if (off <= POLISH) break;
            std::fill(right.begin(), right.end(), 0.0);
            limits.transpose(system, across, right);
            for (int i = 0; i < system.size(); ++i) right[i] = -right[i] - residuals[i];
            system.solve(right, step);
            unpack(dx, dy);
            limits.apply(dx, 0.0, away);
            for (int j = 0; j < n; ++j) x[j] += dx[j];
            for (int i = 0; i < m; ++i) y[i] += dy[i];
            for (int q = 0; q < many; ++q) z[q] += weights[q] * (gap[q] + away[q]);
        }
        limits.apply(x, 0.0, gap);
        bool good = true;
        for (int q = 0; q < many && good; ++q) good = gap[q] <= limits.bound(q) + CLOSE && z[q] >= -CLOSE;
        if (!good) {
            x = before;
            y = ties;
            z = multipliers;
            measure();
        }
        return good;
    }

    double product() const {
        double sum = 0.0;
        for (int q = 0; q < many; ++q) sum += t[q] * z[q];
        return sum;
    }

    void weigh() {
        for (int q = 0; q < many; ++q) {
            inverse[q] = 1.0 / t[q];
            weights[q] = z[q] * inverse[q];
        }
    }

    // The system of these weights, its factor and the border of s.
    void assemble() {
        system.clear();
        std::fill(border.begin(), border.end(), 0.0);
        corner = p.relaxing ? weights[many - 1] : 1.0;
        if (!p.relaxing) system.add(p.form);
        p.each_row([&](int number, auto kind, int row) {
            const double up = weights[number], down = weights[rows + number];
            const double* stencil = p.stencils[kind];
            for (int i = 0; i < WIDTHS[kind]; ++i) {
                double* line = system.line(row + i);
                const double scaled = (up + down) * stencil[i];
                for (int k = 0; k <= i; ++k) line[system.place(row + k)] += scaled * stencil[k];
            }
            if (!p.relaxing) return;
            for (int k = 0; k < WIDTHS[kind]; ++k)
                border[system.place(row + k)] -= POWERS[kind] * (up - down) * stencil[k];
            corner += POWERS[kind] * POWERS[kind] * (up + down);
        });
        for (int j = 0; j < n; ++j) system.line(j)[system.place(j)] += weights[2 * rows + j] + weights[2 * rows + n + j];
        system.factorise();
        if (p.relaxing) system.solve(border, border_solution);
    }

    // Solves for `right` into `step`; returns the part of s, whose right side is given.
    double solve_system(double wanted) {
        system.solve(right, step);
        if (!p.relaxing) return 0.0;
        double above = wanted, below = corner;
        for (int j = 0; j < n; ++j) {
            above -= border[system.place(j)] * step[system.place(j)];
            below -= border[system.place(j)] * border_solution[system.place(j)];
        }
        const double part = above / below;
        for (int i = 0; i < system.size(); ++i) step[i] -= part * border_solution[i];
        return part;
    }

    // Newton's step towards products t z of `target`; with what the last step left out, where that is known.
    void find_direction(double target, bool corrected) {
        for (int q = 0; q < many; ++q) {
            const double product = t[q] * z[q] + (corrected ? dt[q] * dz[q] : 0.0) - target;
            across[q] = (z[q] * gap[q] - product) * inverse[q];
        }
        std::fill(right.begin(), right.end(), 0.0);
        const double part = limits.transpose(system, across, right);
        for (int i = 0; i < system.size(); ++i) right[i] = -right[i] - residuals[i];
        ds = solve_system(-part - relaxation_residual);
        unpack(dx, dy);
        limits.apply(dx, ds, away);
        for (int q = 0; q < many; ++q) {
            dt[q] = -gap[q] - away[q];
            dz[q] = across[q] + weights[q] * away[q];
        }
    }

    // How far the step may go with slacks and multipliers above 0, and the mean product there.
    Steps advance_by(double share) const {
        double primal_step = 1.0 / share, dual_step = 1.0 / share;
        for (int q = 0; q < many; ++q) {
            if (t[q] + primal_step * dt[q] < 0.0) primal_step = -t[q] / dt[q];
            if (z[q] + dual_step * dz[q] < 0.0) dual_step = -z[q] / dz[q];
        }
        if (!p.relaxing) primal_step = dual_step = std::min(primal_step, dual_step);
        primal_step *= share;
        dual_step *= share;
        double sum = 0.0;
        for (int q = 0; q < many; ++q) sum += (t[q] + primal_step * dt[q]) * (z[q] + dual_step * dz[q]);
        return {primal_step, dual_step, sum / many};
    }

    void move(const Steps& steps) {
        for (int j = 0; j < n; ++j) x[j] += steps.primal * dx[j];
        s += steps.primal * ds;
        for (int k = 0; k < m; ++k) y[k] += steps.dual * dy[k];
        for (int q = 0; q < many; ++q) {
            t[q] += steps.primal * dt[q];
            z[q] += steps.dual * dz[q];
        }
    }

    const SplineProgram& p;
    const int n, m;  // control points, rows that are fixed
    const Inequalities limits;
    const int rows, many;  // rows of limits, inequalities
    TiedSystem system;
    Point best;  // the last one that is good enough
    std::vector<double> x, y, dx, dy;
    std::vector<double> t, z, gap, dt, dz, away, across, inverse, weights;  // (many,)
    std::vector<double> right, step, border, border_solution, residuals;  // (n + m,) in the places of the band
    double s = 0.0, ds = 0.0, corner = 1.0, relaxation_residual = 0.0, primal = 0.0, dual = 0.0, largest = 0.0;
    bool impossible = false;
};

}  // namespace kinesic::motion
