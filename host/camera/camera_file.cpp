// camera.toml, read strictly: a damaged calibration must not become a measurement.
#include <impactdic/camera/model.h>
#include <impactdic/error.h>
#include <toml++/toml.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string_view>

#include "host/base/parse.h"
#include "host/base/toml_text.h"

namespace impactdic {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kSchema = 1;
constexpr std::size_t kLensParameters = 9;
constexpr const char* kHint = "impactdic calibrate writes such files";

std::string name(std::size_t parameter) {
  return to_string(static_cast<CameraParameter>(parameter));
}

class Reader {
 public:
  Reader(const toml::table& root, std::string file) : root_(root), file_(std::move(file)) {}

  Camera read() const {
    check_keys(root_, "",
               {"schema", "version", "from", "width_px", "height_px", "focal_length_known", "lens",
                "plane", "covariance"});
    const std::int64_t schema = whole(root_, "schema");
    if (schema != kSchema) {
      fail("the schema is " + std::to_string(schema) + ", this program reads " +
           std::to_string(kSchema));
    }
    Camera camera;
    camera.width = size("width_px");
    camera.height = size("height_px");
    camera.from = text("from");
    const auto known = root_["focal_length_known"].value_exact<bool>();
    if (!known) fail("the key focal_length_known must be true or false");
    camera.focal_length_known = *known;
    read_lens(camera);
    read_plane(camera);
    read_covariance(camera);
    try {
      camera.validate();
    } catch (const InvalidArgument& error) {
      fail(error.where() + ": " + error.what());
    }
    return camera;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError(file_, -1, what, kHint);
  }

  void check_keys(const toml::table& table, const std::string& prefix,
                  std::initializer_list<std::string_view> keys) const {
    for (const std::string_view key : keys) {
      if (!table.contains(key)) fail("the key " + prefix + std::string(key) + " is missing");
    }
    for (const auto& [key, node] : table) {
      bool known = false;
      for (const std::string_view one : keys) known = known || one == key.str();
      if (!known) fail("the key " + prefix + std::string(key.str()) + " is not known");
    }
  }

  const toml::table& table(const char* key) const {
    const toml::table* found = root_[key].as_table();
    if (found == nullptr) fail(std::string("the key ") + key + " must be a table");
    return *found;
  }

  double number(const toml::node* node, const std::string& where) const {
    const auto value = node != nullptr && node->is_number() ? node->value<double>() : std::nullopt;
    if (!value) fail("the key " + where + " must hold numbers");
    if (!std::isfinite(*value)) fail("the key " + where + " holds a number that is not finite");
    return *value;
  }

  const toml::array& list(const toml::node* node, std::size_t size,
                          const std::string& where) const {
    const toml::array* found = node != nullptr ? node->as_array() : nullptr;
    if (found == nullptr || found->size() != size) {
      fail("the key " + where + " must be a list of " + std::to_string(size));
    }
    return *found;
  }

  std::int64_t whole(const toml::table& table, const std::string& key) const {
    const auto value = table[key].value_exact<std::int64_t>();
    if (!value) fail("the key " + key + " must be a whole number");
    return *value;
  }

  int size(const std::string& key) const {
    const std::int64_t value = whole(root_, key);
    constexpr std::int64_t kMost = 1 << 16;
    if (value < 1 || value > kMost) fail("the key " + key + " is no size of a picture");
    return static_cast<int>(value);
  }

  std::string text(const std::string& key) const {
    const auto value = root_[key].value_exact<std::string>();
    if (!value) fail("the key " + key + " must be a text");
    return *value;
  }

  void read_lens(Camera& camera) const {
    const toml::table& lens = table("lens");
    check_keys(lens, "lens.", {"fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "p1", "p2", "k3"});
    for (std::size_t i = 0; i < kLensParameters; ++i) {
      camera.values[i] = number(lens.get(name(i)), "lens." + name(i));
    }
  }

  void read_plane(Camera& camera) const {
    const toml::table& plane = table("plane");
    check_keys(plane, "plane.", {"rotation_rad", "position_m"});
    const toml::array& rotation = list(plane.get("rotation_rad"), 3, "plane.rotation_rad");
    const toml::array& position = list(plane.get("position_m"), 3, "plane.position_m");
    for (std::size_t i = 0; i < 3; ++i) {
      camera.values[kLensParameters + i] = number(rotation.get(i), "plane.rotation_rad");
      camera.values[kLensParameters + 3 + i] = number(position.get(i), "plane.position_m");
    }
  }

  void read_covariance(Camera& camera) const {
    const toml::table& covariance = table("covariance");
    check_keys(covariance, "covariance.", {"order", "rows"});
    const toml::array& order = list(covariance.get("order"), kCameraParameters, "covariance.order");
    const toml::array& rows = list(covariance.get("rows"), kCameraParameters, "covariance.rows");
    for (std::size_t i = 0; i < kCameraParameters; ++i) {
      if (order.get(i)->value_or(std::string()) != name(i)) {
        fail("the key covariance.order must be the order in which " + name(i) + " is number " +
             std::to_string(i + 1));
      }
      const toml::array& row = list(rows.get(i), kCameraParameters, "covariance.rows");
      for (std::size_t k = 0; k < kCameraParameters; ++k) {
        camera.covariance[i * kCameraParameters + k] = number(row.get(k), "covariance.rows");
      }
    }
  }

  const toml::table& root_;
  std::string file_;
};

// A number of TOML with a point or an exponent.
std::string real(double value) {
  const std::string text = shortest(value);
  return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
  std::ostringstream out;
  out << toml::value<std::string>(text);
  return out.str();
}

std::string three(const Camera& camera, CameraParameter first) {
  const auto at = static_cast<std::size_t>(first);
  return "[" + real(camera.values[at]) + ", " + real(camera.values[at + 1]) + ", " +
         real(camera.values[at + 2]) + "]";
}

void write_text(std::ostream& out, const Camera& camera) {
  out << "# A camera and its plane of motion; docs/camera.md says what the numbers mean.\n"
      << "schema = " << kSchema << "\nversion = " << quoted("impactdic " IMPACTDIC_VERSION)
      << "\nfrom = " << quoted(camera.from) << "\nwidth_px = " << camera.width
      << "\nheight_px = " << camera.height
      << "\nfocal_length_known = " << (camera.focal_length_known ? "true" : "false")
      << "\n\n[lens]\n";
  for (std::size_t i = 0; i < kLensParameters; ++i) {
    out << name(i) << " = " << real(camera.values[i]) << '\n';
  }
  out << "\n[plane]\nrotation_rad = " << three(camera, CameraParameter::kRotationX)
      << "\nposition_m = " << three(camera, CameraParameter::kPositionX)
      << "\n\n[covariance]\norder = [";
  for (std::size_t i = 0; i < kCameraParameters; ++i) out << (i ? ", " : "") << quoted(name(i));
  out << "]\nrows = [\n";
  for (std::size_t i = 0; i < kCameraParameters; ++i) {
    out << "  [";
    for (std::size_t k = 0; k < kCameraParameters; ++k) {
      out << (k ? ", " : "") << real(camera.covariance[i * kCameraParameters + k]);
    }
    out << "],\n";
  }
  out << "]\n";
}

}  // namespace

Camera read_camera(const std::string& path) {
  const std::string text = read_toml_text(path);
  try {
    const toml::table root = toml::parse(text);
    return Reader(root, path).read();
  } catch (const toml::parse_error& error) {
    throw FormatError(path, -1,
                      "this is no TOML: " + std::string(error.description()) + " (line " +
                          std::to_string(error.source().begin.line) + ")",
                      kHint);
  }
}

void write_camera(const Camera& camera, const std::string& path) {
  camera.validate();
  const fs::path temporary = path + ".part";
  std::error_code error;
  {
    std::ofstream file(temporary);
    write_text(file, camera);
    file.flush();
    if (!file) {
      fs::remove(temporary, error);
      throw FileError("cannot write the file", path);
    }
  }
  fs::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw FileError("cannot write the file: " + error.message(), path);
  }
}

}  // namespace impactdic
