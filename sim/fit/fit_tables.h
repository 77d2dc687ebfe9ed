// The parts that fit and compare jobs share, and how they are read. Internal to sim/fit.
#pragma once

#include <impactdic/error.h>

#include <string>
#include <utility>

#include "sim/fit/calibration.h"
#include "sim/job/strict_toml.h"
#include "sim/job/toml_text.h"

namespace impactdic::sim::fit {

template <typename Names, typename Value>
std::string name_in(const Names& names, Value value) {
  for (const auto& [known, name] : names) {
    if (known == value) return name;
  }
  return "";
}

template <typename Names>
auto choose(const Names& names, job::StrictTable& table, const std::string& key,
            const std::string& fallback) {
  const std::string text = table.text(key, fallback);
  std::string list;
  for (const auto& [value, name] : names) {
    if (name == text) return value;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  throw InvalidArgument("'" + text + "' is not known", table.place(key), "one of " + list);
}

// The laws and the tables body, contact, environment, solver, fit and grid. Neither finished nor
// validated; surface.angle_deg is asked for by surface_angle.
// `rivals`: where the job does not say.
FitRequest read_fit_tables(job::StrictTable& root, bool rivals);
// The files that `key` lists, relative to `folder`.
std::vector<std::filesystem::path> read_paths(job::StrictTable& root, const std::string& key,
                                              const std::filesystem::path& folder);
std::vector<FitShot> shots_at(const std::vector<std::filesystem::path>& tracks, double angle_deg);
// surface.angle_deg, NaN without: each track knows its own.
double surface_angle(job::StrictTable& root);

void write_laws(job::TomlText& text, const ImpactJob& laws);
void write_tracks(job::TomlText& text, const std::string& key, const std::vector<FitShot>& shots);
// Everything after the lists of tracks.
void write_fit_tables(job::TomlText& text, const FitRequest& job, double angle_deg);

}  // namespace impactdic::sim::fit
