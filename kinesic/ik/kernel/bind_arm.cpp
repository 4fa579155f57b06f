// Python interface of the arm solver. It accepts only finite float64 of the right size.

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

#include <numeric>
#include <vector>

#include "arm_batch.h"
#include "arm_class.h"
#include "arm_nearest.h"
#include "arm_swing.h"
#include "arm_track.h"
#include "bind_arrays.h"

namespace nb = nanobind;

namespace kinesic::arm {

bool read_posture(const Arm& arm, nb::handle source, double* into) {
    if (!read(source, into, arm.linkage.hinges)) return false;
    for (int k = 0; k < arm.linkage.hinges; ++k) into[k] = arm.linkage.pivot[k].clipped(into[k]);
    return true;
}

namespace {

using Triple = std::array<double, 3>;
using Triples = std::vector<Triple>;
using Numbers = std::vector<double>;
template <typename... Shape>
using Array = nb::ndarray<double, Shape..., nb::c_contig, nb::device::cpu>;

Vector vector(const Triple& p) { return {p[0], p[1], p[2]}; }

// Hinges are given in one list; `counts` has the number that aim each bone.
void pack(Arm* self, const Triple& origin, const std::vector<int>& counts, const Triples& bones, const Triples& axes,
          const Numbers& lower, const Numbers& upper, const Numbers& rest, const Numbers& mobility, const Triple& palm,
          double side, double farthest, double closest, const std::vector<Numbers>& seeds, bool mirrored) {
    const size_t hinges = axes.size(), aiming = size_t(std::accumulate(counts.begin(), counts.end(), 0));
    if (aiming != hinges || counts.size() < 3 || counts.size() > MAX_LINKS || bones.size() != counts.size() ||
        hinges > MAX_HINGES || lower.size() != hinges || upper.size() != hinges || rest.size() != hinges ||
        mobility.size() != hinges || seeds.size() > MAX_SEEDS)
        throw std::invalid_argument("an arm has 3 to 8 bones, at most 12 hinges and 64 seeds, and each its numbers");
    Arm* arm = new (self) Arm();
    Linkage& linkage = arm->linkage;
    linkage.origin = vector(origin);
    linkage.palm = unit(vector(palm));
    linkage.side = side;
    linkage.farthest = farthest;
    linkage.closest = closest;
    linkage.links = int(counts.size());
    linkage.hinges = int(hinges);
    arm->mirrored = mirrored;
    for (int j = 0, first = 0; j < linkage.links; first += counts[j++]) {
        const Vector bone = vector(bones[j]);
        linkage.link[j] = {first, counts[j], bone, unit(bone), norm(bone)};
    }
    for (int k = 0; k < linkage.hinges; ++k) {
        linkage.pivot[k] = Pivot(vector(axes[k]), lower[k], upper[k], rest[k]);
        arm->rest[k] = linkage.pivot[k].clipped(rest[k]);
        arm->mobility[k] = mobility[k];
    }
    linkage.draw_arcs();
    Vector points[MAX_LINKS + 1];
    walk(linkage, arm->rest, linkage.girdle(), points);
    linkage.resting = points[linkage.girdle()];
    linkage.seeds = int(seeds.size());
    for (int n = 0; n < linkage.seeds; ++n) {
        if (int(seeds[n].size()) != linkage.own()) throw std::invalid_argument("a seed has an angle for each hinge");
        std::copy(seeds[n].begin(), seeds[n].end(), linkage.seed[n].angles);
        linkage.seed[n].hand = hand(linkage, linkage.seed[n].angles);
    }
}

bool read_wish(const Arm& arm, nb::handle source, const Vector& own, Question& question) {
    if (source.is_none()) return true;
    double wanted[3];
    if (!read(source, wanted, 3)) return false;
    Wish& wish = question.wishes[question.wish_count++];
    wish = {own, unit(arm.seen(wanted))};
    return !null(wish.wanted);
}

bool read_wishes(const Arm& arm, nb::handle pointing, nb::handle palm, Question& question) {
    return read_wish(arm, pointing, arm.linkage.last().along, question) &&
           read_wish(arm, palm, arm.linkage.palm, question);
}

// Errors of pointing and palm; None for a direction that was not requested.
std::pair<nb::object, nb::object> told(nb::handle pointing, nb::handle palm, const double* errors) {
    return {pointing.is_none() ? nb::none() : nb::cast(errors[0]),
            palm.is_none() ? nb::none() : nb::cast(errors[pointing.is_none() ? 0 : 1])};
}

// Fields of kinesic.ik.solve.Solution in order. None: refused.
nb::object ask(const Arm& arm, nb::handle position, nb::handle pointing, nb::handle palm, nb::handle swivel,
               nb::handle start, nb::handle rest, nb::handle mobility) {
    const int n = arm.linkage.hinges;
    Question question;
    double place[3], turn, asked[MAX_HINGES], pulled = 0.0;
    if (!read(position, place, 3) || !read(start, asked, n)) return nb::none();
    for (int k = 0; k < n; ++k) {
        question.near[k] = arm.linkage.pivot[k].clipped(asked[k]);
        pulled = std::max(pulled, std::fabs(asked[k] - question.near[k]));
    }
    question.position = arm.seen(place);
    if (!read_wishes(arm, pointing, palm, question)) return nb::none();
    if (!swivel.is_none()) {
        turn = PyFloat_AsDouble(swivel.ptr());
        if (PyErr_Occurred()) PyErr_Clear(), turn = NAN;
        if (!std::isfinite(turn)) return nb::none();
        question.swivel = &turn;
    }
    if (rest.is_none())
        std::copy_n(arm.rest, n, question.home);
    else if (!read_posture(arm, rest, question.home))
        return nb::none();
    if (mobility.is_none())
        std::copy_n(arm.mobility, n, question.mobility);
    else if (!read(mobility, question.mobility, n))
        return nb::none();
    Answer found;
    {
        nb::gil_scoped_release free;
        found = answer(arm.linkage, question, arm.rest, arm.mobility);
    }
    const Vector target = arm.seen(found.target);
    const double clamped[3] = {target.x, target.y, target.z};
    const auto [first, second] = told(pointing, palm, found.errors);
    return nb::make_tuple(sealed(found.angles, n), found.residual, first, second, found.residual <= REACHED_DISTANCE,
                          found.iterations, sealed(clamped, 3), pulled);
}

// Changes the swivel of a solved posture by at most `max_swivel_change`; returns angles, residual, errors of pointing and palm.
nb::object swung(const Arm& arm, nb::handle position, nb::handle pointing, nb::handle palm, nb::handle home,
                 nb::handle angles, double max_swivel_change) {
    Question question;
    double place[3];
    if (!read(position, place, 3) || !read_wishes(arm, pointing, palm, question) ||
        !read_posture(arm, home, question.home) || !read_posture(arm, angles, question.near))
        throw nb::value_error("swing needs finite float64 arrays: vectors of 3 numbers and an angle for each hinge");
    question.position = arm.seen(place);
    SwivelPosture cell;
    {
        nb::gil_scoped_release free;
        cell = change_swivel(arm.linkage, question, max_swivel_change);
    }
    const auto [first, second] = told(pointing, palm, cell.errors);
    return nb::make_tuple(sealed(cell.angles, arm.linkage.hinges), cell.miss, first, second);
}

// Corrects the angles in place, from other postures if it stalls. Returns the residual [m].
double reach(const Arm& arm, nb::handle target, nb::handle angles) {
    double place[3], now[MAX_HINGES];
    if (!read(target, place, 3) || !read_posture(arm, angles, now))
        throw nb::value_error("reach needs finite float64 arrays: a target of 3 numbers and an angle for each hinge");
    CorrectedPosture best;
    {
        nb::gil_scoped_release free;
        best = approach(arm.linkage, arm.seen(place), now, arm.rest, arm.mobility);
    }
    std::copy_n(best.angles, arm.linkage.own(), now);
    if (!write(angles, now, arm.linkage.hinges)) throw nb::value_error("the angles' array is read-only");
    return best.miss;
}

// Solves each target from the same start by numerical correction alone, with at most `rounds` iterations.
void reach_many(const Arm& arm, Array<const double, nb::shape<-1, 3>> targets, Array<const double, nb::shape<-1>> start,
                int rounds, Array<double, nb::shape<-1, -1>> angles, Array<double, nb::shape<-1>> residuals) {
    const int n = arm.linkage.hinges;
    const size_t count = targets.shape(0);
    if (int(start.shape(0)) != n || int(angles.shape(1)) != n || angles.shape(0) != count || residuals.shape(0) != count)
        throw nb::value_error("shapes are targets (m, 3), start (k,), angles (m, k), residuals (m,)");
    nb::gil_scoped_release free;
    double now[MAX_HINGES];
    for (int k = 0; k < n; ++k) now[k] = arm.linkage.pivot[k].clipped(start.data()[k]);
    for (size_t i = 0; i < count; i += LANES) {
        Vectors target = all(Vector{});
        for (size_t lane = 0; lane < LANES; ++lane) {  // the last target fills the remaining lanes
            const Vector seen = arm.seen(targets.data() + 3 * std::min(i + lane, count - 1));
            target.x[lane] = seen.x, target.y[lane] = seen.y, target.z[lane] = seen.z;
        }
        const CorrectedPostures best = polish(arm.linkage, target, now, arm.rest, arm.mobility, rounds);
        for (size_t lane = 0; lane < LANES && i + lane < count; ++lane) {
            double* row = angles.data() + n * (i + lane);
            std::copy_n(now, n, row);
            for (int k = 0; k < arm.linkage.own(); ++k) row[k] = best.angles[k][lane];
            residuals.data()[i + lane] = best.miss[lane];
        }
    }
}

// Solves successive targets with swivels [rad], each from the angles of the previous one. The first target is solved
// `settling` times before, from the start posture.
void solve_path(const Arm& arm, Array<const double, nb::shape<-1, 3>> targets,
                Array<const double, nb::shape<-1>> swivels, Array<const double, nb::shape<-1>> start, int settling,
                Array<double, nb::shape<-1, -1>> angles) {
    const int n = arm.linkage.hinges;
    const size_t count = targets.shape(0);
    if (int(start.shape(0)) != n || int(angles.shape(1)) != n || angles.shape(0) != count || swivels.shape(0) != count)
        throw nb::value_error("shapes are targets (m, 3), swivels (m,), start (k,), angles (m, k)");
    const auto finite = [](const double* first, size_t numbers) {
        return std::all_of(first, first + numbers, [](double number) { return std::isfinite(number); });
    };
    if (!finite(targets.data(), 3 * count) || !finite(swivels.data(), count) || !finite(start.data(), n))
        throw nb::value_error("targets, swivels and start must be finite");
    nb::gil_scoped_release free;
    Question question;
    for (int k = 0; k < n; ++k) question.near[k] = arm.linkage.pivot[k].clipped(start.data()[k]);
    std::copy_n(arm.rest, n, question.home);
    std::copy_n(arm.mobility, n, question.mobility);
    for (size_t i = 0; i < count; ++i) {
        question.position = arm.seen(targets.data() + 3 * i);
        question.swivel = swivels.data() + i;
        for (int round = i == 0 ? settling : 0; round >= 0; --round)
            std::copy_n(answer(arm.linkage, question, arm.rest, arm.mobility).angles, n, question.near);
        std::copy_n(question.near, n, angles.data() + n * i);
    }
}

// One tick of tracking, in place, too short to release Python's lock. Returns the residual [m].
double track(const Arm& arm, nb::handle target, double pull, int parts, nb::handle angles) {
    double place[3], now[MAX_HINGES];
    if (!read(target, place, 3) || !read(angles, now, arm.linkage.hinges))
        throw nb::value_error("the target needs three finite numbers in a float64 array");
    const double residual = follow(arm.linkage, arm.seen(place), pull, parts, arm.rest, arm.mobility, now);
    if (!write(angles, now, arm.linkage.hinges)) throw nb::value_error("the angles' array is read-only");
    return residual;
}

}  // namespace

}  // namespace kinesic::arm

void bind_arm(nb::module_& module) {
    using namespace kinesic::arm;
    if (_import_array() < 0) throw nb::python_error();
    nb::class_<Arm> arm(module, "Arm");
    arm.def("__init__", &pack, nb::kw_only(), nb::arg("origin"), nb::arg("counts"), nb::arg("bones"), nb::arg("axes"),
            nb::arg("lower"), nb::arg("upper"), nb::arg("rest"), nb::arg("mobility"), nb::arg("palm"), nb::arg("side"),
            nb::arg("farthest"), nb::arg("closest"), nb::arg("seeds"), nb::arg("mirrored"))
        .def("solve", &ask, nb::arg("position").none(), nb::arg("pointing").none(), nb::arg("palm").none(),
             nb::arg("swivel").none(), nb::arg("start").none(), nb::arg("rest").none(), nb::arg("mobility").none())
        .def("swing", &swung, nb::arg("position"), nb::arg("pointing").none(), nb::arg("palm").none(), nb::arg("home"),
             nb::arg("angles"), nb::arg("widest"))
        .def("reach", &reach)
        .def("reach_many", &reach_many)
        .def("solve_path", &solve_path)
        .def("track", &track);
    bind_poses(arm);
    bind_keys(arm);
    bind_stages(arm);
}
