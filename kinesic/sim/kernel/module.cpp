// kinesic._kernel.sim: kinematics, distances and inverse dynamics of many postures. All arrays are contiguous; results
// are written into arrays of the caller.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "capsule_distances.h"
#include "driven_motion.h"
#include "motion_frames.h"

namespace nb = nanobind;
using namespace kinesic::sim;

void bind_impacts(nb::module_& module);  // in impacts.cpp

namespace {

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Places = nb::ndarray<const int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<double, nb::c_contig, nb::device::cpu>;
using Marks = nb::ndarray<const bool, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

void require(bool good) {
    if (!good) throw nb::value_error("arrays of a motion have lengths or places that do not fit");
}

std::vector<double> copy(const Numbers& from) { return {from.data(), from.data() + from.size()}; }

std::vector<int> copy(const Places& from, int64_t below) {
    std::vector<int> places;
    for (size_t k = 0; k < from.size(); ++k) {
        require(from.data()[k] >= 0 && from.data()[k] < below);
        places.push_back(int(from.data()[k]));
    }
    return places;
}

// Adds a segment after its parent, with hinges (t,), their axes (t, 3) and offsets (t, 3) from the segment's origin.
void add_link(MotionFrames& frames, int parent, const Numbers& origin, const std::vector<int>& joints, const Numbers& axes,
              const Numbers& offsets) {
    require(parent < int(frames.links.size()) && origin.size() == 3);
    require(axes.size() == 3 * joints.size() && offsets.size() == axes.size());
    Link link{parent, {}, {}};
    std::copy_n(origin.data(), 3, link.origin);
    for (size_t k = 0; k < joints.size(); ++k) {
        HingeRotation turn{joints[k], {}, false, {}};
        std::copy_n(axes.data() + 3 * k, 3, turn.axis);
        std::copy_n(offsets.data() + 3 * k, 3, turn.at);
        turn.has_offset = turn.at[0] != 0.0 || turn.at[1] != 0.0 || turn.at[2] != 0.0;
        link.turns.push_back(turn);
    }
    frames.links.push_back(std::move(link));
}

void solve(const MotionFrames& self, const Flags& chosen, const Numbers& sines, const Numbers& cosines, Result& rotations,
           Result& origins) {
    const size_t count = rotations.size() / (9 * std::max<size_t>(1, self.links.size()));
    require(chosen.size() == self.links.size() && rotations.size() == 9 * self.links.size() * count);
    require(origins.size() == 3 * self.links.size() * count && sines.size() == cosines.size());
    for (const Link& link : self.links)
        for (const HingeRotation& turn : link.turns) require(turn.joint >= 0 && (turn.joint + 1) * count <= sines.size());
    self.solve({chosen.data(), chosen.data() + chosen.size()}, sines.data(), cosines.data(), count, int(count),
               rotations.data(), origins.data());
}

CapsulePairs make_pairs(const Places& owners, const Numbers& starts, const Numbers& ends, const Places& first,
                        const Places& second, const Numbers& radii, const Numbers& halves, const Flags& hulled) {
    CapsulePairs made;
    made.capsules = int(owners.size());
    made.pairs = int(first.size());
    require(starts.size() == 3 * owners.size() && ends.size() == starts.size());
    require(second.size() == first.size() && radii.size() == first.size() && halves.size() == first.size());
    require(hulled.size() == first.size());
    made.owners = copy(owners, std::numeric_limits<int>::max());
    made.starts = copy(starts);
    made.ends = copy(ends);
    made.first = copy(first, made.capsules);
    made.second = copy(second, made.capsules);
    made.radii = copy(radii);
    made.halves = copy(halves);
    made.hulled.assign(hulled.data(), hulled.data() + hulled.size());
    return made;
}

using Measure = void (CapsulePairs::*)(const Frames&, int, double*, size_t);

// Computes distances (p, m) in m postures from the segment frames.
void measure(CapsulePairs& self, Measure way, const Numbers& rotations, const Numbers& origins, Result& found) {
    const size_t count = self.pairs ? found.size() / self.pairs : 0, segments = count ? origins.size() / 3 / count : 0;
    require(found.size() == self.pairs * count && origins.size() == 3 * segments * count);
    require(rotations.size() == 9 * segments * count);
    for (int owner : self.owners) require(!count || size_t(owner) < segments);
    for (size_t k = 0; k < count; k += STRIP)
        (self.*way)({rotations.data() + k, origins.data() + k, count}, int(std::min<size_t>(STRIP, count - k)),
                    found.data() + k, count);
}

// Computes the distances of pairs that may be the closest, and lower bounds of the others.
void closest(CapsulePairs& self, const Numbers& rotations, const Numbers& origins, Result& lowest) {
    measure(self, &CapsulePairs::closest, rotations, origins, lowest);
}

// Computes the exact distances of all pairs.
void gaps(CapsulePairs& self, const Numbers& rotations, const Numbers& origins, Result& found) {
    measure(self, &CapsulePairs::gaps, rotations, origins, found);
}

// Calls use(first posture, count, frames, distances (p, STRIP)) for strips of m postures, given the sines and cosines (n, m)
// of their hinge angles. Only one strip is in memory, which fits into the cache.
template <typename Use>
void measure_strips(CapsulePairs& self, const MotionFrames& frames, const Flags& chosen, const Numbers& sines,
                    const Numbers& cosines, size_t count, const Use& use) {
    const size_t segments = frames.links.size();
    require(self.pairs > 0 && chosen.size() == segments && sines.size() == cosines.size());
    for (int owner : self.owners) require(size_t(owner) < segments);
    for (const Link& link : frames.links)
        for (const HingeRotation& turn : link.turns) require(turn.joint >= 0 && (turn.joint + 1) * count <= sines.size());
    const std::vector<char> kept(chosen.data(), chosen.data() + segments);
    std::vector<double> rotations(9 * segments * STRIP), origins(3 * segments * STRIP), lowest(size_t(self.pairs) * STRIP);
    for (size_t k = 0; k < count; k += STRIP) {
        const int part = int(std::min<size_t>(STRIP, count - k));
        const Frames strip{rotations.data(), origins.data(), size_t(part)};
        frames.solve(kept, sines.data() + k, cosines.data() + k, count, part, rotations.data(), origins.data());
        self.closest(strip, part, lowest.data(), STRIP);
        use(k, part, strip, lowest.data());
    }
}

// Computes the distance and index (m,) of the closest pair in m postures.
void nearest(CapsulePairs& self, const MotionFrames& frames, const Flags& chosen, const Numbers& sines,
             const Numbers& cosines, Result& distances, nb::ndarray<int64_t, nb::ndim<1>, nb::c_contig>& closest_pairs) {
    require(closest_pairs.size() == distances.size());
    measure_strips(self, frames, chosen, sines, cosines, distances.size(),
                   [&](size_t k, int part, const Frames&, const double* lowest) {
                       for (int m = 0; m < part; ++m) {
                           int best = 0;
                           for (int p = 1; p < self.pairs; ++p)
                               if (lowest[p * STRIP + m] < lowest[best * STRIP + m]) best = p;
                           distances.data()[k + m] = lowest[best * STRIP + m];
                           closest_pairs.data()[k + m] = best;
                       }
                   });
}

// Computes the result of `closest` (p, m), and the origins (s, m, 3) [m] of some segments.
void survey(CapsulePairs& self, const MotionFrames& frames, const Flags& chosen, const Numbers& sines,
            const Numbers& cosines, const Places& segments, Result& lowest, Result& origins) {
    const size_t count = self.pairs ? lowest.size() / self.pairs : 0;
    const std::vector<int> asked = copy(segments, int64_t(frames.links.size()));
    require(lowest.size() == self.pairs * count && origins.size() == 3 * asked.size() * count);
    measure_strips(self, frames, chosen, sines, cosines, count,
                   [&](size_t k, int part, const Frames& strip, const double* found) {
                       for (int p = 0; p < self.pairs; ++p)
                           std::copy_n(found + p * STRIP, part, lowest.data() + p * count + k);
                       for (size_t s = 0; s < asked.size(); ++s)
                           for (int m = 0; m < part; ++m)
                               for (int i = 0; i < 3; ++i)
                                   origins.data()[3 * (s * count + k + m) + i] =
                                       strip.origins[(3 * size_t(asked[s]) + i) * strip.stride + m];
                   });
}

// Replaces the distances of flagged pairs of bodies (b,) by exact ones in k of m postures, given their capsules' ends.
void measure_bodies(const Places& begins, const Numbers& radii, const Places& first, const Places& second,
                    const Numbers& starts, const Numbers& ends, const Places& postures, const Marks& near, Result& gaps) {
    const size_t count = postures.size(), pairs = first.size(), all = pairs ? gaps.size() / pairs : 0;
    require(begins.size() > 0 && second.size() == pairs && near.size() == gaps.size() && gaps.size() == pairs * all);
    const Bodies bodies{copy(begins, int64_t(radii.size()) + 1), copy(radii), starts.data(), ends.data(), count};
    require(starts.size() == 3 * radii.size() * count && ends.size() == starts.size());
    require(std::is_sorted(bodies.begins.begin(), bodies.begins.end()));
    const int64_t known = int64_t(begins.size()) - 1;
    const std::vector<int> from = copy(first, known), to = copy(second, known), where = copy(postures, int64_t(all));
    for (size_t p = 0; p < pairs; ++p)
        for (size_t k = 0; k < count; ++k)
            if (near.data()[p * all + where[k]]) gaps.data()[p * all + where[k]] = bodies.apart(from[p], to[p], k);
}

// Flags postures (s, n), between measured ones with distances (p, k), whose distance may be below a limit [m].
void suspect(const Numbers& angles, const Places& known, const Numbers& lowest, const Numbers& reaches, double limit,
             nb::ndarray<bool, nb::ndim<1>, nb::c_contig>& near) {
    const size_t count = near.size(), hinges = count ? angles.size() / count : 0, knowns = known.size();
    const size_t pairs = hinges ? reaches.size() / hinges : 0;
    require(pairs > 0 && angles.size() == count * hinges && lowest.size() == knowns * pairs);
    require(std::is_sorted(known.data(), known.data() + knowns));
    const std::vector<int> ends = copy(known, int64_t(count));
    Reaches self{int(hinges), int(pairs), reaches.data(), std::vector<double>(hinges, 0.0), {}};
    for (size_t k = 0; k < reaches.size(); ++k)
        self.farthest[k % hinges] = std::max(self.farthest[k % hinges], reaches.data()[k]);
    Neighbour before, after;
    const Neighbour* const both[2] = {&after, &before};
    for (size_t k = 0, b = 0; k < knowns; b = std::max(b, size_t(ends[k++]) + 1)) {
        std::swap(before, after);
        after.angles = angles.data() + ends[k] * hinges;
        after.lowest.resize(pairs);
        for (size_t p = 0; p < pairs; ++p) after.lowest[p] = lowest.data()[p * knowns + k];
        after.least = *std::min_element(after.lowest.begin(), after.lowest.end());
        if (!k) before = after;
        for (; b < size_t(ends[k]); ++b) near.data()[b] = self.may_be_near(angles.data() + b * hinges, both, limit);
    }
}

// Calls MuJoCo's inverse dynamics, given by function addresses, for each row of positions, velocities, accelerations (m, q).
void inverse(const std::vector<uintptr_t>& before, uintptr_t newton_euler, uintptr_t model, uintptr_t data,
             bool accelerating, Result& qpos, Result& qvel, Result& qacc, const Numbers& positions, const Numbers& speeds,
             const Numbers& accelerations, Result& torques) {
    using Stage = void (*)(const void*, void*);
    using NewtonEuler = void (*)(const void*, void*, int, double*);
    const size_t size = qvel.size();
    require(size && qpos.size() == size && qacc.size() == size && torques.size() % size == 0 && newton_euler);
    require(positions.size() == torques.size() && speeds.size() == torques.size());
    require(accelerations.size() == torques.size());
    auto* known = reinterpret_cast<void*>(data);
    const auto* described = reinterpret_cast<const void*>(model);
    for (size_t at = 0; at < torques.size(); at += size) {
        std::copy_n(positions.data() + at, size, qpos.data());
        std::copy_n(speeds.data() + at, size, qvel.data());
        std::copy_n(accelerations.data() + at, size, qacc.data());
        for (uintptr_t stage : before) reinterpret_cast<Stage>(stage)(described, known);
        reinterpret_cast<NewtonEuler>(newton_euler)(described, known, accelerating, torques.data() + at);
    }
}

// Calls MuJoCo stages, given by function addresses, for each row of positions (m, q), and stores selected numbers of the
// resulting data, (m, places).
void keep_left(const std::vector<uintptr_t>& stages, uintptr_t model, uintptr_t data, Result& qpos, const Numbers& left,
               const Places& places, const Numbers& positions, Result& kept) {
    using Stage = void (*)(const void*, void*);
    const size_t size = qpos.size(), count = places.size();
    require(size && count && positions.size() % size == 0 && positions.size() / size * count == kept.size());
    for (size_t k = 0; k < count; ++k) require(places.data()[k] >= 0 && size_t(places.data()[k]) < left.size());
    double* row = kept.data();
    for (size_t at = 0; at < positions.size(); at += size, row += count) {
        std::copy_n(positions.data() + at, size, qpos.data());
        for (uintptr_t stage : stages)
            reinterpret_cast<Stage>(stage)(reinterpret_cast<const void*>(model), reinterpret_cast<void*>(data));
        for (size_t k = 0; k < count; ++k) row[k] = left.data()[places.data()[k]];
    }
}

// Measures postures, servo quantities and power of s logged steps, for `measure_drives`. Steps before `first` were counted
// earlier.
void measure_drives(const std::array<Numbers, 5>& log, const std::array<Places, 5>& places, const Numbers& law,
                    const Numbers& figures, const Numbers& left, size_t first, const std::array<Result, 6>& found) {
    const auto& [angles, speeds, spans, supplied, aims] = log;
    const auto& [begins, ends, motors, play, wound] = places;
    const auto& [postures, rows, currents, rises, warmth, charge] = found;
    const size_t count = spans.size(), n = motors.size(), commands = ends.size(), windings = wound.size();
    require(count && n && commands && begins.size() && begins.data()[0] == 0 && aims.size() == begins.size() * n);
    const size_t joints = angles.size() / count;
    require(angles.size() == joints * count && speeds.size() == angles.size() && (!play.size() || play.size() == n));
    require(supplied.size() == 1 || supplied.size() == count);
    require(law.size() == 5 * n && figures.size() == 2 * windings && left.size() == windings * count);
    require(postures.size() == count * n && rows.size() == 4 * commands * n && currents.size() == 2 * commands);
    require(rises.size() == windings * commands && warmth.size() == windings && charge.size() == n);
    require(std::is_sorted(ends.data(), ends.data() + commands) && ends.data()[0] > 0 &&
            size_t(ends.data()[commands - 1]) <= count);
    const LoggedSteps kept{angles.data(), speeds.data(), spans.data(), supplied.data(), aims.data(),
                         begins.data(), count, joints, supplied.size(), begins.size()};
    const double* constants = law.data();
    const DriveRows drives{constants, constants + n, constants + 2 * n, constants + 3 * n, constants + 4 * n};
    std::vector<Winding> warming;
    for (int hinge : copy(wound, int64_t(n))) {
        const size_t w = warming.size();
        warming.push_back({size_t(hinge), figures.data()[2 * w], figures.data()[2 * w + 1], left.data() + w * count});
    }
    const std::vector<int> driven = copy(motors, int64_t(joints)), free = copy(play, int64_t(joints));
    double *state = rows.data(), *drawn = currents.data();
    const size_t size = commands * n;
    const DrivenRows to{postures.data(), state, state + size, state + 2 * size, state + 3 * size,
                        drawn, drawn + commands, rises.data()};
    DrivenMotion{kept, driven, free, drives, warming, {}}.measure(ends.data(), commands, first, to, warmth.data(),
                                                                  charge.data());
}

}  // namespace

void bind_sim(nb::module_& module) {
    nb::class_<MotionFrames>(module, "MotionFrames")
        .def(nb::init<>())
        .def("add_link", &add_link)
        .def("solve", &solve);
    nb::class_<CapsulePairs>(module, "CapsulePairs")
        .def("closest", &closest)
        .def("gaps", &gaps)
        .def("nearest", &nearest)
        .def("survey", &survey);
    module.def("measure_bodies", &measure_bodies);
    module.def("suspect", &suspect);
    module.def("make_pairs", &make_pairs);
    module.def("inverse", &inverse);
    module.def("keep_left", &keep_left);
    module.def("measure_drives", &measure_drives);
    bind_impacts(module);
}
