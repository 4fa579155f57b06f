// kinesic._kernel.motion: spline programs. Arrays are float64, positions int32, all of them contiguous.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "beyond_limits.h"
#include "free_motion.h"
#include "key_time_simplex.h"
#include "limit_peaks.h"
#include "nearest_motion.h"
#include "spline_sample.h"

namespace nb = nanobind;
using namespace kinesic::motion;

namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<double, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::c_contig, nb::device::cpu>;
using Marks = nb::ndarray<bool, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const int, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::vector<double> copy(const Numbers& from) { return {from.data(), from.data() + from.size()}; }

nb::object array(const std::vector<double>& from) {
    auto* data = new std::vector<double>(from);
    nb::capsule owner(data, [](void* held) noexcept { delete static_cast<std::vector<double>*>(held); });
    return nb::cast(nb::ndarray<nb::numpy, double, nb::ndim<1>>(data->data(), {data->size()}, owner));
}

void require(bool good) {
    if (!good) throw nb::value_error("arrays of a spline program have lengths or places that do not fit");
}

void fix(SplineProgram& program, const Places& first, const Numbers& shares, const Numbers& values) {
    require(first.size() == values.size() && shares.size() == 4 * values.size());
    for (size_t k = 0; k < first.size(); ++k) require(first.data()[k] >= 0 && first.data()[k] + 4 <= program.size);
    program.first.assign(first.data(), first.data() + first.size());
    program.shares = copy(shares);
    program.values = copy(values);
}

void want(SplineProgram& program, const Numbers& form, const Numbers& pull) {
    require(pull.size() == size_t(program.size) && form.size() > 0 && form.size() % pull.size() == 0);
    require(form.size() <= 4 * pull.size());
    program.form = copy(form);
    program.pull = copy(pull);
}

void limit(SplineProgram& program, const Numbers& stencils, const Numbers& lower, const Numbers& upper) {
    require(program.size >= 4 && lower.size() == size_t(program.size) && upper.size() == lower.size());
    require(stencils.size() == KINDS * 4);
    std::copy_n(stencils.data(), KINDS * 4, &program.stencils[0][0]);
    program.lower = copy(lower);
    program.upper = copy(upper);
}

// Computes the optimum without limits.
nb::object smooth(const Places& first, const Numbers& shares, const Numbers& values, const Numbers& form,
                  const Numbers& pull) {
    SplineProgram program;
    program.size = int(pull.size());
    fix(program, first, shares, values);
    want(program, form, pull);
    return array(free_optimum(program));
}

// Computes the unlimited motion of all hinges as control points (k + 3, n); returns the segments that exceed a limit.
std::vector<Beyond> free_motion(const Numbers& places, const Numbers& angles, const Flags& keyed, const Flags& firm,
                                const Numbers& desired, const Numbers& limits, const Numbers& closeness, double step,
                                double within, Result& controls) {
    require(angles.ndim() == 2 && desired.ndim() == 2 && desired.shape(0) > 1 && closeness.size() == 6);
    const size_t keys = angles.shape(0), hinges = angles.shape(1), knots = desired.shape(0);
    require(places.size() == keys && keyed.size() == keys * hinges && firm.size() == keys);
    require(desired.shape(1) == hinges && limits.size() == 8 * hinges && controls.size() == (knots + 2) * hinges);
    const FreeMotion motion = {int(keys),      int(hinges),  int(knots) - 1, step,           within,         places.data(),
                               angles.data(),  keyed.data(), firm.data(),    desired.data(), limits.data(), closeness.data(),
                               controls.data()};
    std::vector<Beyond> beyond;
    for (int hinge = 0; hinge < int(hinges); ++hinge) FreeHinge(motion, hinge).find(beyond);
    return beyond;
}

// Computes the optimum within limits; None if there is none.
nb::object nearest(const Places& first, const Numbers& shares, const Numbers& values, const Numbers& form,
                   const Numbers& pull, const Numbers& stencils, const Numbers& lower, const Numbers& upper) {
    SplineProgram program;
    program.size = int(pull.size());
    fix(program, first, shares, values);
    want(program, form, pull);
    limit(program, stencils, lower, upper);
    NearestMotion method(program);
    return method.solve() ? array(method.controls()) : nb::none();
}

// Computes the smallest relaxation of all limits: control points, relaxation, multipliers of equations and limit rows.
nb::object relax(const Places& first, const Numbers& shares, const Numbers& values, const Numbers& stencils,
                 const Numbers& lower, const Numbers& upper, double easy, double target) {
    SplineProgram program;
    program.size = int(lower.size());
    program.relaxing = true;
    program.easy = easy;
    program.target = target;
    fix(program, first, shares, values);
    limit(program, stencils, lower, upper);
    InteriorPoint method(program);
    if (!method.solve()) return nb::none();
    std::vector<double> pulls(program.rows());
    for (size_t k = 0; k < pulls.size(); ++k) pulls[k] = method.multiplier(int(k));
    return nb::make_tuple(array(method.controls()), method.relaxation(), array(method.ties()), array(pulls));
}

// Computes the shifts of key times (m,); None if the method fails.
nb::object move_keys(const Numbers& shares, const Numbers& broken, const Numbers& late, const Numbers& early,
                     const Numbers& penalties) {
    require(early.size() == late.size() && penalties.size() == broken.size() && shares.ndim() == 2);
    require(shares.shape(0) == broken.size() && shares.shape(1) == late.size());
    KeyTimeSimplex method(int(late.size()), int(broken.size()), shares.data(), broken.data(), late.data(), early.data(),
                          penalties.data());
    return method.solve() ? array(method.moves()) : nb::none();
}

// Computes angles, velocities and accelerations (m, n) at positions (m,); scales are powers of the knot interval.
void sample(const Numbers& controls, const Numbers& places, const Numbers& scales, Result& angles, Result& speeds,
            Result& accelerations) {
    require(controls.ndim() == 2 && controls.shape(0) >= 4 && scales.size() == 3);
    const size_t hinges = controls.shape(1), count = places.size();
    Result* const results[3] = {&angles, &speeds, &accelerations};
    for (int order = 0; order < 3; ++order) {
        require(results[order]->size() == count * hinges);
        sample_spline(controls.data(), int(controls.shape(0)) - 3, int(hinges), places.data(), count, order,
                      scales.data()[order], results[order]->data());
    }
}

// Computes the largest limit ratios of a motion (k + 3, n) with limits (7, n), with knot interval and sample (5, n), and the
// sum of its squared jerks; shares are the weights of control points at the samples, by derivative.
nb::tuple peaks(const Numbers& controls, const Numbers& scales, const Numbers& limits, const std::vector<Numbers>& shares) {
    require(controls.ndim() == 2 && controls.shape(0) >= 4 && scales.size() == 4 && shares.size() == 3);
    const size_t hinges = controls.shape(1);
    require(limits.size() == 7 * hinges);
    Instants instants{int(shares[0].shape(0)), {}};
    for (int order = 0; order < 3; ++order) {
        require(shares[order].size() == size_t(instants.count) * (4 - order));
        instants.shares[order] = shares[order].data();
    }
    std::vector<double> found[3];
    for (auto& rows : found) rows.resize(QUANTITIES * hinges);
    double squares = 0.0;
    for (size_t i = 0; i < hinges; ++i) {
        const auto limit = [&](int row) { return limits.data()[row * hinges + i]; };
        HingePeak best[QUANTITIES];
        find_peaks(controls.data() + i, hinges, int(controls.shape(0)) - 3, scales.data(),
                   {limit(0), limit(1), limit(2), limit(3), limit(4), limit(5), limit(6)}, instants, best, squares);
        for (int q = 0; q < QUANTITIES; ++q) {
            found[0][q * hinges + i] = best[q].ratio;
            found[1][q * hinges + i] = best[q].piece;
            found[2][q * hinges + i] = best[q].instant;
        }
    }
    return nb::make_tuple(array(found[0]), array(found[1]), array(found[2]), squares);
}

// Flags control points (h, k) of hinges that exceed limits (8, h) only in the new motion, not in `before` (h, k).
void beyond(const Numbers& controls, const Numbers& before, const Numbers& scales, const Numbers& limits, double full,
            Marks& flags) {
    require(controls.ndim() == 2 && before.size() == controls.size() && flags.size() == controls.size());
    const size_t hinges = controls.shape(0), size = controls.shape(1);
    require(scales.size() == 3 && limits.size() == 8 * hinges);
    for (size_t i = 0; i < hinges; ++i) {
        const auto limit = [&](int row) { return limits.data()[row * hinges + i]; };
        const HingeBounds bounds = {limit(0), limit(1), limit(2), limit(3), limit(4), limit(5), limit(6), limit(7)};
        const size_t at = i * size;
        flag_beyond(controls.data() + at, before.data() + at, int(size), scales.data(), bounds, full, flags.data() + at);
    }
}

}  // namespace

void bind_motion(nb::module_& module) {
    module.def("smooth", &smooth);
    module.def("free_motion", &free_motion);
    module.def("nearest", &nearest);
    module.def("relax", &relax);
    module.def("move_keys", &move_keys);
    module.def("sample", &sample);
    module.def("peaks", &peaks);
    module.def("beyond", &beyond);
}
