// The jobs of the module: each takes options by name and returns what was measured.
#pragma once

#include <impactdic/device.h>
#include <nanobind/nanobind.h>

#include <memory>
#include <string>

#include "host/python/clip.h"
#include "host/python/job.h"

namespace impactdic::python {

void bind_session(nanobind::module_& module);
void bind_track(nanobind::module_& module);
void bind_correlate(nanobind::module_& module);
void bind_synth(nanobind::module_& module);
void bind_models(nanobind::module_& module);
void bind_sweep(nanobind::module_& module);

}  // namespace impactdic::python
