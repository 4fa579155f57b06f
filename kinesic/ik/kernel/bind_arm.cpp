#include <nanobind/nanobind.h>

void bind_arm(nanobind::module_& module) { (void)module; }
