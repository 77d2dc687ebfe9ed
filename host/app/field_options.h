// The options of the displacement field, shared by `track` and `correlate`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "host/dic/field.h"
#include "host/report/fields_file.h"

namespace impactdic::app {

struct FieldRequest {
  dic::FieldOptions field;
  std::string method = "icgn";
  int spacing_px = 0;
  int compression = 0;  // of fields.h5
};

// Adds --window, --spacing, --search, --interp, --method, --spline-degree, the thresholds and
// --compress.
void add_field_options(CLI::App& command, FieldRequest& request);
// Turns the words into values. Throws InvalidArgument.
dic::FieldOptions resolve(const FieldRequest& request);
// The same as attributes of fields.h5.
void describe(const FieldRequest& request, report::Attributes& attributes);

}  // namespace impactdic::app
