// Sums and maxima of arrays in four lanes, because compilers keep the order of additions, which is slow in one lane.

#pragma once

#include <algorithm>
#include <cmath>

namespace kinesic::motion {

constexpr int LANES = 4;

// Returns the sum of value(i) for all i below a count.
template <typename Value>
double sum_of(int count, Value value) {
    double lanes[LANES] = {};
    int i = 0;
    for (; i + LANES <= count; i += LANES)
        for (int k = 0; k < LANES; ++k) lanes[k] += value(i + k);
    for (; i < count; ++i) lanes[0] += value(i);
    return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

// Returns the largest value(i), at least 0.
template <typename Value>
double largest_of(int count, Value value) {
    double lanes[LANES] = {};
    int i = 0;
    for (; i + LANES <= count; i += LANES)
        for (int k = 0; k < LANES; ++k) lanes[k] = std::max(lanes[k], value(i + k));
    for (; i < count; ++i) lanes[0] = std::max(lanes[0], value(i));
    return std::max(std::max(lanes[0], lanes[1]), std::max(lanes[2], lanes[3]));
}

}  // namespace kinesic::motion
