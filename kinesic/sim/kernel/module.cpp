// kinesic.sim._kernel: kinematics, distances and inverse dynamics of many postures. Arrays are contiguous; results are
// written into the caller's.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "capsule_distances.h"
#include "motion_frames.h"

namespace nb = nanobind;
using namespace kinesic::sim;

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

// Adds a segment, after its parent: turns (t,) with axes (t, 3) and offsets (t, 3) from its origin.
void add_link(MotionFrames& frames, int parent, const Numbers& origin, const std::vector<int>& joints, const Numbers& axes,
              const Numbers& offsets) {
    require(parent < int(frames.links.size()) && origin.size() == 3);
    require(axes.size() == 3 * joints.size() && offsets.size() == axes.size());
    Link link{parent, {}, {}};
    std::copy_n(origin.data(), 3, link.origin);
    for (size_t k = 0; k < joints.size(); ++k) {
        Turn turn{joints[k], {}, false, {}};
        std::copy_n(axes.data() + 3 * k, 3, turn.axis);
        std::copy_n(offsets.data() + 3 * k, 3, turn.at);
        turn.aside = turn.at[0] != 0.0 || turn.at[1] != 0.0 || turn.at[2] != 0.0;
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
        for (const Turn& turn : link.turns) require(turn.joint >= 0 && (turn.joint + 1) * count <= sines.size());
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

// (p, m) distances of m postures whose frames are known.
void measure(CapsulePairs& self, Measure way, const Numbers& rotations, const Numbers& origins, Result& found) {
    const size_t count = self.pairs ? found.size() / self.pairs : 0, segments = count ? origins.size() / 3 / count : 0;
    require(found.size() == self.pairs * count && origins.size() == 3 * segments * count);
    require(rotations.size() == 9 * segments * count);
    for (int owner : self.owners) require(!count || size_t(owner) < segments);
    for (size_t k = 0; k < count; k += STRIP)
        (self.*way)({rotations.data() + k, origins.data() + k, count}, int(std::min<size_t>(STRIP, count - k)),
                    found.data() + k, count);
}

// The same where a pair may be the closest; elsewhere a lower bound.
void closest(CapsulePairs& self, const Numbers& rotations, const Numbers& origins, Result& lowest) {
    measure(self, &CapsulePairs::closest, rotations, origins, lowest);
}

// All of them.
void gaps(CapsulePairs& self, const Numbers& rotations, const Numbers& origins, Result& found) {
    measure(self, &CapsulePairs::gaps, rotations, origins, found);
}

// (m,) distance and index of the closest pair in m postures, from sines and cosines (n, m) of all turns.
void nearest(CapsulePairs& self, const MotionFrames& frames, const Flags& chosen, const Numbers& sines,
             const Numbers& cosines, Result& distances, nb::ndarray<int64_t, nb::ndim<1>, nb::c_contig>& closest_pairs) {
    const size_t count = distances.size(), segments = frames.links.size();
    require(self.pairs > 0 && chosen.size() == segments && sines.size() == cosines.size());
    require(closest_pairs.size() == count);
    for (int owner : self.owners) require(size_t(owner) < segments);
    for (const Link& link : frames.links)
        for (const Turn& turn : link.turns) require(turn.joint >= 0 && (turn.joint + 1) * count <= sines.size());
    const std::vector<char> kept(chosen.data(), chosen.data() + segments);
    std::vector<double> rotations(9 * segments * STRIP), origins(3 * segments * STRIP), lowest(size_t(self.pairs) * STRIP);
    for (size_t k = 0; k < count; k += STRIP) {
        const int part = int(std::min<size_t>(STRIP, count - k));
        frames.solve(kept, sines.data() + k, cosines.data() + k, count, part, rotations.data(), origins.data());
        self.closest({rotations.data(), origins.data(), size_t(part)}, part, lowest.data(), STRIP);
        for (int m = 0; m < part; ++m) {
            int best = 0;
            for (int p = 1; p < self.pairs; ++p)
                if (lowest[p * STRIP + m] < lowest[best * STRIP + m]) best = p;
            distances.data()[k + m] = lowest[best * STRIP + m];
            closest_pairs.data()[k + m] = best;
        }
    }
}

// Puts the distances of bodies (b,) of several capsules, whose ends are known in k of m postures, where pairs are near.
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

// Marks (b,) postures between known ones, (k, n) with distances (k, p), that may be nearer than a limit [m] to contact.
void suspect(const Numbers& between, const Places& after, const Numbers& known, const Numbers& lowest,
             const Numbers& reaches, double limit, nb::ndarray<bool, nb::ndim<1>, nb::c_contig>& near) {
    const size_t count = near.size(), hinges = count ? between.size() / count : 0;
    if (!count) return;
    const size_t pairs = reaches.size() / hinges, knowns = known.size() / hinges;
    require(after.size() == count && between.size() == count * hinges && lowest.size() == knowns * pairs);
    Reaches self{int(hinges), int(pairs), reaches.data(), std::vector<double>(hinges, 0.0), {}};
    std::vector<double> least(knowns, std::numeric_limits<double>::infinity());
    for (size_t k = 0; k < reaches.size(); ++k)
        self.farthest[k % hinges] = std::max(self.farthest[k % hinges], reaches.data()[k]);
    for (size_t k = 0; k < lowest.size(); ++k) least[k / pairs] = std::min(least[k / pairs], lowest.data()[k]);
    const auto neighbour = [&](int64_t k) {
        return Neighbour{known.data() + k * hinges, lowest.data() + k * pairs, least[k]};
    };
    for (size_t b = 0; b < count; ++b) {
        const int64_t next = after.data()[b];
        require(next >= 0 && size_t(next) < knowns);
        const Neighbour both[2] = {neighbour(next), neighbour(std::max<int64_t>(next - 1, 0))};
        near.data()[b] = self.may_be_near(between.data() + b * hinges, both, limit);
    }
}

// Calls MuJoCo's inverse dynamics, known by addresses, for each row of positions, speeds and accelerations (m, q).
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

}  // namespace

NB_MODULE(_kernel, module) {
    nb::class_<MotionFrames>(module, "MotionFrames")
        .def(nb::init<>())
        .def("add_link", &add_link)
        .def("solve", &solve);
    nb::class_<CapsulePairs>(module, "CapsulePairs")
        .def("closest", &closest)
        .def("gaps", &gaps)
        .def("nearest", &nearest);
    module.def("measure_bodies", &measure_bodies);
    module.def("suspect", &suspect);
    module.def("make_pairs", &make_pairs);
    module.def("inverse", &inverse);
}
