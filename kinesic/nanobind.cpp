// The runtime of nanobind, part of every kernel. setuptools refuses sources with absolute paths, so it is included here.
#include <nb_combined.cpp>
