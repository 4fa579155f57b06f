// kinesic._kernel.controller: commands, correction and physics of a dry run in one loop.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <array>

#include "correction.h"
#include "twin_physics.h"

namespace nb = nanobind;
using namespace kinesic::controller;

namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Live = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

constexpr double SAME_COUPLING = 1e-9;  // relative difference to MuJoCo's matrix, or in 1/(kg m^2)

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

// Advances an estimate (7 + late, n) by one tick: inputs (10, n), deviation (n,) [rad] measured a tick before.
void advance(const Observer& observer, const Numbers& inputs, const Numbers& deviation, const Rows& belief) {
    const size_t n = size_t(observer.hinges);
    require(inputs.size() == INPUTS * n && deviation.size() == n && belief.size() == size_t(observer.rows()) * n);
    observe(observer, inputs.data(), deviation.data(), belief.data());
}

std::vector<Stage> stages(const Places& addresses) {
    std::vector<Stage> found;
    for (size_t k = 0; k < addresses.size(); ++k) found.push_back(reinterpret_cast<Stage>(addresses.data()[k]));
    return found;
}

// Lets a twin run the stages of mj_step while only friction constrains its (n,) hinges. It keeps whole steps if M^-1 + R is
// not the matrix that MuJoCo computed for the first posture. Arrays are those of `FrictionParts`.
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

// Creates the correction by an observer; constants: noticed fraction per tick, forgotten fraction, clear offset,
// largest correction.
Correction make_correction(const Observer& observer, const Numbers& lower, const Numbers& upper, const Numbers& constants) {
    require(lower.size() == observer.step.size() && upper.size() == lower.size() && constants.size() == 4);
    const double *given = constants.data(), clear = given[2] * given[2];
    return {observer, {copy(lower), copy(upper), given[0], given[1], clear, given[3]}};
}

// Continues with commands at (m,) times, given by angles, setpoints, load and velocity offsets (m, n), corrected if enabled.
// Returns the log of all steps of these commands.
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

}  // namespace

void bind_controller(nb::module_& module) {
    nb::class_<Observer>(module, "Observer");
    nb::class_<Correction>(module, "Correction");
    nb::class_<TwinPhysics>(module, "TwinPhysics");
    module.def("make_observer", &make_observer);
    module.def("advance", &advance);
    module.def("make_physics", &make_physics);
    module.def("split_steps", &split_steps);
    module.def("make_correction", &make_correction);
    module.def("perform", &perform, nb::arg(), nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg());
}
