#include "host/run/batch_table.h"

#include <impactdic/error.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "host/base/csv_table.h"
#include "host/base/parse.h"
#include "host/video/natural_order.h"

namespace impactdic::run {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> kClips = {".cine", ".mraw", ".tif", ".tiff",
                                      ".avi",  ".mp4",  ".mov", ".mkv"};
const std::set<std::string> kPictures = {".png", ".bmp", ".jpg", ".jpeg", ".pgm", ".tif", ".tiff"};

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_clip(const fs::directory_entry& entry) {
  if (entry.path().filename().string().starts_with(".")) return false;
  if (entry.is_regular_file()) return kClips.count(extension_of(entry.path())) != 0;
  if (!entry.is_directory()) return false;
  int pictures = 0;
  for (const auto& inside : fs::directory_iterator(entry.path())) {
    pictures += inside.is_regular_file() && kPictures.count(extension_of(inside.path())) != 0;
  }
  return pictures >= 2;
}

// A shot's folder is found again by its name in shots.csv, whose cells hold none of these.
std::string as_cell(std::string name) {
  for (char& c : name) {
    if (c == ',') c = ';';
    if (c == '"') c = '\'';
    if (c == '\n' || c == '\r') c = ' ';
  }
  return name;
}

// Throws InvalidArgument where a column is not known or a number is none.
void check_columns(const CsvTable& table, const fs::path& path) {
  const std::set<std::string> known = {"file",
                                       "surface_angle_deg",
                                       "ball_diameter_mm",
                                       "inertia_factor",
                                       "drop_height_mm",
                                       "camera",
                                       "ball",
                                       "mass_g",
                                       "notes"};
  for (const std::string& column : table.columns()) {
    if (known.count(column) == 0) {
      throw InvalidArgument("unknown column '" + column + "'", path.string(),
                            "there are file, surface_angle_deg, ball_diameter_mm, inertia_factor, "
                            "drop_height_mm, camera, ball, mass_g, notes");
    }
  }
  for (const char* numbers :
       {"surface_angle_deg", "ball_diameter_mm", "inertia_factor", "drop_height_mm", "mass_g"}) {
    if (table.has(numbers)) table.numbers(numbers);  // says where one is none
  }
}

}  // namespace

std::vector<BatchShot> shots_in_folder(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InvalidArgument("there is no such folder", folder.string());
  std::vector<BatchShot> shots;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!is_clip(entry)) continue;
    BatchShot shot;
    shot.clip = fs::absolute(entry.path());
    shot.name = as_cell(entry.path().stem().string());
    shots.push_back(shot);
  }
  if (shots.empty()) {
    throw InvalidArgument("the folder holds no clips", folder.string(),
                          "wanted are .cine, .mraw, .tif, .avi, .mp4, .mov, .mkv or folders of "
                          "pictures");
  }
  std::map<std::string, int> names;
  for (const BatchShot& shot : shots) ++names[shot.name];
  for (BatchShot& shot : shots) {
    if (names[shot.name] > 1) shot.name = as_cell(shot.clip.filename().string());
  }
  std::set<std::string> taken;
  for (const BatchShot& shot : shots) {
    if (taken.insert(shot.name).second) continue;
    throw InvalidArgument("two clips would have the results '" + shot.name + "'", folder.string(),
                          "rename one of them");
  }
  std::sort(shots.begin(), shots.end(), [](const BatchShot& a, const BatchShot& b) {
    return video::natural_less(a.clip.string(), b.clip.string());
  });
  return shots;
}

void read_shot_table(const fs::path& path, std::vector<BatchShot>& shots) {
  const CsvTable table = CsvTable::read(path);
  check_columns(table, path);
  const std::vector<std::string> files = table.text("file");
  const auto cell = [&](const char* column, std::size_t row) {
    return table.has(column) ? table.text(column)[row] : std::string();
  };
  for (std::size_t row = 0; row < files.size(); ++row) {
    const auto shot = std::find_if(shots.begin(), shots.end(), [&](const BatchShot& s) {
      return s.clip.filename() == files[row] || s.name == files[row];
    });
    if (shot == shots.end()) {
      throw InvalidArgument("there is no clip '" + files[row] + "' in the folder",
                            table.where(row));
    }
    if (shot->listed) {
      throw InvalidArgument("the clip '" + files[row] + "' stands twice", table.where(row));
    }
    shot->listed = true;
    const auto number = [&](const char* column) -> std::optional<double> {
      const std::string text = cell(column, row);
      if (text.empty()) return std::nullopt;
      return parse_double(text, table.where(row) + ", column " + column);
    };
    const auto positive = [&](const char* column) {
      const std::optional<double> value = number(column);
      if (value && !(*value > 0)) {
        throw InvalidArgument("must be positive, not " + shortest(*value),
                              table.where(row) + ", column " + column);
      }
      return value;
    };
    shot->surface_angle_deg = number("surface_angle_deg");
    shot->ball_diameter_mm = positive("ball_diameter_mm");
    shot->inertia_factor = positive("inertia_factor");
    shot->height_mm = positive("drop_height_mm");
    shot->mass_g = positive("mass_g") ? cell("mass_g", row) : "";
    shot->camera = cell("camera", row);
    if (!shot->camera.empty()) {  // beside the table, unless the path is a whole one
      shot->camera = (fs::absolute(path).parent_path() / shot->camera).string();
    }
    shot->ball = as_cell(cell("ball", row));
    shot->drop_height_mm = cell("drop_height_mm", row);
    shot->notes = as_cell(cell("notes", row));
  }
}

}  // namespace impactdic::run
