// NumPy arrays of float64 in and out, by NumPy's own interface: the buffer protocol builds a description each time.

#pragma once

#include <nanobind/nanobind.h>
#define PY_ARRAY_UNIQUE_SYMBOL kinesic_ik_numpy  // one table for all files that bind, filled by the first
#define NPY_NO_DEPRECATED_API NPY_2_0_API_VERSION
#include <numpy/arrayobject.h>

#include <algorithm>
#include <cmath>

namespace kinesic {

namespace nb = nanobind;

// Returns the numbers of an array; null unless it is contiguous float64 of length `count`.
inline double* numbers(nb::handle source, int count) {
    if (!PyArray_Check(source.ptr())) return nullptr;
    auto* array = reinterpret_cast<PyArrayObject*>(source.ptr());
    const bool good = PyArray_NDIM(array) == 1 && PyArray_DIM(array, 0) == count &&
                      PyArray_TYPE(array) == NPY_DOUBLE && PyArray_ISCARRAY_RO(array);
    return good ? static_cast<double*>(PyArray_DATA(array)) : nullptr;
}

// Copies finite numbers from an array of the expected length; false for anything else.
inline bool read(nb::handle source, double* into, int count) {
    const double* from = numbers(source, count);
    if (!from) return false;
    std::copy_n(from, count, into);
    return std::all_of(into, into + count, [](double number) { return std::isfinite(number); });
}

// Copies the finite numbers of a square matrix, row by row; false for anything else.
inline bool read_square(nb::handle source, double* into, int side) {
    if (!PyArray_Check(source.ptr())) return false;
    auto* array = reinterpret_cast<PyArrayObject*>(source.ptr());
    if (PyArray_NDIM(array) != 2 || PyArray_DIM(array, 0) != side || PyArray_DIM(array, 1) != side ||
        PyArray_TYPE(array) != NPY_DOUBLE || !PyArray_ISCARRAY_RO(array))
        return false;
    std::copy_n(static_cast<const double*>(PyArray_DATA(array)), side * side, into);
    return std::all_of(into, into + side * side, [](double number) { return std::isfinite(number); });
}

// Copies numbers into a writable array of the expected length; false for anything else.
inline bool write(nb::handle target, const double* from, int count) {
    double* into = numbers(target, count);
    if (!into || !PyArray_ISWRITEABLE(reinterpret_cast<PyArrayObject*>(target.ptr()))) return false;
    std::copy_n(from, count, into);
    return true;
}

// A new read-only array, like kinesic.body.arrays.sealed.
inline nb::object sealed(const double* from, int count) {
    npy_intp shape = count;
    const nb::object made = nb::steal(PyArray_SimpleNew(1, &shape, NPY_DOUBLE));
    if (!made) throw nb::python_error();
    auto* array = reinterpret_cast<PyArrayObject*>(made.ptr());
    std::copy_n(from, count, static_cast<double*>(PyArray_DATA(array)));
    PyArray_CLEARFLAGS(array, NPY_ARRAY_WRITEABLE);
    return made;
}

}  // namespace kinesic
