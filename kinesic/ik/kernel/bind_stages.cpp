// Python interface of single stages, which tests compare with their reference.

#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>
#include <vector>

#include "arm_class.h"
#include "arm_track.h"

namespace kinesic::arm {

namespace {

using Triple = std::array<double, 3>;
using Triples = std::vector<Triple>;
using Numbers = std::vector<double>;

Vector vector(const Triple& p) { return {p[0], p[1], p[2]}; }
Triple triple(const Vector& p) { return {p.x, p.y, p.z}; }

struct Points {
    Vector at[MAX_LINKS + 1];
    explicit Points(const Triples& given) {
        if (given.size() > MAX_LINKS + 1) throw std::invalid_argument("too many points");
        for (size_t i = 0; i < given.size(); ++i) at[i] = vector(given[i]);
    }
};

Triples triples(const Vector* points, int count) {
    Triples listed;
    for (int i = 0; i < count; ++i) listed.push_back(triple(points[i]));
    return listed;
}

struct Angles {  // angles of all hinges; missing ones are zero
    double at[MAX_HINGES] = {};
    explicit Angles(const Numbers& given) {
        if (given.size() > MAX_HINGES) throw std::invalid_argument("too many angles");
        std::copy(given.begin(), given.end(), at);
    }
};

Numbers numbers(const double* values, int count) { return {values, values + count}; }

std::tuple<Numbers, Triples> stage_walk(const Arm& arm, const Numbers& angles, int links) {
    if (links < 0 || links > arm.linkage.links) throw std::invalid_argument("the arm has fewer links");
    Vector points[MAX_LINKS + 1];
    const Rotation r = walk(arm.linkage, Angles(angles).at, links, points);
    return {{r.x.x, r.y.x, r.z.x, r.x.y, r.y.y, r.z.y, r.x.z, r.y.z, r.z.z}, triples(points, links + 1)};
}

std::tuple<Triples, int, double> stage_settle(const Triples& points, const Numbers& lengths, const Triple& target) {
    const int bones = int(lengths.size());
    if (bones > MAX_LINKS || points.size() != lengths.size() + 1) throw std::invalid_argument("points are bones + 1");
    const RelaxedMasses relaxed = settle(Points(points).at, lengths.data(), bones, vector(target));
    return {triples(relaxed.points, bones + 1), relaxed.iterations, relaxed.energy};
}

std::optional<double> stage_turn_towards(const Triple& axis, const Triple& rest, const Triple& wanted) {
    double turn;
    if (!turn_towards(vector(axis), vector(rest), vector(wanted), turn)) return std::nullopt;
    return turn;
}

Numbers stage_first_of_two(const Triple& first, const Triple& second, const Triple& rest, const Triple& wanted) {
    double turns[2];
    return numbers(turns, first_of_two(vector(first), vector(second), vector(rest), vector(wanted), turns));
}

std::tuple<Numbers, double> stage_extract(const Arm& arm, const Triples& points, const Numbers& near) {
    const int count = int(points.size());
    if (count >= arm.linkage.links) throw std::invalid_argument("the last bone is not extracted");
    const Extraction found = extract(arm.linkage, Points(points).at, count, Angles(near).at);
    const Link& next = arm.linkage.link[count];
    return {numbers(found.angles, next.first), found.miss};
}

std::optional<double> stage_swivel_of(const Arm& arm, const Triples& points) {
    double swivel;
    if (!swivel_of(arm.linkage, Points(points).at, swivel)) return std::nullopt;
    return swivel;
}

Triple stage_elbow_at(const Arm& arm, const Triple& shoulder, const Triple& hand, double swivel) {
    return triple(Circle(arm.linkage, vector(shoulder), vector(hand)).at(arm.linkage.side, swivel));
}

using Placed = std::tuple<Triples, Triple, Triple, int>;

Placed listed(const Arm& arm, const Place& place) {
    return {triples(place.ends, arm.linkage.girdle()), triple(place.shoulder), triple(place.target), place.iterations};
}

Placed stage_placed(const Arm& arm, const Triple& target, const Numbers& near, const Numbers& rest) {
    return listed(arm, placed(arm.linkage, vector(target), Angles(near).at, Angles(rest).at));
}

std::tuple<Numbers, bool, int> stage_bent(const Arm& arm, const Triples& ends, const Triple& shoulder,
                                          const Triple& target, const Numbers& near, std::optional<double> swivel) {
    Place place;
    const Points given(ends);
    std::copy(given.at, given.at + arm.linkage.girdle(), place.ends);
    place.shoulder = vector(shoulder);
    place.target = vector(target);
    const Bend bend = bent(arm.linkage, place, Angles(near).at, swivel ? &*swivel : nullptr);
    return {numbers(bend.angles, arm.linkage.own()), bend.exact, bend.iterations};
}

std::tuple<Numbers, double, int> stage_polish(const Arm& arm, const Triple& target, const Numbers& angles,
                                              const Numbers& posture, const Numbers& mobility) {
    const CorrectedPosture best =
        polish(arm.linkage, vector(target), Angles(angles).at, Angles(posture).at, Angles(mobility).at);
    return {numbers(best.angles, arm.linkage.own()), best.miss, best.rounds};
}

std::vector<int> stage_nearest(const Arm& arm, const Triple& target) {
    int chosen[MAX_RESTARTS];
    nearest(arm.linkage, vector(target), MAX_RESTARTS, chosen);
    return {chosen, chosen + std::min(MAX_RESTARTS, arm.linkage.seeds)};
}

Numbers stage_orient(const Arm& arm, const Numbers& frame, const Triples& own, const Triples& wanted,
                     const Numbers& rest) {
    if (frame.size() != 9 || own.size() != wanted.size() || own.size() > MAX_DIRECTIONS)
        throw std::invalid_argument("a frame has nine numbers; there are at most two wishes");
    const Rotation rotation{{frame[0], frame[3], frame[6]}, {frame[1], frame[4], frame[7]}, {frame[2], frame[5], frame[8]}};
    Wish wishes[MAX_DIRECTIONS];
    for (size_t i = 0; i < own.size(); ++i) wishes[i] = {vector(own[i]), vector(wanted[i])};
    double angles[MAX_HINGES];
    orient(arm.linkage, rotation, wishes, int(own.size()), Angles(rest).at, angles);
    return numbers(angles, arm.linkage.last().count);
}

double stage_gap(const Arm& arm, const Triple& target) {
    return gap(arm.linkage, arm.seen(vector(target)), arm.rest);
}

Triple stage_softened(const Arm& arm, const Triple& target) {
    return triple(softened(arm.linkage, vector(target), arm.rest));
}

}  // namespace

void bind_stages(nb::class_<Arm>& arm) {
    arm.def("walk", &stage_walk)
        .def_static("settle", &stage_settle)
        .def_static("turn_towards", &stage_turn_towards)
        .def_static("first_of_two", &stage_first_of_two)
        .def("extract", &stage_extract)
        .def("swivel_of", &stage_swivel_of)
        .def("elbow_at", &stage_elbow_at)
        .def("placed", &stage_placed)
        .def("bent", &stage_bent, nb::arg("ends"), nb::arg("shoulder"), nb::arg("target"), nb::arg("near"),
             nb::arg("swivel").none())
        .def("polish", &stage_polish)
        .def("nearest", &stage_nearest)
        .def("orient", &stage_orient)
        .def("gap", &stage_gap)
        .def("softened", &stage_softened);
}

}  // namespace kinesic::arm
