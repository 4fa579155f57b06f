// kinesic._kernel.metrics: arrivals, lengths and tracking errors of sampled paths. Arrays are contiguous.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Marks = nb::ndarray<const bool, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

constexpr double DEGREES_PER_RADIAN = 180.0 / 3.14159265358979323846;
constexpr double MIN_STEP_DURATION = 1e-3;  // [s] shortest step with a defined speed

void require(bool good) {
    if (!good) throw nb::value_error("arrays of a dry run have lengths that do not fit");
}

// Returns the first time in a window around `at` at which a path (m, d), linearly interpolated between (m,) times, is
// inside a ball; None if it never is.
std::optional<double> first_entry(const Numbers& times, const Numbers& path, double at, double window,
                                  const Numbers& centre, double radius) {
    const size_t count = times.size(), size = centre.size();
    require(path.size() == count * size);
    const double *all = times.data(), *begin = std::lower_bound(all, all + count, at - window);
    const double* end = std::lower_bound(begin, all + count, at + window);
    double outer = 0.0;
    for (const double* now = begin; now < end; ++now) {
        const double* place = path.data() + (now - all) * size;
        double squares = 0.0;
        for (size_t k = 0; k < size; ++k) squares += (place[k] - centre.data()[k]) * (place[k] - centre.data()[k]);
        const double distance = std::sqrt(squares);
        if (distance <= radius) {
            if (now == begin) return *now;
            return now[-1] + (outer - radius) / (outer - distance) * (now[0] - now[-1]);
        }
        outer = distance;
    }
    return std::nullopt;
}

// Returns a quantile of unsorted values, linearly interpolated.
double percentile(std::vector<double>& values, double fraction) {
    const double place = fraction * double(values.size() - 1), whole = std::floor(place), part = place - whole;
    const auto at = values.begin() + std::ptrdiff_t(whole);
    std::nth_element(values.begin(), at, values.end());
    if (at + 1 == values.end()) return *at;
    const double here = *at, after = *std::min_element(at + 1, values.end());
    return part < 0.5 ? here + (after - here) * part : after - (after - here) * (1.0 - part);
}

// Returns the errors [deg] of moving hinges: root mean square, 95th percentile, maximum with its row and hinge, and the
// hinge with the largest sum of squares.
nb::tuple tracking_errors(const Numbers& found, const Marks& moving) {
    const size_t count = moving.size(), hinges = moving.shape(1);
    std::vector<double> errors, squares(hinges, 0.0);
    errors.reserve(found.size());
    double sum = 0.0, largest = -1.0;
    size_t place = 0;
    for (size_t k = 0; k < count; ++k) {
        if (!moving.data()[k]) continue;
        require(errors.size() < found.size());
        const double error = std::abs(found.data()[errors.size()]) * DEGREES_PER_RADIAN;
        errors.push_back(error);
        sum += error * error;
        squares[k % hinges] += error * error;
        if (error > largest) largest = error, place = k;
    }
    require(!errors.empty() && errors.size() == found.size());
    const auto most = std::max_element(squares.begin(), squares.end()) - squares.begin();
    const double rmse = std::sqrt(sum / double(errors.size())), high = percentile(errors, 0.95);
    return nb::make_tuple(rmse, high, largest, place / hinges, place % hinges, most);
}

// Returns the largest speed and the length of a path (m, d), linearly interpolated between (m,) times, from `begin` to
// `end`.
std::pair<double, double> measure_stretch(const Numbers& times, const Numbers& path, double begin, double end) {
    const size_t count = times.size(), size = count ? path.size() / count : 0;
    require(count > 1 && path.size() == count * size);
    const double* all = times.data();
    const auto place = [&](double moment, double* to) {
        const size_t after = std::clamp<size_t>(std::upper_bound(all, all + count, moment) - all, 1, count - 1);
        const double *here = path.data() + (after - 1) * size, *there = here + size;
        const double ratio = std::clamp((moment - all[after - 1]) / (all[after] - all[after - 1]), 0.0, 1.0);
        for (size_t i = 0; i < size; ++i) to[i] = here[i] + ratio * (there[i] - here[i]);
    };
    std::vector<double> edges(2 * size);
    place(begin, edges.data());
    place(end, edges.data() + size);
    const size_t first = std::upper_bound(all, all + count, begin) - all, last = std::lower_bound(all, all + count, end) - all;
    const double* before = edges.data();
    double time = begin, fastest = 0.0, length = 0.0;
    for (size_t k = first; k <= std::max(first, last); ++k) {
        const bool ends = k >= last;
        const double *now = ends ? edges.data() + size : path.data() + k * size, next = ends ? end : all[k];
        double squares = 0.0;
        for (size_t i = 0; i < size; ++i) squares += (now[i] - before[i]) * (now[i] - before[i]);
        const double distance = std::sqrt(squares);
        length += distance;
        if (next - time > MIN_STEP_DURATION) fastest = std::max(fastest, distance / (next - time));
        before = now;
        time = next;
    }
    return {fastest, length};
}

}  // namespace

void bind_metrics(nb::module_& module) {
    module.def("first_entry", &first_entry);
    module.def("tracking_errors", &tracking_errors);
    module.def("measure_stretch", &measure_stretch);
}
