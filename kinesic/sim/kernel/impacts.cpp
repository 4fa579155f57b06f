// kinesic._kernel.sim.ImpactTree: impacts of a moving robot with a person, for `sim/impacts.py`.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/vector.h>

#include "impact_tree.h"

namespace nb = nanobind;
using namespace kinesic::sim;

void bind_impacts(nb::module_& module);

namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<double, nb::c_contig, nb::device::cpu>;
using FoundPoints = nb::ndarray<int64_t, nb::c_contig, nb::device::cpu>;

void require(bool good) {
    if (!good) throw nb::value_error("arrays of impacts have lengths or places that do not fit");
}

// Adds a link after its parent: hinges (t,) with axes and offsets (t, 3) and rotors (t,), and points (p, 3).
void add_link(ImpactTree& tree, int parent, const Numbers& origin, const Numbers& body, const std::vector<int>& joints,
              const Numbers& axes, const Numbers& offsets, const Numbers& armatures, const Numbers& points) {
    require(parent < int(tree.links.size()) && origin.size() == 3 && body.size() == 10 && points.size() % 3 == 0);
    require(axes.size() == 3 * joints.size() && offsets.size() == axes.size() && armatures.size() == joints.size());
    TreeLink link{parent, {}, body.data()[0], {}, {}, {}, {}};
    std::copy_n(origin.data(), 3, link.origin);
    std::copy_n(body.data() + 1, 3, link.centre);
    std::copy_n(body.data() + 4, 6, link.inertia);
    for (size_t k = 0; k < joints.size(); ++k) {
        require(joints[k] >= 0 && armatures.data()[k] > 0.0);
        TreeHinge hinge{joints[k], {}, {}, armatures.data()[k]};
        std::copy_n(axes.data() + 3 * k, 3, hinge.axis);
        std::copy_n(offsets.data() + 3 * k, 3, hinge.at);
        link.hinges.push_back(hinge);
    }
    for (size_t k = 0; k < points.size(); k += 3)
        link.points.push_back({points.data()[k], points.data()[k + 1], points.data()[k + 2]});
    tree.links.push_back(std::move(link));
}

size_t count_joints(const ImpactTree& tree, const Numbers& angles, size_t count) {
    const size_t joints = count ? angles.size() / count : 0;
    require(angles.size() == joints * count);
    for (const TreeLink& link : tree.links)
        for (const TreeHinge& hinge : link.hinges) require(!count || size_t(hinge.joint) < joints);
    return joints;
}

// Computes ratios and points (m, r), given angles and velocities (m, n), and rows of people (r,).
void survey(const ImpactTree& tree, const Numbers& angles, const Numbers& velocities, const Numbers& inverse_masses,
            const Numbers& squared_scales, double gate, Result& ratios, FoundPoints& points) {
    const size_t rows = inverse_masses.size(), count = rows ? ratios.size() / rows : 0;
    require(rows && squared_scales.size() == rows && ratios.size() == rows * count && points.size() == ratios.size());
    require(velocities.size() == angles.size());
    for (size_t r = 0; r < rows; ++r) require(inverse_masses.data()[r] > 0.0);
    const size_t joints = count_joints(tree, angles, count);
    const ImpactRows people{{inverse_masses.data(), inverse_masses.data() + rows},
                            {squared_scales.data(), squared_scales.data() + rows}};
    tree.survey(angles.data(), velocities.data(), joints, count, people, gate, ratios.data(), points.data());
}

// Computes the Jacobian (m, 3, n) of one point in each posture (m, n).
void jacobians(const ImpactTree& tree, const Numbers& angles, const Places& points, Result& columns) {
    const size_t joints = count_joints(tree, angles, points.size()), count = tree.count_points();
    require(columns.size() == 3 * angles.size());
    for (size_t k = 0; k < points.size(); ++k) require(points.data()[k] >= 0 && size_t(points.data()[k]) < count);
    tree.jacobians(angles.data(), joints, points.size(), points.data(), columns.data());
}

}  // namespace

void bind_impacts(nb::module_& module) {
    nb::class_<ImpactTree>(module, "ImpactTree")
        .def(nb::init<>())
        .def("add_link", &add_link)
        .def("survey", &survey)
        .def("jacobians", &jacobians);
}
