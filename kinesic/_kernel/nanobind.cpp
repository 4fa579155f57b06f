// The runtime of nanobind. setuptools refuses sources with absolute paths, so it is included here.
#include <nb_combined.cpp>
