// kinesic._kernel.ik: inverse kinematics. Each bind_*.cpp file adds its functions.

#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_arm(nb::module_& module);
void bind_chains(nb::module_& module);
void bind_pairs(nb::module_& module);

void bind_ik(nb::module_& module) {
    bind_arm(module);
    bind_chains(module);
    bind_pairs(module);
}
