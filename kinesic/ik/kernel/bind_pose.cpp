// Python interface for hand poses. It accepts only finite float64 of the right size.

#include <nanobind/nanobind.h>

#include "arm_class.h"
#include "arm_pose.h"
#define NO_IMPORT_ARRAY  // bind_arm.cpp fills NumPy's table
#include "bind_arrays.h"

namespace kinesic::arm {

namespace {

constexpr double ORTHONORMAL_TOLERANCE = 1e-6;  // largest deviation of R^T R from 1

bool is_rotation(const Rotation& r) {
    const Vector* columns[3] = {&r.x, &r.y, &r.z};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
            if (std::abs(dot(*columns[i], *columns[j]) - (i == j)) > ORTHONORMAL_TOLERANCE) return false;
    return dot(cross(r.x, r.y), r.z) > 0.0;
}

// Fields of kinesic.ik.pose.PoseSolution in order.
nb::object answered(const Arm& arm, const Pose& pose) {
    PoseSolution solution;
    {
        nb::gil_scoped_release free;
        solution = hold(arm.linkage, pose, arm.mobility);
    }
    return nb::make_tuple(sealed(solution.angles, arm.linkage.hinges), solution.residual, solution.turn,
                          solution.reached, solution.cells, solution.rounds);
}

bool read_pose(const Arm& arm, nb::handle position, nb::handle start, Pose& pose) {
    double place[3];
    if (!searched(arm.linkage) || !read(position, place, 3) || !read_posture(arm, start, pose.near)) return false;
    pose.position = arm.seen(place);
    return true;
}

nb::object pose(const Arm& arm, nb::handle position, nb::handle rotation, nb::handle start) {
    Pose asked;
    double r[9];
    if (!read_pose(arm, position, start, asked) || !read_square(rotation, r, 3)) return nb::none();
    const double across = arm.mirrored ? -1.0 : 1.0;  // a mirrored frame keeps its axes in the mirror's plane
    asked.wanted = {{r[0], across * r[3], r[6]}, {across * r[1], r[4], across * r[7]}, {r[2], across * r[5], r[8]}};
    return is_rotation(asked.wanted) ? answered(arm, asked) : nb::none();
}

nb::object hold_directions(const Arm& arm, nb::handle position, nb::handle pointing, nb::handle palm,
                           nb::handle start) {
    Pose asked;
    double along[3], facing[3];
    if (!read_pose(arm, position, start, asked) || !read(pointing, along, 3) || !read(palm, facing, 3))
        return nb::none();
    const Vector ahead = unit(arm.seen(along)), aside = unit(arm.seen(facing));
    if (!orientation_of(arm.linkage.last().along, arm.linkage.palm, ahead, aside, asked.wanted)) return nb::none();
    return answered(arm, asked);
}

}  // namespace

void bind_poses(nb::class_<Arm>& arm) {
    arm.def("pose", &pose, nb::arg("position").none(), nb::arg("rotation").none(), nb::arg("start").none())
        .def("hold", &hold_directions, nb::arg("position").none(), nb::arg("pointing").none(), nb::arg("palm").none(),
             nb::arg("start").none());
}

}  // namespace kinesic::arm
