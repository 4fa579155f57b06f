// The arm as Python holds it: packed once, asked often.

#pragma once

#include <nanobind/nanobind.h>

#include "arm_solve.h"

namespace kinesic::arm {

namespace nb = nanobind;

struct Arm {
    bool mirrored = false;         // a right arm, packed as the left one in the mirror
    double rest[MOST_HINGES];      // [rad] inside the ranges
    double mobility[MOST_HINGES];  // how readily each hinge moves unless something else is asked
    Linkage linkage;

    Vector seen(const Vector& p) const { return {p.x, mirrored ? 0.0 - p.y : p.y, p.z}; }
    Vector seen(const double* p) const { return seen(Vector{p[0], p[1], p[2]}); }
};

// Copies a posture's finite angles, clipped to the ranges; false for anything else.
bool read_posture(const Arm& arm, nb::handle source, double* into);

void bind_stages(nb::class_<Arm>& arm);
void bind_poses(nb::class_<Arm>& arm);
void bind_keys(nb::class_<Arm>& arm);

}  // namespace kinesic::arm
