#include <nanobind/nanobind.h>

void bind_chains(nanobind::module_& module) { (void)module; }
