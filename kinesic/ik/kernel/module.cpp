// kinesic.ik._kernel: inverse kinematics compiled. Each part binds itself.

#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_arm(nb::module_& module);
void bind_chains(nb::module_& module);
void bind_pairs(nb::module_& module);

NB_MODULE(_kernel, module) {
    bind_arm(module);
    bind_chains(module);
    bind_pairs(module);
}
