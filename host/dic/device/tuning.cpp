#include "host/dic/device/tuning.h"

#include <impactdic/error.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/base/private_folder.h"
namespace impactdic::dic {
namespace {

using Json = nlohmann::json;

// The rows of the file; none where it cannot be read.
Json rows_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  const Json all = Json::parse(file, nullptr, false);
  if (!all.is_object() || !all.contains("kernels") || !all["kernels"].is_array()) {
    return Json::array();
  }
  Json rows = Json::array();
  for (const Json& row : all["kernels"]) {
    const auto is_text = [&](const char* key) { return row.contains(key) && row[key].is_string(); };
    if (row.is_object() && is_text("platform") && is_text("device") && is_text("driver") &&
        is_text("work") && is_text("variant")) {
      rows.push_back(row);
    }
  }
  return rows;
}

bool is_of(const Json& row, const opencl::Device& device, const std::string& work) {
  return row["platform"] == device.platform && row["device"] == device.name &&
         row["driver"] == device.driver && row["work"] == work;
}

template <typename Variant>
Variant choose(const opencl::Engine& engine, const std::string& work,
               const std::vector<Variant>& variants) {
  if (const auto name = tuned_variant(engine, work)) {
    for (const Variant& variant : variants) {
      if (variant.name() == *name) return variant;
    }
  }
  return variants.front();
}

}  // namespace

std::string zncc_work(const FieldOptions& options) {
  return "zncc " + std::to_string(options.window_px) + " in " +
         std::to_string(options.window_px + 2 * options.search_px);
}

std::string equal_work(int window_px) { return "equal " + std::to_string(window_px); }

std::filesystem::path tuning_file(const opencl::Engine& engine) {
  return engine.cache_dir().empty() ? "" : engine.cache_dir() / "tuning.json";
}

void store_tuning(const opencl::Engine& engine, const std::vector<TunedKernel>& kernels) {
  const std::filesystem::path path = tuning_file(engine);
  if (path.empty()) throw FileError("there is no cache folder to keep the result", "tuning.json");
  const opencl::Device& device = engine.device();
  Json rows = Json::array();
  for (const Json& row : rows_of(path)) {
    const bool is_replaced = std::any_of(kernels.begin(), kernels.end(), [&](const auto& kernel) {
      return is_of(row, device, kernel.work);
    });
    if (!is_replaced) rows.push_back(row);
  }
  for (const TunedKernel& kernel : kernels) {
    rows.push_back({{"platform", device.platform},
                    {"device", device.name},
                    {"driver", device.driver},
                    {"work", kernel.work},
                    {"variant", kernel.variant},
                    {"per_second", kernel.per_second},
                    {"difference_px", kernel.difference_px}});
  }
  if (!make_private_folder(path.parent_path())) {
    throw FileError("the cache folder cannot be made, or others may write into it",
                    path.parent_path().string());
  }
  // Whoever reads meanwhile sees the old file or the new one.
  const std::filesystem::path fresh = path.string() + ".new";
  std::ofstream file(fresh);
  file << Json{{"impactdic_version", IMPACTDIC_VERSION}, {"kernels", rows}}.dump(2) << "\n";
  file.close();
  std::error_code failure;
  if (file) std::filesystem::rename(fresh, path, failure);
  if (!file || failure) throw FileError("cannot be written", path.string());
}

std::optional<std::string> tuned_variant(const opencl::Engine& engine, const std::string& work) {
  const std::filesystem::path path = tuning_file(engine);
  if (path.empty()) return std::nullopt;
  for (const Json& row : rows_of(path)) {
    if (is_of(row, engine.device(), work)) return row["variant"].get<std::string>();
  }
  return std::nullopt;
}

ZnccVariant choose_zncc_variant(const opencl::Engine& engine, const FieldOptions& options) {
  return choose(engine, zncc_work(options), zncc_variants(engine.device(), options));
}

EqualVariant choose_equal_variant(const opencl::Engine& engine, int window_px, bool of_clip) {
  const auto variants = equal_variants(engine.device(), window_px);
  const auto on_units = std::find_if(variants.begin(), variants.end(),
                                     [](const auto& variant) { return variant.matrix_units; });
  if (!of_clip && on_units != variants.end()) return *on_units;
  return choose(engine, equal_work(window_px), variants);
}

}  // namespace impactdic::dic
