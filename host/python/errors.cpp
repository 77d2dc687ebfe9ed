#include "host/python/errors.h"

#include <impactdic/error.h>
#include <nanobind/stl/string.h>

namespace nb = nanobind;

namespace impactdic::python {
namespace {

const char* class_of(const Error& error) {
  if (dynamic_cast<const InvalidArgument*>(&error)) return "InvalidArgument";
  if (dynamic_cast<const FormatError*>(&error)) return "FormatError";
  if (dynamic_cast<const FileError*>(&error)) return "FileError";
  if (dynamic_cast<const OpenClError*>(&error)) return "OpenClError";
  if (dynamic_cast<const BuildError*>(&error)) return "BuildError";
  return "Error";
}

void translate(const std::exception_ptr& pointer, void*) {
  try {
    std::rethrow_exception(pointer);
  } catch (const Error& error) {
    const nb::object type = nb::module_::import_("impactdic.errors").attr(class_of(error));
    const nb::object made = type(error.what(), error.where(), error.hint());
    PyErr_SetObject(type.ptr(), made.ptr());
  }
}

}  // namespace

void register_errors() { nb::register_exception_translator(translate); }

}  // namespace impactdic::python
