// The library's errors as exceptions of the Python package, with the words of the program.
#pragma once

#include <nanobind/nanobind.h>

namespace impactdic::python {

// From here on every impactdic::Error that leaves a function of the module arrives in Python as the
// class of impactdic.errors that has its name.
void register_errors();

}  // namespace impactdic::python
