// Largest limit ratios of a motion at sample times of each knot interval, for `motion/limit_check.py`.
//
// A spline lies within the hull of its control points, so that most intervals need no samples below the maximum.

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinesic::motion {

constexpr int QUANTITIES = 5;  // position, velocity, acceleration, jerk, duty

struct HingePeak {
    double ratio = 0.0;
    int piece = 0, instant = 0;
};

// Weights (s, 4 - order) of the control points at sample times of a knot interval, by derivative.
struct Instants {
    int count = 0;
    const double* shares[3] = {};
};

// Control points of a spline, (4 - order) per knot interval.
struct Part {
    std::vector<double> points;
    int order = 0;
};

// Replaces values by larger ones.
inline void raise(double* __restrict values, const double* __restrict others, int count) {
    for (int k = 0; k < count; ++k) values[k] = others[k] > values[k] ? others[k] : values[k];
}

// Finds the largest magnitude of a sum of splines at the sample times of all knot intervals.
inline HingePeak find_peak(const std::vector<const Part*>& parts, int pieces, const Instants& instants) {
    static const double constant = 1.0;
    std::vector<double> bounds(pieces, 0.0), largest(pieces), sizes;
    for (const Part* part : parts) {  // row by row, for SIMD lanes
        sizes.resize(part->points.size());
        for (size_t k = 0; k < sizes.size(); ++k) sizes[k] = std::abs(part->points[k]);
        std::copy_n(sizes.begin(), pieces, largest.begin());
        for (int j = 1; j < 4 - part->order; ++j) raise(largest.data(), sizes.data() + j, pieces);
        for (int k = 0; k < pieces; ++k) bounds[k] += largest[k];
    }
    const bool still = parts[0]->order == 3;  // whether the quantity, a jerk, is constant between knots
    HingePeak best;
    const auto look = [&](int piece, bool first) {
        for (int s = 0; s < (still ? 1 : instants.count); ++s) {
            double value = 0.0;
            for (const Part* part : parts) {
                const int count = 4 - part->order;
                const double* shares = still ? &constant : instants.shares[part->order] + s * count;
                double sum = 0.0;
                for (int j = 0; j < count; ++j) sum += shares[j] * part->points[piece + j];
                value += sum;
            }
            const double ratio = std::abs(value);
            if (first || ratio > best.ratio || (ratio == best.ratio && piece < best.piece)) best = {ratio, piece, s};
            first = false;
        }
    };
    look(int(std::max_element(bounds.begin(), bounds.end()) - bounds.begin()), true);
    for (int k = 0; k < pieces; ++k)
        if (bounds[k] >= best.ratio) look(k, false);
    return best;
}

// Divisors of each quantity of a hinge, and coefficients of its duty.
struct HingeLimits {
    double middle, half, speed, acceleration, jerk;  // [rad], [rad], [rad/s], ...
    double pulled, driven;                           // duty / duty limit per acceleration, and per velocity
};

// Computes the peaks of one hinge's spline, with control points `stride` apart, and adds its squared jerks.
inline void find_peaks(const double* controls, size_t stride, int pieces, const double* scales, const HingeLimits& limits,
                       const Instants& instants, HingePeak* peaks, double& squares) {
    std::vector<double> differences[4];
    for (int order = 0; order < 4; ++order) differences[order].resize(pieces + 3 - order);
    for (int k = 0; k < pieces + 3; ++k) differences[0][k] = controls[k * stride];
    for (int order = 1; order < 4; ++order)
        for (int k = 0; k < pieces + 3 - order; ++k)
            differences[order][k] = differences[order - 1][k + 1] - differences[order - 1][k];
    const auto make = [&](int order, auto scale) {
        Part part{differences[order], order};
        for (double& point : part.points) point = scale(point / scales[order]);
        return part;
    };
    for (double jerk : differences[3]) squares += jerk / scales[3] * (jerk / scales[3]);
    const Part parts[] = {
        make(0, [&](double x) { return (x - limits.middle) / limits.half; }),
        make(1, [&](double x) { return x / limits.speed; }),
        make(2, [&](double x) { return x / limits.acceleration; }),
        make(3, [&](double x) { return x / limits.jerk; }),
        make(2, [&](double x) { return limits.pulled * x; }),
        make(1, [&](double x) { return limits.driven * x; }),
    };
    for (int q = 0; q < QUANTITIES - 1; ++q) peaks[q] = find_peak({&parts[q]}, pieces, instants);
    peaks[QUANTITIES - 1] = find_peak({&parts[4], &parts[5]}, pieces, instants);
}

}  // namespace kinesic::motion
