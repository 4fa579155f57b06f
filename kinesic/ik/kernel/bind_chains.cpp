// Python interface of ball chains: one solve, and many solves timed one by one.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "chain_methods.h"

namespace nb = nanobind;
namespace chains = kinesic::chains;

namespace {

constexpr int REPEATS = 3;  // repetitions of each timed solve; the shortest time counts, which excludes interruptions

using Rows3 = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Three = nb::ndarray<const double, nb::shape<3>, nb::c_contig, nb::device::cpu>;
using Points = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Rotations = nb::ndarray<double, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>;
using Counts = nb::ndarray<std::int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

std::vector<std::string> method_names() {
    std::vector<std::string> names;
    for (const auto& named : chains::METHODS) names.emplace_back(named.name);
    return names;
}

chains::Method method_of(const std::string& name) {
    std::string known;
    for (const auto& named : chains::METHODS) {
        if (name == named.name) return named.method;
        known += (known.empty() ? "" : ", ") + std::string(named.name);
    }
    throw std::invalid_argument("method \"" + name + "\" is unknown; known are " + known);
}

int bones_of(const Rows3& rest) {
    const auto bones = static_cast<std::int64_t>(rest.shape(0)) - 1;
    if (bones < 1 || bones > chains::MAX_BONES) {
        throw std::invalid_argument("rest has " + std::to_string(bones + 1) + " points; a chain has 2 to " +
                                    std::to_string(chains::MAX_BONES + 1));
    }
    for (std::int64_t i = 0; i < bones; ++i) {
        const double* p = rest.data() + 3 * i;
        const chains::Vector bone{p[3] - p[0], p[4] - p[1], p[5] - p[2]};
        if (!(norm(bone) > 0.0)) {  // false for NaN too
            throw std::invalid_argument("bone " + std::to_string(i) + " of rest has no length, or a point is not a " +
                                        "number; points " + std::to_string(i) + " and " + std::to_string(i + 1) +
                                        " must be finite and apart");
        }
    }
    return static_cast<int>(bones);
}

void same_rows(const char* name, std::size_t rows, std::size_t wanted) {
    if (rows != wanted) {
        throw std::invalid_argument(std::string(name) + " has " + std::to_string(rows) + " rows; it needs " +
                                    std::to_string(wanted));
    }
}

std::pair<int, double> solve_chain(const std::string& name, const Rows3& rest, const Three& target, const Points& out,
                                   const Rotations& rotations, double tolerance, int most) {
    const chains::Method method = method_of(name);
    const int bones = bones_of(rest);
    same_rows("out", out.shape(0), rest.shape(0));
    same_rows("rotations", rotations.shape(0), rest.shape(0) - 1);
    nb::gil_scoped_release released;
    const auto outcome =
        chains::solve(method, bones, rest.data(), target.data(), tolerance, most, out.data(), rotations.data());
    return {outcome.iterations, outcome.residual};
}

void run_chain(const std::string& name, const Rows3& rest, const Rows3& targets, double tolerance, int most,
               const Counts& iterations, const Numbers& residuals, const Numbers& nanoseconds) {
    using Clock = std::chrono::steady_clock;
    const chains::Method method = method_of(name);
    const int bones = bones_of(rest);
    const std::size_t count = targets.shape(0);
    same_rows("iterations", iterations.shape(0), count);
    same_rows("residuals", residuals.shape(0), count);
    same_rows("nanoseconds", nanoseconds.shape(0), count);
    nb::gil_scoped_release released;
    double points[3 * (chains::MAX_BONES + 1)], rotations[4 * chains::MAX_BONES];
    for (std::size_t i = 0; i < count; ++i) {
        double least = 0.0;
        for (int repeat = 0; repeat < REPEATS; ++repeat) {
            const auto began = Clock::now();
            const auto outcome = chains::solve(method, bones, rest.data(), targets.data() + 3 * i, tolerance, most,
                                               points, rotations);
            const std::chrono::duration<double, std::nano> spent = Clock::now() - began;
            least = repeat == 0 ? spent.count() : std::min(least, spent.count());
            iterations.data()[i] = outcome.iterations;
            residuals.data()[i] = outcome.residual;
        }
        nanoseconds.data()[i] = least;
    }
}

}  // namespace

void bind_chains(nb::module_& module) {
    module.def("chain_methods", &method_names);
    module.def("solve_chain", &solve_chain, nb::arg("method"), nb::arg("rest"), nb::arg("target"),
               nb::arg("out").noconvert(), nb::arg("rotations").noconvert(), nb::arg("tolerance"), nb::arg("most"));
    module.def("run_chain", &run_chain, nb::arg("method"), nb::arg("rest"), nb::arg("targets"), nb::arg("tolerance"),
               nb::arg("most"), nb::arg("iterations").noconvert(), nb::arg("residuals").noconvert(),
               nb::arg("nanoseconds").noconvert());
}
