// What `batch` works on: the clips of a folder, and what a table says of each shot.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace impactdic::run {

struct BatchShot {
  std::filesystem::path clip;
  std::string name;  // of the folder of its results
  // As the table has them; else as the job says.
  std::optional<double> surface_angle_deg, ball_diameter_mm, inertia_factor, height_mm;
  std::string camera;  // its file; "": the job's
  std::string drop_height_mm, notes, ball, mass_g;
  bool listed = false;  // stands in the table
};

// The clips of `folder` in natural order: files with a clip's extension, and sub-folders of
// pictures (two at least). Throws InvalidArgument where there is none.
std::vector<BatchShot> shots_in_folder(const std::filesystem::path& folder);

// Reads the table (CSV with a column `file`, and of surface_angle_deg, ball_diameter_mm,
// inertia_factor, drop_height_mm, camera, ball, mass_g, notes those that it has) into `shots`.
// `file` is a clip's name with or without its extension. Throws FileError, FormatError;
// InvalidArgument for a file that is not in the folder or stands twice, an unknown column, or a
// value that is no number.
void read_shot_table(const std::filesystem::path& table, std::vector<BatchShot>& shots);

}  // namespace impactdic::run
