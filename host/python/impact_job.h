// Impact jobs as dictionaries with the keys of job files.
#pragma once

#include <impactdic/impact_model.h>
#include <nanobind/nanobind.h>

namespace impactdic::python {

// normal, friction, preset, body, contact, surface, initial, environment, solver, as in the job
// files of `simulate`; tables are dictionaries. Throws InvalidArgument naming the key.
ImpactJob impact_job(const nanobind::dict& job);

}  // namespace impactdic::python
