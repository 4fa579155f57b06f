// kinesic.controller._kernel: commands, correction and physics of a dry run in one loop.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <array>
#include <optional>

#include "correction.h"
#include "twin_physics.h"

namespace nb = nanobind;
using namespace kinesic::controller;

namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Marks = nb::ndarray<const bool, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Live = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr double DEGREES = 180.0 / 3.14159265358979323846;
constexpr double SAME_COUPLING = 1e-9;  // relative to what MuJoCo finds, or to 1/(kg m^2)
constexpr double SHORTEST = 1e-3;  // [s] of a step that has a speed

std::vector<double> copy(const Numbers& from) { return {from.data(), from.data() + from.size()}; }

std::vector<int> copy(const Places& from, size_t below) {
    std::vector<int> places(from.data(), from.data() + from.size());
    for (int place : places)
        if (place < 0 || size_t(place) >= below) throw nb::value_error("a hinge has a place that MuJoCo does not have");
    return places;
}

template <typename Value>
nb::object array(std::vector<Value>&& from) {
    auto* held = new std::vector<Value>(std::move(from));
    nb::capsule owner(held, [](void* data) noexcept { delete static_cast<std::vector<Value>*>(data); });
    return nb::cast(nb::ndarray<nb::numpy, Value, nb::ndim<1>>(held->data(), {held->size()}, owner));
}

void require(bool good) {
    if (!good) throw nb::value_error("arrays of a dry run have lengths that do not fit");
}

Observer make_observer(const Numbers& forecast, const Numbers& gain, const Numbers& step, const Numbers& full,
                       const Numbers& arrival, const Numbers& constants) {
    Observer made;
    made.hinges = int(step.size());
    made.late = int(arrival.size());
    require(made.late > 0 && forecast.size() == 9 * step.size() && gain.size() == 3 * step.size());
    require(full.size() == step.size() && constants.size() == 6);
    made.forecast = copy(forecast);
    made.gain = copy(gain);
    made.step = copy(step);
    made.full = copy(full);
    made.arrival = copy(arrival);
    std::copy_n(constants.data(), 3, made.restoring);
    made.lightest = constants.data()[3];
    made.heaviest = constants.data()[4];
    made.fading = constants.data()[5];
    return made;
}

std::vector<Stage> stages(const Places& addresses) {
    std::vector<Stage> found;
    for (size_t k = 0; k < addresses.size(); ++k) found.push_back(reinterpret_cast<Stage>(addresses.data()[k]));
    return found;
}

// Has a twin do stages of mj_step wherever friction alone constrains its (n,) hinges. Its steps stay whole if M^-1 + R is not
// the matrix that MuJoCo has made for the first posture. Arrays are those of `FrictionParts`.
void split_steps(TwinPhysics& twin, const Places& before, const Places& after, const Numbers& lower, const Numbers& upper,
                 const Places& begins, const Places& ends, const Places& columns, const Live& positions,
                 const Live& factor, const Live& inverse_d, const Live& softness, const Live& matrix) {
    const size_t n = lower.size(), count = factor.size();
    require(upper.size() == n && positions.size() == n && inverse_d.size() == n && softness.size() == n);
    require(begins.size() == n && ends.size() == n && columns.size() == count && matrix.size() == n * n);
    FrictionStep made;
    made.before = stages(before);
    made.after = stages(after);
    made.inertia = {factor.data(), inverse_d.data(), copy(begins, count), copy(ends, count), copy(columns, n)};
    made.lower = copy(lower);
    made.upper = copy(upper);
    made.positions = positions.data();
    made.softness = softness.data();
    made.matrix = matrix.data();
    const std::vector<double> known(made.matrix, made.matrix + n * n);
    made.couple();
    const bool same = std::equal(known.begin(), known.end(), made.matrix, [](double a, double b) {
        return std::abs(a - b) <= SAME_COUPLING * std::max(std::abs(a), 1.0);
    });
    if (same) twin.step.friction = std::move(made);
}

TwinPhysics make_physics(uintptr_t step, uintptr_t model, uintptr_t data, uintptr_t clock, uintptr_t timestep,
                         const Live& positions, const Live& speeds, const Live& control, const Places& hinges,
                         const Places& play, const Places& actuators, const Numbers& ticks, double longest,
                         double latency) {
    TwinPhysics made;
    require(step && model && data && timestep && speeds.size() == positions.size() && longest > 0.0);
    require(actuators.size() == hinges.size() && (!play.size() || play.size() == hinges.size()));
    require(!ticks.size() || ticks.size() == hinges.size());
    made.step.whole = reinterpret_cast<Stage>(step);
    made.step.model = reinterpret_cast<void*>(model);
    made.step.data = reinterpret_cast<void*>(data);
    made.step.clock = reinterpret_cast<Clock*>(clock);
    made.timestep = reinterpret_cast<double*>(timestep);
    made.positions = positions.data();
    made.speeds = speeds.data();
    made.control = control.data();
    made.size = int(positions.size());
    made.hinges = copy(hinges, positions.size());
    made.play = copy(play, positions.size());
    made.actuators = copy(actuators, control.size());
    made.ticks = copy(ticks);
    for (int place : made.actuators) made.goals.push_back(made.control[place]);
    made.longest = longest;
    made.latency = latency;
    return made;
}

// Makes the correction by an observer; constants: share that is noticed a tick, share that is forgotten, lead that is clear,
// largest correction.
Correction make_correction(const Observer& observer, const Numbers& lower, const Numbers& upper, const Numbers& constants) {
    require(lower.size() == observer.step.size() && upper.size() == lower.size() && constants.size() == 4);
    const double *given = constants.data(), clear = given[2] * given[2];
    return {observer, {copy(lower), copy(upper), given[0], given[1], clear, given[3]}};
}

// Goes on with commands at (m,) times, led by angles, goals, loads and leads (m, n), which are corrected if somebody does.
// Gives all that the steps of these commands left.
nb::tuple perform(TwinPhysics& twin, const Numbers& times, const std::array<Numbers, 4>& led, Correction* correction,
                  const nb::callable& progress, int every) {
    const size_t hinges = twin.hinges.size(), count = times.size();
    require(count > 0 && every > 0 && (!correction || size_t(correction->hinges()) == hinges));
    for (const Numbers& rows : led) require(rows.size() == count * hinges);
    twin.begin(times.data()[0]);
    double before = twin.time;
    for (size_t k = 0; k < count; before = times.data()[k++])
        if (!std::isfinite(times.data()[k]) || times.data()[k] < before - SAME_TIME)
            throw nb::value_error("times of commands must be finite and not decrease");
    std::vector<double> measured(hinges);
    for (size_t k = 0; k < count; ++k) {
        const auto row = [&](int part) { return led[part].data() + k * hinges; };
        const double* wanted = row(1);
        if (correction) {
            twin.read(measured.data());
            wanted = correction->correct({row(0), row(1), row(2), row(3)}, measured.data());
        }
        twin.write(times.data()[k], wanted);
        if (k % every == 0) progress(k);
    }
    return nb::make_tuple(array(std::move(twin.angles_kept)), array(std::move(twin.speeds_kept)),
                          array(std::move(twin.spans)), array(std::move(twin.aimed)), array(std::move(twin.counts)),
                          array(std::move(twin.sent)));
}

// First time within a window about `at` at which a path (m, d) at (m,) times is inside a ball, between samples on a straight
// line; None where it never is.
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

// The value below which a share of unsorted values is, between two of them on a straight line.
double percentile(std::vector<double>& values, double share) {
    const double place = share * double(values.size() - 1), whole = std::floor(place), part = place - whole;
    const auto at = values.begin() + std::ptrdiff_t(whole);
    std::nth_element(values.begin(), at, values.end());
    if (at + 1 == values.end()) return *at;
    const double here = *at, after = *std::min_element(at + 1, values.end());
    return part < 0.5 ? here + (after - here) * part : after - (after - here) * (1.0 - part);
}

// Errors [deg] of hinges as long as they move, sample after sample: root mean square, 95th percentile, largest; its row and
// hinge, and the hinge whose squares sum up to most.
nb::tuple tracking_errors(const Numbers& found, const Marks& moving) {
    const size_t count = moving.size(), hinges = moving.shape(1);
    std::vector<double> errors, squares(hinges, 0.0);
    errors.reserve(found.size());
    double sum = 0.0, largest = -1.0;
    size_t place = 0;
    for (size_t k = 0; k < count; ++k) {
        if (!moving.data()[k]) continue;
        require(errors.size() < found.size());
        const double error = std::abs(found.data()[errors.size()]) * DEGREES;
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

// The largest speed on a path (m, d) at (m,) times from one moment to another, and its length; on straight lines between.
std::pair<double, double> measure_stretch(const Numbers& times, const Numbers& path, double begin, double end) {
    const size_t count = times.size(), size = count ? path.size() / count : 0;
    require(count > 1 && path.size() == count * size);
    const double* all = times.data();
    const auto place = [&](double moment, double* to) {
        const size_t after = std::clamp<size_t>(std::upper_bound(all, all + count, moment) - all, 1, count - 1);
        const double *here = path.data() + (after - 1) * size, *there = here + size;
        const double share = std::clamp((moment - all[after - 1]) / (all[after] - all[after - 1]), 0.0, 1.0);
        for (size_t i = 0; i < size; ++i) to[i] = here[i] + share * (there[i] - here[i]);
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
        const double way = std::sqrt(squares);
        length += way;
        if (next - time > SHORTEST) fastest = std::max(fastest, way / (next - time));
        before = now;
        time = next;
    }
    return {fastest, length};
}

}  // namespace

NB_MODULE(_kernel, module) {
    nb::class_<Observer>(module, "Observer");
    nb::class_<Correction>(module, "Correction");
    nb::class_<TwinPhysics>(module, "TwinPhysics");
    module.def("make_observer", &make_observer);
    module.def("make_physics", &make_physics);
    module.def("split_steps", &split_steps);
    module.def("make_correction", &make_correction);
    module.def("first_entry", &first_entry);
    module.def("tracking_errors", &tracking_errors);
    module.def("measure_stretch", &measure_stretch);
    module.def("perform", &perform, nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg());
}
