// kinesic._kernel.compiled: the compiled numerical code, with one submodule for each package that calls it.

#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_controller(nb::module_& module);
void bind_ik(nb::module_& module);
void bind_metrics(nb::module_& module);
void bind_motion(nb::module_& module);
void bind_sim(nb::module_& module);

NB_MODULE(compiled, module) {
    nb::set_leak_warnings(false);  // interpreters that exit with frozen objects keep functions, which is no leak
    nb::module_ controller = module.def_submodule("controller");
    nb::module_ ik = module.def_submodule("ik");
    nb::module_ metrics = module.def_submodule("metrics");
    nb::module_ motion = module.def_submodule("motion");
    nb::module_ sim = module.def_submodule("sim");
    bind_controller(controller);
    bind_ik(ik);
    bind_metrics(metrics);
    bind_motion(motion);
    bind_sim(sim);
}
