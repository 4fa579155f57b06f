// Arm data packed once per chain for calls from Python.

#pragma once

#include <nanobind/nanobind.h>

#include "arm_solve.h"

namespace kinesic::arm {

namespace nb = nanobind;

struct Arm {
    bool mirrored = false;         // whether this is a right arm, packed as its left mirror image
    double rest[MAX_HINGES];      // [rad] rest posture, inside the ranges
    double mobility[MAX_HINGES];  // mobility of each hinge in motions with free choices
    Linkage linkage;

    Vector seen(const Vector& p) const { return {p.x, mirrored ? 0.0 - p.y : p.y, p.z}; }
    Vector seen(const double* p) const { return seen(Vector{p[0], p[1], p[2]}); }
};

// Copies a posture clipped to the ranges; false if it is not finite.
bool read_posture(const Arm& arm, nb::handle source, double* into);

void bind_stages(nb::class_<Arm>& arm);
void bind_poses(nb::class_<Arm>& arm);
void bind_keys(nb::class_<Arm>& arm);

}  // namespace kinesic::arm
