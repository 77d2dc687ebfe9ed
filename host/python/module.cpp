// The module impactdic._impactdic. Its functions are those that the package impactdic calls; what
// a user sees, with shapes and units, stands there.
#include <impactdic/device.h>
#include <impactdic/version.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "host/python/errors.h"
#include "host/python/jobs.h"
#include "host/python/options.h"

namespace nb = nanobind;

namespace impactdic::python {
namespace {

std::unique_ptr<Session> open_session(const nb::dict& options) {
  SessionOptions wanted;
  OptionReader reader(options);
  run::visit_session(reader, wanted);
  reader.finish("session");
  return std::make_unique<Session>(wanted);
}

nb::list devices() {
  std::vector<DeviceInfo> found;
  {
    const nb::gil_scoped_release released;
    found = list_devices();
  }
  nb::list list;
  for (const DeviceInfo& device : found) {
    nb::dict facts;
    facts["index"] = device.index;
    facts["platform"] = device.platform;
    facts["name"] = device.name;
    facts["vendor"] = device.vendor;
    facts["driver"] = device.driver;
    facts["version"] = device.version;
    facts["is_gpu"] = device.is_gpu;
    facts["global_memory_bytes"] = device.global_memory_bytes;
    facts["compute_units"] = device.compute_units;
    list.append(facts);
  }
  return list;
}

}  // namespace

void bind_session(nb::module_& module) {
  nb::class_<Session>(module, "Session")
      .def("__init__", [](Session* self, const nb::dict& options) {
        new (self) Session(std::move(*open_session(options)));
      });
  module.def("list_devices", &devices);
}

}  // namespace impactdic::python

NB_MODULE(_impactdic, module) {
  module.doc() = "The engine of impactdic; use the package impactdic.";
  module.attr("__version__") = impactdic::version();
  impactdic::python::register_errors();
  impactdic::python::bind_clip(module);
  impactdic::python::bind_session(module);
  impactdic::python::bind_track(module);
  impactdic::python::bind_correlate(module);
  impactdic::python::bind_synth(module);
  impactdic::python::bind_models(module);
  impactdic::python::bind_sweep(module);
}
