// Motion of all hinges nearest to a desired one, without limits, for `motion/spline_program.py`.
//
// Each hinge's motion is split where it rests (`motion/segments.py`), and each segment is one banded solve.

#pragma once

#include <tuple>

#include "nearest_motion.h"

namespace kinesic::motion {

constexpr double HOLD_TOLERANCE = 1e-9;  // [rad] successive keys that differ by less form a hold
constexpr double REST_MARGIN = 0.02;     // [knot intervals] before a rest in which a hinge hardly moves
constexpr int MIN_HOLD = 40;             // [knot intervals] shortest hold with a rest in its middle
constexpr int LONG_HOLD = 100;           // [knot intervals] at each end of a long hold in which the hinge may still move
constexpr double MIN_RANGE = 1e-9;       // [rad] assumed range of a hinge that cannot move

using Rest = std::tuple<int, int, double>;           // knot, previous key of the hinge (-1: none), angle [rad]
using Beyond = std::tuple<double, int, Rest, Rest>;  // limit ratio, hinge, begin and end of its segment

// Input and output of the search: (m, n) keys, (k + 1, n) desired angles, (k + 3, n) control points, row by row.
struct FreeMotion {
    int keys, hinges, pieces;
    double step, within;        // [s]; largest limit ratio that counts as within limits
    const double* places;       // (m,) key times [knot intervals]
    const double* angles;       // (m, n) [rad]
    const bool *keyed, *firm;   // (m, n), (m,)
    const double* desired;      // (k + 1, n) [rad]
    const double* limits;       // (8, n) lower, upper, speed, acceleration, jerk, inertial, viscous, duty
    const double* closeness;    // (2, 3) stencils whose squares sum to the distance from the desired motion
    double* controls;           // (k + 3, n) [rad]
};

class FreeHinge {
  public:
    FreeHinge(const FreeMotion& motion, int hinge) : all(motion), hinge(hinge) {
        bool path = false;
        for (int row = 0; row < all.keys; ++row) {
            if (!all.keyed[size_t(row) * all.hinges + hinge]) continue;
            if (all.firm[row]) {
                if (!places_.empty()) led_.push_back(path);
                path = false;
                places_.push_back(all.places[row]);
                angles_.push_back(all.angles[size_t(row) * all.hinges + hinge]);
            } else {
                path = true;
            }
        }
    }

    // Computes the control points, and lists the segments that exceed a limit.
    void find(std::vector<Beyond>& beyond) const {
        const std::vector<Rest> rests = cut();
        for (size_t k = 0; k + 1 < rests.size(); ++k) {
            const double share = find_segment(rests[k], rests[k + 1]);
            if (share > all.within) beyond.emplace_back(share, hinge, rests[k], rests[k + 1]);
        }
    }

  private:
    // Adds rests at both ends of the motion, in the middle of each hold, and at both sides of a long hold.
    std::vector<Rest> cut() const {
        std::vector<Rest> rests = {{0, -1, angles_.front()}};
        for (size_t k = 0; k + 1 < angles_.size(); ++k) {
            if (!(std::abs(angles_[k + 1] - angles_[k]) < HOLD_TOLERANCE) || led_[k]) continue;
            const double begin = places_[k], end = places_[k + 1];
            if (end - begin > 2 * LONG_HOLD + MIN_HOLD) {
                rests.emplace_back(int(std::nearbyint(begin)) + LONG_HOLD, int(k), angles_[k]);
                rests.emplace_back(int(std::nearbyint(end)) - LONG_HOLD, int(k), angles_[k]);
            } else if (end - begin >= MIN_HOLD) {
                rests.emplace_back(int(std::nearbyint((begin + end) / 2)), int(k), angles_[k]);
            }
        }
        rests.emplace_back(all.pieces, int(angles_.size()) - 1, angles_.back());
        return rests;
    }

    // Computes the control points of a segment, and returns their largest limit ratio.
    double find_segment(const Rest& begin, const Rest& end) const {
        const auto [first, before, start] = begin;
        const auto [last, after, rest] = end;
        std::vector<int> inner;
        bool still = std::abs(rest - start) < HOLD_TOLERANCE;
        for (int k = std::max(before, 0); k < after; ++k) still = still && !led_[k];
        for (int k = before + 1; k <= after; ++k) {
            if (!(first + REST_MARGIN < places_[k] && places_[k] < last - REST_MARGIN)) continue;
            inner.push_back(k);
            still = still && std::abs(angles_[k] - start) < HOLD_TOLERANCE;
        }
        const int size = last - first + 3;
        std::vector<double> points(size, start);
        if (!still) points = solve(first, size, inner, start, rest);
        double* into = all.controls + size_t(first) * all.hinges + hinge;
        for (int j = 0; j < size; ++j) into[size_t(j) * all.hinges] = points[j];
        return largest_share(points);
    }

    std::vector<double> solve(int first, int size, const std::vector<int>& inner, double start, double rest) const {
        SplineProgram program;
        program.size = size;
        const int pieces = size - 3;
        for (int k : inner) tie_key(program, places_[k] - first, pieces, angles_[k]);
        if (!inner.empty() && places_[inner.back()] - first > pieces - 1)  // a key in the last interval is the rest
            std::copy_n(std::begin({1.0, 0.0, 0.0, 0.0}), 4, program.shares.end() - 4);
        for (int d = 0; d < 3; ++d) tie(program, 0, d, start);
        for (int d = 0; d < 3; ++d) tie(program, size - 4, d + 1, rest);
        program.form.assign(3 * size_t(size), 0.0);
        for (int k = 0; k < 2; ++k) add_squares(program.form, size, all.closeness + 3 * k);
        program.pull.assign(size, 0.0);
        for (int j = 0; j <= pieces; ++j) {
            const double wish = all.desired[size_t(first + j) * all.hinges + hinge];
            for (int d = 0; d < 3; ++d) program.pull[j + d] += (d == 1 ? 4.0 : 1.0) / 6.0 * wish;
        }
        return free_optimum(program);
    }

    static void tie(SplineProgram& program, int first, int which, double value) {
        program.first.push_back(first);
        for (int d = 0; d < 4; ++d) program.shares.push_back(d == which ? 1.0 : 0.0);
        program.values.push_back(value);
    }

    static void tie_key(SplineProgram& program, double where, int pieces, double angle) {
        const double place = std::min(std::max(where, 0.0), double(pieces));
        const int piece = std::min(int(place), pieces - 1);
        const double u = place - piece, v = 1.0 - u;
        program.first.push_back(piece);
        program.shares.insert(program.shares.end(), {v * v * v / 6, (3 * (u * u * u) - 6 * (u * u) + 4) / 6,
                                                     (3 * (v * v * v) - 6 * (v * v) + 4) / 6, u * u * u / 6});
        program.values.push_back(angle);
    }

    // Adds the squares of a stencil at all positions to a quadratic form (3, n).
    static void add_squares(std::vector<double>& form, int size, const double* stencil) {
        for (int column = 0; column < 3; ++column)
            for (int row = 0; row <= column; ++row)
                for (int j = column; j < column + size - 2; ++j)
                    form[size_t(2 - (column - row)) * size + j] += stencil[column] * stencil[row];
    }

    double limit(int row) const { return all.limits[row * all.hinges + hinge]; }

    // Returns the largest ratio of a spline to its limits of range, velocity, acceleration, jerk and duty.
    double largest_share(const std::vector<double>& points) const {
        const double middle = (limit(1) + limit(0)) / 2, half = std::max(limit(1) - limit(0), MIN_RANGE) / 2, h = all.step;
        const double duty = limit(7) - limit(6) * limit(4) * (h * h) / 8;
        const int size = int(points.size());
        double away = 0.0, speed = 0.0, acceleration = 0.0, jerk = 0.0, pulling = 0.0;
        for (int j = 0; j < size; ++j) {
            away = std::max(away, std::abs(points[j] - middle));
            if (j < 1) continue;
            const double once = points[j] - points[j - 1];
            speed = std::max(speed, std::abs(once));
            if (j < 2) continue;
            const double earlier = points[j - 1] - points[j - 2], twice = once - earlier;
            acceleration = std::max(acceleration, std::abs(twice));
            pulling = std::max(pulling, std::abs(limit(5) * (twice / (h * h)) + limit(6) * ((earlier + once) / h) / 2));
            if (j < 3) continue;
            jerk = std::max(jerk, std::abs(twice - (earlier - (points[j - 2] - points[j - 3]))));
        }
        return std::max({away / half, speed / h / limit(2), acceleration / (h * h) / limit(3),
                         jerk / (h * h * h) / limit(4), pulling / duty});
    }

    const FreeMotion& all;
    const int hinge;
    std::vector<double> places_, angles_;  // times and angles of the hinge's exact keys
    std::vector<char> led_;                // whether a path connects each exact key to the next
};

}  // namespace kinesic::motion
