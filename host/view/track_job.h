// A measurement as the page sets it up: settings as text, as the command line has them.
#pragma once

#include <impactdic/track.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/run/settings/setting_value.h"

namespace impactdic::view {

struct TrackJob {
  TrackRequest request;
  TrackFolder folder;
};

// The job that `settings` make up ({"roi": "1,2,30,40", "no-field": true, ...}), beside `clip`,
// which they may not change. Throws InvalidArgument for a key that `track` does not have, a value
// that it does not take, and as TrackRequest::validate.
TrackJob read_job(const nlohmann::json& settings, const ClipRequest& clip);

// Its settings that are not what they are without being given.
run::SettingValues given_settings(const TrackJob& job);

// What a shell takes: "impactdic track CLIP -o FOLDER --roi 1,2,30,40 ...".
std::string command_line(const TrackJob& job);

// Every setting of `track` but the clip's: key, text of its default, kind ("flag", "number",
// "text") or its choices, what it is for.
nlohmann::json describe_settings();

// The settings of the job.toml of results, those that are not defaults, as `read_job` takes them;
// an empty object without such a file or one of another command.
nlohmann::json settings_of_results(const std::filesystem::path& folder);

}  // namespace impactdic::view
