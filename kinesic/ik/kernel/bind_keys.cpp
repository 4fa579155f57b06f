// Python interface for the postures of all keys of a hand in one call (kinesic/ik/keys.py).

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "arm_class.h"
#include "arm_keys.h"

namespace kinesic::arm {

namespace {

template <typename... Shape>
using Array = nb::ndarray<double, Shape..., nb::c_contig, nb::device::cpu>;
using Row = Array<const double, nb::shape<-1>>;
using Triples = Array<const double, nb::shape<-1, 3>>;
using Table = Array<const double, nb::shape<-1, -1>>;
using Flags = nb::ndarray<const bool, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Modes = nb::ndarray<const int64_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

void add_wish(const Arm& arm, const double* wanted, const Vector& own, Question& question) {
    if (std::isnan(wanted[0])) return;
    question.wishes[question.wish_count++] = {own, unit(arm.seen(wanted))};
}

// Returns angles, start angles of the current path and requested swivel of every key; `now` and `began` are the values
// before the first key.
void pose_keys(const Arm& arm, Modes modes, Flags passing, Triples positions, Triples pointings, Triples palms, Row swivels,
               Table rests, Row openness, Row now, Row began, double max_swivel_change, double max_hinge_step,
               double open_swivel, Array<double, nb::shape<-1, -1>> angles, Array<double, nb::shape<-1, -1>> beginnings,
               Array<double, nb::shape<-1>> turns) {
    const size_t n = size_t(arm.linkage.hinges), count = modes.shape(0);
    for (const size_t rows : {passing.shape(0), positions.shape(0), pointings.shape(0), palms.shape(0),
                              swivels.shape(0), rests.shape(0),
                              openness.shape(0), angles.shape(0), beginnings.shape(0), turns.shape(0)})
        if (rows != count) throw nb::value_error("every array has a row for each key");
    for (const size_t width : {rests.shape(1), now.shape(0), began.shape(0), angles.shape(1), beginnings.shape(1)})
        if (width != n) throw nb::value_error("every posture has an angle for each hinge");
    nb::gil_scoped_release free;
    const KeySolver path{arm.linkage, arm.rest, arm.mobility, {max_swivel_change, max_hinge_step, open_swivel}};
    double here[MAX_HINGES], before[MAX_HINGES];
    std::copy_n(now.data(), n, here);
    bool known = !std::isnan(began.data()[0]);
    std::copy_n(began.data(), n, before);
    for (size_t i = 0; i < count; ++i) {
        const Mode mode = Mode(modes.data()[i]);
        Key key;
        key.passing = passing.data()[i];
        key.openness = openness.data()[i];
        key.swivel = std::isnan(swivels.data()[i]) ? nullptr : swivels.data() + i;
        turns.data()[i] = NAN;
        const double* rest = rests.data() + n * i;
        if (mode == Mode::rest) std::copy_n(rest, n, here);
        if (mode == Mode::reach) {
            Question& question = key.question;
            question.position = arm.seen(positions.data() + 3 * i);
            add_wish(arm, pointings.data() + 3 * i, arm.linkage.last().along, question);
            add_wish(arm, palms.data() + 3 * i, arm.linkage.palm, question);
            for (size_t k = 0; k < n; ++k) question.home[k] = arm.linkage.pivot[k].clipped(rest[k]);
            std::copy_n(arm.mobility, n, question.mobility);
            double found[MAX_HINGES];
            turns.data()[i] = path.pose(key, here, known ? before : here, found);
            std::copy_n(found, n, here);
        }
        if (!(key.passing && known)) std::copy_n(here, n, before);
        known = true;
        std::copy_n(here, n, angles.data() + n * i);
        std::copy_n(before, n, beginnings.data() + n * i);
    }
}

}  // namespace

void bind_keys(nb::class_<Arm>& arm) {
    arm.def("pose_keys", &pose_keys, nb::arg("modes"), nb::arg("passing"), nb::arg("positions"),
            nb::arg("pointings"), nb::arg("palms"),
            nb::arg("swivels"), nb::arg("rests"), nb::arg("openness"), nb::arg("now"), nb::arg("began"),
            nb::arg("max_swivel_change"), nb::arg("max_hinge_step"), nb::arg("open_swivel"), nb::arg("angles").noconvert(),
            nb::arg("beginnings").noconvert(), nb::arg("turns").noconvert());
}

}  // namespace kinesic::arm
