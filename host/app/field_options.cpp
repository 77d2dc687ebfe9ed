#include "host/app/field_options.h"

#include <impactdic/error.h>

#include "host/app/command.h"

namespace impactdic::app {

void add_field_options(CLI::App& command, FieldRequest& request) {
  dic::FieldOptions& field = request.field;
  command.add_option("--window", field.window_px, "Side of an interrogation window, px")
      ->capture_default_str();
  command
      .add_option("--spacing", request.spacing_px,
                  "Distance of the windows' centres, px; 0 is half a window")
      ->capture_default_str();
  command
      .add_option("--search", field.search_px,
                  "Largest displacement searched about the expected one, px each way")
      ->capture_default_str();
  command
      .add_option("--method", request.method,
                  "icgn (ZNCC, then IC-GN with affine warp), zncc (FFT cross-correlation "
                  "normalised over the overlap) or published (equal windows, spline points)")
      ->capture_default_str();
  command
      .add_option("--interp", field.interp_points,
                  "Spline points between pixels of the published method, 0 to 9")
      ->capture_default_str();
  command
      .add_option("--spline-degree", field.spline_degree, "B-spline of the IC-GN warp: 3, 5 or 7")
      ->capture_default_str();
  command
      .add_option("--min-correlation", field.min_correlation,
                  "ZNCC below which a window counts as not found")
      ->capture_default_str();
  command
      .add_option(
          "--min-texture", field.min_texture,
          "Contrast of a window (rms, grey levels of 255, without the noise) below which it "
          "is left out")
      ->capture_default_str();
  command
      .add_option("--max-sd", field.max_sd_px,
                  "Standard deviation, px, that the clip's noise lets expect of a window's "
                  "displacement, above which it is left out (icgn)")
      ->capture_default_str();
  command
      .add_option("--compress", request.compression,
                  "Deflate fields.h5 at this level, 1 to 9; 0: not at all")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
}

dic::FieldOptions resolve(const FieldRequest& request) {
  dic::FieldOptions field = request.field;
  field.method = dic::parse_field_method(request.method);
  if (request.spacing_px < 0) {
    throw InvalidArgument(
        "the spacing must be 0 or more, not " + std::to_string(request.spacing_px), "--spacing");
  }
  field.validate();
  return field;
}

void describe(const FieldRequest& request, report::Attributes& attributes) {
  const dic::FieldOptions& field = request.field;
  attributes["option_method"] = request.method;
  attributes["option_window_px"] = double(field.window_px);
  attributes["option_spacing_px"] = double(request.spacing_px);
  attributes["option_search_px"] = double(field.search_px);
  attributes["option_interp"] = double(field.interp_points);
  attributes["option_spline_degree"] = double(field.spline_degree);
  attributes["option_max_iterations"] = double(field.max_iterations);
  attributes["option_min_correlation"] = field.min_correlation;
  attributes["option_min_texture"] = field.min_texture;
  attributes["option_max_sd_px"] = field.max_sd_px;
}

}  // namespace impactdic::app
