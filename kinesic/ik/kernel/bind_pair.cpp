// Python interface for both hands. It accepts only finite float64 of the right size.

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arm_class.h"
#include "pair_reach.h"
#define NO_IMPORT_ARRAY  // bind_arm.cpp fills NumPy's table
#include "bind_arrays.h"

namespace nb = nanobind;

namespace kinesic::pair {

namespace {

using Triple = std::array<double, 3>;
using Hinges = std::vector<std::tuple<int, Triple, Triple>>;  // joint, axis, point on the axis [m]
using Parts = std::vector<std::pair<Triple, Hinges>>;         // offset [m], hinges
using Numbers = std::vector<double>;
using Joints = std::vector<int>;

struct Pair {
    Body body;
    nb::object arms[2];  // references that keep the arms alive
};

Vector vector(const Triple& p) { return {p[0], p[1], p[2]}; }

Strand strand(const Parts& parts, int joints) {
    Strand made;
    if (parts.size() > MAX_SEGMENTS) throw std::invalid_argument("a strand has at most 24 parts");
    for (const auto& [offset, hinges] : parts) {
        made.offset[made.parts] = vector(offset);
        for (const auto& [joint, axis, at] : hinges) {
            if (made.hinges == MAX_HINGES || joint < 0 || joint >= joints)
                throw std::invalid_argument("a strand has at most 48 hinges, all of the robot");
            made.hinge[made.hinges++] = {joint, Pivot(vector(axis), 0.0, 0.0, 0.0), vector(at)};
        }
        made.end[made.parts++] = made.hinges;
    }
    return made;
}

// All pairs are ordered left, right.
void pack(Pair* self, const Numbers& lower, const Numbers& upper, const Joints& torso, double length,
          const std::vector<nb::object>& arms, const std::vector<Joints>& joints, const std::vector<Parts>& bases,
          const std::vector<Parts>& hands) {
    const size_t count = lower.size();
    if (count > MAX_JOINTS || upper.size() != count || torso.size() > MAX_TORSO_HINGES || arms.size() != 2 ||
        joints.size() != 2 || bases.size() != 2 || hands.size() != 2)
        throw std::invalid_argument("a robot has at most 128 hinges, 6 of them in its torso, and two arms");
    Pair* pair = new (self) Pair();
    Body& body = pair->body;
    body.joints = int(count);
    body.length = length;
    std::copy(lower.begin(), lower.end(), body.lower);
    std::copy(upper.begin(), upper.end(), body.upper);
    body.torso_joints = int(torso.size());
    std::copy(torso.begin(), torso.end(), body.torso);
    for (int side = 0; side < 2; ++side) {
        const auto& arm = nb::cast<const arm::Arm&>(arms[side]);
        if (int(joints[side].size()) != arm.linkage.hinges) throw std::invalid_argument("an arm has a joint each");
        pair->arms[side] = arms[side];
        Limb& limb = body.limb[side];
        limb.linkage = &arm.linkage, limb.rest = arm.rest, limb.mobility = arm.mobility, limb.mirrored = arm.mirrored;
        std::copy(joints[side].begin(), joints[side].end(), limb.joint);
        limb.base = strand(bases[side], body.joints);
        limb.hand = strand(hands[side], body.joints);
    }
    for (const Joints& own : {torso, joints[0], joints[1]})
        for (const int joint : own)
            if (joint < 0 || joint >= body.joints) throw std::invalid_argument("a joint is none of the robot");
}

// Returns angles, both residuals, torso travel, iterations. `first`: 0 left, 1 right, -1 none. None: refused.
nb::object reach_both(const Pair& pair, nb::handle left, nb::handle right, nb::handle start, double torso_weight,
                      int first) {
    TwoHandTargets wanted;
    const nb::handle targets[2] = {left, right};
    for (int side = 0; side < 2; ++side) {
        double place[3];
        if (!read(targets[side], place, 3)) throw nb::value_error("a target needs 3 finite numbers in a float64 array");
        wanted.target[side] = {place[0], place[1], place[2]};
    }
    const Body& body = pair.body;
    if (!read(start, wanted.present, body.joints))
        throw nb::value_error("the start needs a finite angle for each hinge in a float64 array");
    for (int k = 0; k < body.joints; ++k)
        wanted.present[k] = std::max(body.lower[k], std::min(body.upper[k], wanted.present[k]));
    wanted.torso_weight = torso_weight;
    wanted.first = first;
    TwoHandSolution both;
    {
        nb::gil_scoped_release free;
        both = reach(body, wanted);
    }
    return nb::make_tuple(sealed(both.angles, body.joints), both.residual[0], both.residual[1], both.travel,
                          both.rounds);
}

}  // namespace

}  // namespace kinesic::pair

void bind_pairs(nb::module_& module) {
    using namespace kinesic::pair;
    nb::class_<Pair>(module, "Pair")
        .def("__init__", &pack, nb::kw_only(), nb::arg("lower"), nb::arg("upper"), nb::arg("torso"), nb::arg("length"),
             nb::arg("arms"), nb::arg("joints"), nb::arg("bases"), nb::arg("hands"))
        .def("reach", &reach_both, nb::arg("left").none(), nb::arg("right").none(), nb::arg("start").none(),
             nb::arg("torso_weight"), nb::arg("first"));
}
