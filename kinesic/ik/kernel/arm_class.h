// The arm as Python holds it: packed once, asked often.

#pragma once

#include <nanobind/nanobind.h>

#include "arm_solve.h"

namespace kinesic::arm {

namespace nb = nanobind;

struct Arm {
    Linkage linkage;
    bool mirrored = false;          // a right arm, packed as the left one in the mirror
    double rest[MOST_HINGES];       // [rad] inside the ranges
    double mobility[MOST_HINGES];   // how readily each hinge moves unless something else is asked

    Vector seen(const double* p) const { return {p[0], mirrored ? 0.0 - p[1] : p[1], p[2]}; }
};

// Copies a contiguous float64 buffer of `count` finite numbers; false for anything else.
inline bool read(nb::handle source, double* into, int count) {
    Py_buffer view;
    if (PyObject_GetBuffer(source.ptr(), &view, PyBUF_ND | PyBUF_FORMAT) != 0) {
        PyErr_Clear();
        return false;
    }
    bool good = view.ndim == 1 && view.shape[0] == count && view.format[0] == 'd' && view.format[1] == '\0';
    if (good) {
        std::copy_n(static_cast<const double*>(view.buf), count, into);
        for (int k = 0; k < count; ++k) good = good && std::isfinite(into[k]);
    }
    PyBuffer_Release(&view);
    return good;
}

// Copies numbers into a writable float64 buffer of their count; false for anything else.
inline bool write(nb::handle target, const double* from, int count) {
    Py_buffer view;
    if (PyObject_GetBuffer(target.ptr(), &view, PyBUF_ND | PyBUF_FORMAT | PyBUF_WRITABLE) != 0) {
        PyErr_Clear();
        return false;
    }
    const bool good = view.ndim == 1 && view.shape[0] == count && view.format[0] == 'd' && view.format[1] == '\0';
    if (good) std::copy_n(from, count, static_cast<double*>(view.buf));
    PyBuffer_Release(&view);
    return good;
}

void bind_stages(nb::class_<Arm>& arm);

}  // namespace kinesic::arm
